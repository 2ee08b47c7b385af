use super::super::random_scene::{Recipe, generate_from};
use super::*;

fn v(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
}

fn shape(shape: OracleShape) -> Shape {
    let d = match &shape {
        OracleShape::Ellipsoid { axes: all, .. } | OracleShape::Box { half: all, .. } => all.len(),
        OracleShape::Polygon { .. } => 2,
        _ => 3,
    };
    Shape::new(&shape, d).unwrap()
}

fn close(a: &DVector<f64>, b: &[f64]) {
    assert!((a - v(b)).amax() < 1e-14, "{a} {b:?}");
}

#[test]
fn a_box_by_hand() {
    // The inner box is 1.5 by 0.5, with 0.5 around it.
    let rounded = shape(OracleShape::Box { half: vec![2.0, 1.0], rounding: 0.5 });
    assert!((rounded.gauge(&v(&[3.0, 0.0])) - 1.5).abs() < 1e-14);
    assert!((rounded.gauge(&v(&[0.7, -2.0])) - 2.0).abs() < 1e-14);
    close(&rounded.gauge_gradient(&v(&[0.7, -2.0])), &[0.0, -1.0]);
    close(&rounded.gauge_gradient(&v(&[-3.0, 0.4])), &[-0.5, 0.0]);
    // On the rim at 0.6, 0.8 from the corner of the inner box: (1.8, 0.9), m.(1.8, 0.9) = 1.8.
    let rim = v(&[1.8, 0.9]) * 3.0;
    assert!((rounded.gauge(&rim) - 3.0).abs() < 1e-14);
    close(&rounded.gauge_gradient(&rim), &[0.6 / 1.8, 0.8 / 1.8]);
    assert_eq!((rounded.gauge(&v(&[0.0, 0.0])), rounded.gamma(&v(&[4.0, 0.0]))), (0.0, 4.0));
}

#[test]
fn a_box_rounded_in_full_is_a_ball() {
    let ball = shape(OracleShape::Box { half: vec![0.5; 3], rounding: 0.5 });
    let y = v(&[0.3, -1.2, 0.4]);
    assert!((ball.gauge(&y) - 2.0 * 1.3).abs() < 1e-14);
    close(&ball.gauge_gradient(&y), &[0.6 / 1.3, -2.4 / 1.3, 0.8 / 1.3]);
}

#[test]
fn a_cylinder_and_a_capsule_by_hand() {
    let cylinder = shape(OracleShape::Cylinder { radius: 1.0, half_length: 2.0, rounding: 0.25 });
    assert!((cylinder.gauge(&v(&[1.2, 1.6, 0.5])) - 2.0).abs() < 1e-14);
    close(&cylinder.gauge_gradient(&v(&[1.2, 1.6, 0.5])), &[0.6, 0.8, 0.0]);
    assert!((cylinder.gauge(&v(&[0.3, 0.3, -3.0])) - 1.5).abs() < 1e-14);
    close(&cylinder.gauge_gradient(&v(&[0.3, 0.3, -3.0])), &[0.0, 0.0, -0.5]);
    // On the rim, 0.8 out and 0.6 up of the inner rim's circle of 0.75 at 1.75: m.s = 0.8 * 0.95 + 0.6 * 1.9.
    let rim = v(&[0.95, 0.0, 1.9]);
    assert!((cylinder.gauge(&rim) - 1.0).abs() < 1e-14);
    close(&cylinder.gauge_gradient(&rim), &[0.8 / 1.9, 0.0, 0.6 / 1.9]);

    let capsule = shape(OracleShape::Capsule { radius: 0.5, half_length: 1.0 });
    assert!((capsule.gauge(&v(&[0.0, -1.0, 0.3])) - 2.0).abs() < 1e-14);
    assert!((capsule.gauge(&v(&[0.0, 0.0, 3.0])) - 2.0).abs() < 1e-14);
    // 0.3, 0.4 beyond the end of the segment; m.s = 0.6 * 0.3 + 0.8 * 1.4 = 1.3.
    let cap = v(&[0.3, 0.0, 1.4]);
    assert!((capsule.gauge(&(&cap * 2.0)) - 2.0).abs() < 1e-14);
    close(&capsule.gauge_gradient(&cap), &[0.6 / 1.3, 0.0, 0.8 / 1.3]);
}

#[test]
fn a_square_polygon_by_hand() {
    let square = shape(OracleShape::Polygon { vertices: vec![[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]] });
    assert_eq!(square.gauge(&v(&[3.0, 1.0])), 3.0);
    close(&square.gauge_gradient(&v(&[3.0, 0.5])), &[1.0, 0.0]);
    // On the ray through (1, 0.8): t = 0.9, b = 1/4.
    close(&square.gauge_gradient(&v(&[2.0, 1.6])), &[1.5 / 1.9, 0.5 / 1.9]);
    // Through (0.9, 1): t = 0.05, a = 3/8. At the corner both count alike.
    close(&square.gauge_gradient(&v(&[0.9, 1.0])), &[0.375 / 0.9625, 0.625 / 0.9625]);
    close(&square.gauge_gradient(&v(&[1.0, 1.0])), &[0.5, 0.5]);
    assert!((square.gamma(&v(&[-2.0, 0.3])) - 4.0).abs() < 1e-15);
}

