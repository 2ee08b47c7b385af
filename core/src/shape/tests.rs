use super::*;
use crate::obstacle::Outlook;
use crate::obstacle::{Obstacle, ObstacleSpec};
use crate::{Matrix, rotation};
use proptest::prelude::*;

type V2 = Vector<f64, 2>;
type V3 = Vector<f64, 3>;

/// Is q inside, by a formula that has nothing to do with gauges?
fn inside3(shape: &Shape<f64, 3>, q: &V3) -> bool {
    let outside = |t: f64| t.max(0.0);
    match shape {
        Shape::Ellipsoid { axes, curvature } => {
            q.iter().zip(axes.iter()).map(|(q, a)| (q / a).abs().powi(2 * i32::from(*curvature))).sum::<f64>() <= 1.0
        }
        Shape::Box { half, rounding } => {
            (0..3).map(|i| outside(q[i].abs() - half[i] + rounding).powi(2)).sum::<f64>() <= rounding * rounding
        }
        Shape::Cylinder { radius, half_length, rounding } => {
            let across = outside(q.xy().norm() - radius + rounding);
            let along = outside(q.z.abs() - half_length + rounding);
            across.hypot(along) <= *rounding
        }
        Shape::Capsule { radius, half_length } => q.xy().norm().hypot(outside(q.z.abs() - half_length)) <= *radius,
        Shape::Polygon(_) => false,
    }
}

/// Is q inside a polygon, by the number of edges a ray to the right crosses?
fn inside_polygon(vertices: &[[f64; 2]], q: &V2) -> bool {
    let n = vertices.len();
    (0..n)
        .filter(|i| {
            let ([ax, ay], [bx, by]) = (vertices[*i], vertices[(i + 1) % n]);
            (ay > q.y) != (by > q.y) && q.x < ax + (bx - ax) * (q.y - ay) / (by - ay)
        })
        .count()
        % 2
        == 1
}

fn star() -> impl Strategy<Value = Shape<f64, 2>> {
    prop::collection::vec(0.03..0.15f64, 5..=MAX_VERTICES).prop_map(|radii| {
        let n = radii.len() as f64;
        let at = |(i, r): (usize, &f64)| {
            let angle = core::f64::consts::TAU * i as f64 / n + 0.3;
            [r * libm::cos(angle), r * libm::sin(angle)]
        };
        let vertices: heapless::Vec<[f64; 2], MAX_VERTICES> = radii.iter().enumerate().map(at).collect();
        Shape::Polygon(Polygon::new(&vertices).unwrap())
    })
}

fn flat() -> impl Strategy<Value = Shape<f64, 2>> {
    let sides = || (0.03..0.3f64, 0.03..0.3f64);
    prop_oneof![
        (sides(), 1..=8u8).prop_map(|((a, b), curvature)| Shape::Ellipsoid { axes: V2::new(a, b), curvature }),
        (sides(), 0.05..1.0f64).prop_map(|((a, b), r)| Shape::Box { half: V2::new(a, b), rounding: r * a.min(b) }),
        star(),
    ]
}

fn spatial() -> impl Strategy<Value = Shape<f64, 3>> {
    let side = || 0.03..0.3f64;
    prop_oneof![
        (side(), side(), side(), 1..=8u8)
            .prop_map(|(a, b, c, curvature)| Shape::Ellipsoid { axes: V3::new(a, b, c), curvature }),
        (side(), side(), side(), 0.05..1.0f64)
            .prop_map(|(a, b, c, r)| Shape::Box { half: V3::new(a, b, c), rounding: r * a.min(b).min(c) }),
        (side(), side(), 0.05..1.0f64).prop_map(|(radius, half_length, r)| Shape::Cylinder {
            radius,
            half_length,
            rounding: r * radius.min(half_length)
        }),
        (side(), 0.0..0.3f64).prop_map(|(radius, half_length)| Shape::Capsule { radius, half_length }),
    ]
}

fn unit<const D: usize>(v: [f64; D]) -> Vector<f64, D> {
    let v = Vector::from(v);
    if v.norm() > 1e-3 { v.normalize() } else { Vector::from_fn(|i, _| if i == 0 { 1.0 } else { 0.0 }) }
}