#[test]
fn the_direction_of_a_polygon_does_not_jump() {
    for seed in 0..40 {
        let recipe = Recipe { shapes: 1.0, obstacles: 4..=4, ..Recipe::new(2) };
        for obstacle in generate_from(&recipe, seed, 0).scene.obstacles {
            let polygon = shape(obstacle.shape);
            if !matches!(polygon, Shape::Star(_)) {
                continue;
            }
            let at = |i: i32| {
                let (sin, cos) = (1e-3 * f64::from(i)).sin_cos();
                let own = polygon.gauge_gradient(&v(&[cos, sin]));
                let size = own.norm();
                assert!((own.dot(&v(&[cos, sin]))).is_finite() && size > 0.0);
                own / size
            };
            let jump = (0..6284).map(|i| (at(i) - at(i + 1)).norm()).fold(0.0, f64::max);
            assert!(jump < 0.3, "{jump}");
        }
    }
}

#[test]
fn gradients_are_those_of_finite_differences() {
    let mut checked = 0;
    for seed in 0..120 {
        let recipe = Recipe { shapes: 0.8, obstacles: 2..=2, ..Recipe::new(2 + (seed % 2) as usize) };
        for obstacle in generate_from(&recipe, seed, 0).scene.obstacles {
            let own = shape(obstacle.shape.clone());
            let extents = v(&obstacle.shape.semi_extents());
            for ray in [[1.0, 0.3, -0.2], [-0.4, 1.0, 0.9], [0.1, -0.2, 1.0], [-1.0, -0.97, 0.4]] {
                let y = v(&ray[..extents.len()]).component_mul(&extents);
                let slope = own.gauge_gradient(&y);
                // Euler: the gauge grows in proportion.
                let gauge = own.gauge(&y);
                let polygon = matches!(own, Shape::Star(_));
                assert!(polygon || (slope.dot(&y) / gauge - 1.0).abs() < 1e-13, "{obstacle:?}");
                if polygon && !plain_edge(&own, &y) {
                    continue;
                }
                for i in 0..y.len() {
                    let mut step = DVector::zeros(y.len());
                    step[i] = 1e-6 * extents[i];
                    let rise = (own.gauge(&(&y + &step)) - own.gauge(&(&y - &step))) / (2.0 * step[i]);
                    assert!((rise - slope[i]).abs() * extents[i] < 1e-4, "{obstacle:?} at {y}: {rise} {slope}");
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 1500, "{checked}");
}

/// Away from the corners, where the page's direction is that of the edge.
fn plain_edge(shape: &Shape, y: &DVector<f64>) -> bool {
    (shape.gauge_gradient(y).dot(y) / shape.gauge(y) - 1.0).abs() < 1e-12
        && (shape.gauge_gradient(y) - shape.gauge_gradient(&(y + turned_left(y) * 1e-4))).norm() < 1e-9
        && (shape.gauge_gradient(y) - shape.gauge_gradient(&(y - turned_left(y) * 1e-4))).norm() < 1e-9
}

#[test]
fn shapes_that_cannot_be_are_refused() {
    let refused = |shape: OracleShape, d| Shape::new(&shape, d).err();
    let boxed = |rounding| OracleShape::Box { half: vec![1.0, 0.5], rounding };
    assert_eq!(refused(boxed(0.5), 2), None);
    assert_eq!(refused(boxed(0.6), 2), Some(OracleError::Value("rounding")));
    assert_eq!(refused(boxed(0.0), 2), Some(OracleError::Value("rounding")));
    assert_eq!(refused(OracleShape::Capsule { radius: 1.0, half_length: 1.0 }, 2), Some(OracleError::Shape("shape")));
    let polygon = |vertices: &[[f64; 2]]| OracleShape::Polygon { vertices: vertices.to_vec() };
    assert_eq!(refused(polygon(&[[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]]), 2), None);
    // Clockwise, without the origin inside, and twice around.
    let corners = Some(OracleError::Value("corners"));
    assert_eq!(refused(polygon(&[[1.0, 0.0], [-1.0, -1.0], [-1.0, 1.0]]), 2), corners);
    assert_eq!(refused(polygon(&[[1.0, 0.0], [2.0, 0.0], [1.5, 1.0]]), 2), corners);
    let twice: Vec<[f64; 2]> = (0..6).map(|i| f64::from(i) * 2.2).map(|a| [a.cos(), a.sin()]).collect();
    assert_eq!(refused(polygon(&twice), 2), corners);
}