/// Displacements of x that fulfil every half-space and are no longer than a step end outside (a wall: inside).
fn kept_out<const D: usize>(
    o: &Obstacle<f64, D>,
    x: &Vector<f64, D>,
    step: f64,
    steps: &[[f64; D]],
) -> Result<usize, TestCaseError> {
    let mut planes: heapless::Vec<(Vector<f64, D>, f64), 64> = heapless::Vec::new();
    let wish = Vector::from(steps[0]) * step;
    let from = Outlook { at: x, wish: &wish, step, reach: 2.0 * step, share: 1.0 };
    o.keep_out(&from, |n, gap| planes.push((n, gap)).unwrap());
    for (n, _) in &planes {
        prop_assert!((n.norm() - 1.0).abs() < 1e-9);
    }
    let mut kept = 0;
    for d in steps {
        let mut d = Vector::from(*d) * step;
        if d.norm() > step {
            d *= step / d.norm();
        }
        // Onto the planes it violates, several times: most often that ends on an edge between them.
        for _ in 0..20 {
            for (n, gap) in &planes {
                d -= n * (n.dot(&d) + gap).min(0.0);
            }
        }
        if planes.iter().all(|(n, gap)| n.dot(&d) >= -gap - 1e-12) && d.norm() <= step {
            kept += 1;
            let after = o.gamma(&(x + d));
            prop_assert!(after >= 1.0 - 1e-8, "{after} after {d} from {} at {x} planes {planes:?}", o.gamma(x));
        }
    }
    Ok(kept)
}

/// The one half-space of a rounded body in numbers S, at the point so far (m) beyond its surface along `way`; and in
/// f64, of the same numbers.
fn gaps<S: Scalar, const D: usize>(shape: [f64; D], rounding: f64, way: [f64; D], beyond: f64) -> [f64; 2] {
    let half = Vector::from(shape).map(S::from_f64);
    let least = half.iter().fold(S::MAX, |m, x| m.min(*x));
    // No shorter in f64 either.
    let rounding = S::from_f64(rounding).max(S::MIN_AXIS * S::from_f64(1.01)).min(least);
    let spec = ObstacleSpec { shape: Shape::Box { half, rounding }, ..ObstacleSpec::<S, D>::default() };
    let exact = Shape::Box { half: half.map(Scalar::to_f64), rounding: rounding.to_f64() };
    let exact = Obstacle::new(ObstacleSpec { shape: exact, ..ObstacleSpec::<f64, D>::default() }).unwrap();
    let way = unit(way);
    let x = (exact.surface(&way) + way * beyond).map(S::from_f64);
    [gap(&Obstacle::new(spec).unwrap(), &x).to_f64(), gap(&exact, &x.map(Scalar::to_f64))]
}

fn gap<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &Vector<S, D>) -> S {
    let (one, mut gap) = (S::one(), S::MAX);
    let from = Outlook { at: x, wish: &Vector::zeros(), step: S::from_f64(0.01), reach: one, share: one };
    o.keep_out(&from, |_, found| gap = gap.min(found));
    gap
}

/// In a wall, at this depth on the way from its centre, with steps of so many times its least extent.
fn held<const D: usize>(
    shape: Shape<f64, D>,
    way: [f64; D],
    depth: f64,
    step: f64,
    steps: &[[f64; D]],
) -> Result<(), TestCaseError> {
    let rounded = matches!(shape, Shape::Box { .. } | Shape::Cylinder { .. } | Shape::Capsule { .. });
    let step = step * shape.extent().iter().fold(f64::MAX, |m, x| m.min(*x));
    let o = Obstacle::new(ObstacleSpec { shape, wall: true, ..ObstacleSpec::default() }).unwrap();
    let x = o.surface(&unit(way)) * depth;
    let mut stays = true;
    let wish = Vector::<f64, D>::zeros();
    o.keep_out(&Outlook { at: &x, wish: &wish, step, reach: 2.0 * step, share: 1.0 }, |_, gap| stays &= gap >= -1e-12);
    // An edge that a step does not reach over bends within the step.
    let sharp = step > 1.5 * o.spec().shape.extent().iter().fold(0.0, |m: f64, x| m.max(*x));
    prop_assert!(stays || !(rounded && sharp), "at {x} it has to move");
    kept_out(&o, &x, step, steps)?;
    Ok(())
}

/// No point of the surface is farther along n than the farthest.
fn farthest<const D: usize>(shape: Shape<f64, D>, n: [f64; D], ways: &[[f64; D]]) -> Result<(), TestCaseError> {
    let turn = Matrix::<f64, D>::from_fn(|i, j| match (i, j) {
        (0, 0) | (1, 1) => 0.6,
        (0, 1) => -0.8,
        (1, 0) => 0.8,
        _ => f64::from(u8::from(i == j)),
    });
    let o = Obstacle::new(ObstacleSpec { shape, rotation: turn, ..ObstacleSpec::default() }).unwrap();
    let n = unit(n);
    let most = o.farthest(&n);
    prop_assert!((o.gamma(&most) - 1.0).abs() < 1e-6, "Gamma {} at {most}", o.gamma(&most));
    for way in ways {
        let x = o.surface(&unit(*way));
        prop_assert!(n.dot(&(x - most)) < 1e-9, "{x} is farther than {most} along {n}");
    }
    Ok(())
}

proptest! {
    /// However thin it is: a step may be longer than it is wide. And nobody inside has to move.
    #[test]
    fn a_wall_holds_steps_of_any_length(
        shape in prop_oneof![flat(), (0.002..0.02f64, 0.002..0.3f64, 0.05..1.0f64)
            .prop_map(|(a, b, r)| Shape::Box { half: V2::new(a, b), rounding: r * a.min(b) })],
        way in [-1.0..1.0f64, -1.0..1.0], depth in 0.0..1.0f64, step in 0.1..4.0f64,
        steps in prop::collection::vec([-1.0..1.0f64, -1.0..1.0], 40)
    ) {
        held(shape, way, depth, step, &steps)?;
    }

    #[test]
    fn a_wall_in_space_holds_steps_of_any_length(
        shape in spatial(), way in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0], depth in 0.0..1.0f64, step in 0.1..4.0f64,
        steps in prop::collection::vec([-1.0..1.0f64, -1.0..1.0, -1.0..1.0], 40)
    ) {
        held(shape, way, depth, step, &steps)?;
    }

    #[test]
    fn nothing_of_a_flat_body_is_farther_than_the_farthest(
        shape in flat(), n in [-1.0..1.0f64, -1.0..1.0], ways in prop::collection::vec([-1.0..1.0f64, -1.0..1.0], 200)
    ) {
        farthest(shape, n, &ways)?;
    }

    #[test]
    fn nothing_of_a_spatial_body_is_farther_than_the_farthest(
        shape in spatial(), n in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0],
        ways in prop::collection::vec([-1.0..1.0f64, -1.0..1.0, -1.0..1.0], 200)
    ) {
        farthest(shape, n, &ways)?;
    }

    /// Half of the guard's skin is more than rounding makes of the distance from a body, however sharp its edges or thin it is.
    #[test]
    fn sharp_edges_and_thin_bodies_keep_their_distances(
        half in [0.004..0.5f64, 0.004..0.5, 0.004..0.5], share in -3.0..0.0f64, way in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0],
        beyond in -1e-3..1e-3f64,
    ) {
        let rounding = half.iter().fold(1.0f64, |m, x| m.min(*x)) * libm::pow(10.0, share);
        let (flat, plane) = ([half[0], half[1]], [way[0], way[1]]);
        let most = 8.0 * crate::Fixed::EPSILON.to_f64();
        for [found, exact] in [
            gaps::<crate::Fixed, 2>(flat, rounding, plane, beyond),
            gaps::<crate::Fixed, 3>(half, rounding, way, beyond),
            gaps::<f32, 2>(flat, rounding, plane, beyond),
            gaps::<f32, 3>(half, rounding, way, beyond),
        ] {
            prop_assert!((found - exact).abs() <= most, "{found} is {exact}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn gamma_is_one_where_the_body_ends(shape in spatial(), direction in prop::array::uniform3(-1.0..1.0f64)) {
        let o = Obstacle::new(ObstacleSpec { shape: shape.clone(), ..ObstacleSpec::default() }).unwrap();
        let surface = o.surface(&unit(direction));
        prop_assert!((o.gamma(&surface) - 1.0).abs() < 1e-9);
        prop_assert!(inside3(&shape, &(surface * 0.999_999)) && !inside3(&shape, &(surface * 1.000_001)));
        // homogeneous: twice as far is 4^p
        let four = 4f64.powi(i32::from(shape.body(false).0.power()));
        prop_assert!((o.gamma(&(surface * 2.0)) / four - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_polygon_ends_at_its_edges(shape in star(), direction in prop::array::uniform2(-1.0..1.0f64)) {
        let o = Obstacle::new(ObstacleSpec { shape: shape.clone(), ..ObstacleSpec::default() }).unwrap();
        let surface = o.surface(&unit(direction));
        let Shape::Polygon(polygon) = &shape else { unreachable!() };
        prop_assert!(inside_polygon(polygon.vertices(), &(surface * 0.999_999)));
        prop_assert!(!inside_polygon(polygon.vertices(), &(surface * 1.000_001)));
    }

    #[test]
    fn gradient_is_the_slope_of_gamma(shape in spatial(), x in prop::array::uniform3(-0.4..0.4f64), wall in any::<bool>()) {
        let x = V3::from(x);
        let o = Obstacle::new(ObstacleSpec { shape, wall, ..ObstacleSpec::default() }).unwrap();
        prop_assume!(x.norm() > 0.02 && o.gamma(&x) < 1e6);
        let gradient = o.gradient(&x);
        for i in 0..3 {
            let step = V3::from_fn(|j, _| if i == j { 1e-7 } else { 0.0 });
            let slope = (o.gamma(&(x + step)) - o.gamma(&(x - step))) / 2e-7;
            prop_assert!((slope - gradient[i]).abs() <= 2e-4 * (1.0 + gradient.norm() + o.gamma(&x)), "{slope} {gradient}");
        }
    }

    #[test]
    fn the_normal_turns_without_a_jump(shape in flat(), angle in -3.1..3.1f64, far in 1.001..3.0f64) {
        let o = Obstacle::new(ObstacleSpec { shape, ..ObstacleSpec::default() }).unwrap();
        let at = |a: f64| o.surface(&V2::new(a.cos(), a.sin())) * far;
        let normal = |a: f64| o.gradient(&at(a)).normalize();
        prop_assert!((normal(angle + 1e-8) - normal(angle)).norm() < 1e-4);
    }

    #[test]
    fn what_keeps_the_half_spaces_stays_outside(
        shape in flat(), wall in any::<bool>(), direction in prop::array::uniform2(-1.0..1.0f64), off in -0.2..1.0f64,
        margin in prop::array::uniform2(1.0..1.5f64), angle in -3.0..3.0f64,
        steps in prop::collection::vec(prop::array::uniform2(-1.5..1.5f64), 30),
    ) {
        let margin = if let Shape::Polygon(_) = shape { [margin[0]; 2] } else { margin };
        let spec = ObstacleSpec { shape, wall, margin: margin.into(), rotation: rotation::planar(angle), ..ObstacleSpec::default() };
        let o = Obstacle::new(spec).unwrap();
        let step = 1e-3;
        let surface = o.surface(&unit(direction));
        let x = surface * (1.0 + if wall { -off } else { off } * step / surface.norm());
        let kept = kept_out(&o, &x, step, &steps)?;
        prop_assert!(kept > 0 || off < 0.05 || wall, "nothing is left to do at {off}");
    }

    #[test]
    fn and_in_space(
        shape in spatial(), wall in any::<bool>(), direction in prop::array::uniform3(-1.0..1.0f64), off in -0.2..1.0f64,
        margin in prop::array::uniform3(1.0..1.5f64), steps in prop::collection::vec(prop::array::uniform3(-1.5..1.5f64), 30),
    ) {
        let rotation = rotation::spatial([0.8, 0.36, -0.48, 0.0]).unwrap();
        let o = Obstacle::new(ObstacleSpec { shape, wall, margin: margin.into(), rotation, ..ObstacleSpec::default() }).unwrap();
        let step = 1e-3;
        let surface = o.surface(&unit(direction));
        let x = surface * (1.0 + if wall { -off } else { off } * step / surface.norm());
        let kept = kept_out(&o, &x, step, &steps)?;
        prop_assert!(kept > 0 || off < 0.05 || wall, "nothing is left to do at {off}");
    }

    #[test]
    fn no_margin_or_growth_uncovers_a_part(
        shape in flat(), direction in prop::array::uniform2(-1.0..1.0f64), margin in 1.0..2.0f64, growth in 0.0..1.0f64,
    ) {
        let plain = Obstacle::new(ObstacleSpec { shape: shape.clone(), ..ObstacleSpec::default() }).unwrap();
        let margin = V2::repeat(margin);
        let mut larger = Obstacle::new(ObstacleSpec { shape, margin, growth, ..ObstacleSpec::default() }).unwrap();
        larger.advance(0.1);
        larger.ages(0.1);
        larger.age(0.1);
        prop_assert!(larger.gamma(&plain.surface(&unit(direction))) <= 1.0 + 1e-9);
    }

    #[test]
    fn a_surface_never_comes_faster_than_it_says(
        shape in spatial(), direction in prop::array::uniform3(-1.0..1.0f64), growth in -1.0..1.0f64, wall in any::<bool>(),
    ) {
        let o = Obstacle::new(ObstacleSpec { shape, growth, wall, ..ObstacleSpec::default() }).unwrap();
        let mut later = o.clone();
        later.advance(1e-7);
        let surface = o.surface(&unit(direction));
        let free = o.gradient(&surface);
        // How far the surface has come towards free space along its normal: the change of Gamma over its slope.
        let speed = (o.gamma(&surface) - later.gamma(&surface)) / free.norm() / 1e-7;
        let claimed = o.sample(&surface).surface_velocity.dot(&free.normalize());
        prop_assert!(claimed >= speed - 1e-4 * (1.0 + speed.abs()), "{claimed} {speed}");
    }
}

#[test]
fn the_centre_of_a_body_has_a_way_out() {
    for shape in [Shape::ellipsoid(V2::new(0.1, 0.2)), Shape::Box { half: V2::new(0.1, 0.2), rounding: 0.05 }] {
        let o = Obstacle::new(ObstacleSpec { shape, rotation: Matrix::identity(), ..ObstacleSpec::default() }).unwrap();
        let mut found = None;
        let from = Outlook { at: &V2::zeros(), wish: &V2::zeros(), step: 1e-3, reach: 1e-3, share: 1.0 };
        o.keep_out(&from, |n, gap| found = Some((n, gap)));
        let (n, gap) = found.unwrap();
        assert_eq!(n, V2::x());
        assert!((gap + 0.1).abs() < 1e-12);
    }
}

/// A triangle, often with an edge close by the origin.
fn thin() -> impl Strategy<Value = [[f64; 2]; 3]> {
    let corner = || (-0.9..0.9f64, -2.0..0.0f64);
    let flat = (-3.0..-1.0f64, -0.1..0.1f64).prop_map(|(thin, tip)| {
        let low = -libm::pow(10.0, thin);
        [[-0.1, low], [0.1, low], [tip, 0.2]]
    });
    let any = [corner(), corner(), corner()].prop_map(|corners| {
        let mut third = 0.0;
        corners.map(|(turn, size)| {
            let (angle, radius) = (third + turn, libm::pow(10.0, size));
            third += 2.09;
            [radius * libm::cos(angle), radius * libm::sin(angle)]
        })
    });
    prop_oneof![flat, any]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// However thin, seen from its origin or from a reference point as near to the line of an edge as is taken.
    #[test]
    fn the_normal_of_a_polygon_leads_away_from_every_reference_point(
        corners in thin(),
        towards in prop::array::uniform2(-1.0..1.0f64),
        share in 0.2..1.0f64,
        places in prop::collection::vec((0..3usize, -7.0..0.0f64, -6.0..1.0f64), 100),
    ) {
        let polygon = Polygon::new(&corners).unwrap();
        let spec = ObstacleSpec { shape: Shape::Polygon(polygon.clone()), ..ObstacleSpec::default() };
        prop_assume!(Obstacle::new(spec.clone()).is_ok());
        let shape = Shape::<f64, 2>::Polygon(polygon);
        let (body, scale) = shape.body(false);
        // Out to the nearest of the edges' lines.
        let unit: V2 = unit(towards);
        let room = |p: &V2, i: usize| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 3]);
            (bx - ax) * (p.y - ay) - (by - ay) * (p.x - ax)
        };
        let zero = V2::zeros();
        // The least of the three lines' distances from the origin, in scaled coordinates.
        let side = |i: usize| V2::from(corners[(i + 1) % 3]) - V2::from(corners[i]);
        let nearest = (0..3).map(|i| room(&zero, i) / side(i).norm() / scale.x).fold(f64::MAX, f64::min);
        let closer = |p: &V2| (0..3).map(|i| room(p, i) / room(&zero, i)).fold(1.0, f64::min);
        let reach = share / (1.0 - closer(&(unit * 1e-6))) * 1e-6;
        let reference = unit * reach;
        let taken = Obstacle::new(ObstacleSpec { reference, ..spec });
        prop_assert_eq!(taken.is_ok(), closer(&reference) > 0.2, "{}", closer(&reference));
        let reference = if taken.is_ok() { reference } else { zero };
        for (corner, along, far) in places {
            for before in [false, true] {
                let to = corners[(corner + if before { 2 } else { 1 }) % 3];
                let (from, to) = (V2::from(corners[corner]), V2::from(to));
                let x = (from + (to - from) * libm::pow(10.0, along)) * (1.0 + libm::pow(10.0, far));
                for seen in [zero, reference] {
                    let (gamma, normal) = body.level(&shape, &x.component_div(&scale));
                    let away = normal.dot(&(x - seen).component_div(&scale)) / libm::sqrt(gamma);
                    prop_assert!(away > 0.099 * nearest, "{} from {} of {:?} at {}", away, seen, corners, x);
                }
            }
        }
    }
}
