//! Whether cores overlap, and by how much: the least of the largest gauge over the convex pieces of the cores, found by
//! cutting down an ellipsoid that holds it.

use nalgebra::{DMatrix, DVector};

use super::super::geometry::{length, tangents, unit};
use super::super::guard::{Bound, inner_ball, pieces};
use super::super::obstacle::Body;
use super::super::polygon::SIGHT;
use super::super::shape::Shape;

/// A depth of less than this, as a share of the shapes' size, is too little to tell.
pub(in super::super) const CLEAR: f64 = 0.01;
const STEPS: usize = 600;

/// How cores stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// No point in common, clearly.
    Apart,
    /// Too close to tell.
    Unclear,
    /// Points in common, clearly.
    Common,
}

/// A convex part of a core, as a function that is 0 on its surface and below inside.
enum Piece<'a> {
    Whole(&'a Body),
    Part { planes: Vec<Bound>, size: f64 },
}

impl Piece<'_> {
    /// The function and a slope of it.
    fn at(&self, x: &DVector<f64>) -> (f64, DVector<f64>) {
        match self {
            Self::Whole(body) => (body.gauge(x) - 1.0, body.gauge_gradient(x)),
            Self::Part { planes, size } => {
                planes.iter().fold((f64::NEG_INFINITY, DVector::zeros(x.len())), |worst, plane| {
                    let beyond = (plane.least - plane.normal.dot(x)) / size;
                    if beyond > worst.0 { (beyond, &plane.normal * (-1.0 / size)) } else { worst }
                })
            }
        }
    }
}

fn parts(body: &Body) -> Vec<Piece<'_>> {
    match body.shape {
        Shape::Star(_) => pieces(body).into_iter().map(|planes| Piece::Part { planes, size: body.bound() }).collect(),
        _ => vec![Piece::Whole(body)],
    }
}

/// Where the reference point of a core may be.
fn sight(body: &Body) -> Vec<Piece<'_>> {
    let Shape::Star(star) = &body.shape else {
        return parts(body);
    };
    let planes = star.slopes().iter().map(|slope| {
        let out = &body.rotation * slope.component_div(&body.hard);
        let steep = length(&out);
        let normal = -out / steep;
        Bound { least: normal.dot(&body.center) - SIGHT / steep, normal }
    });
    vec![Piece::Part { planes: planes.collect(), size: body.bound() }]
}

/// Whether the cores of some obstacles, none of them a wall, have a point in common.
pub(in super::super) fn common(bodies: &[&Body]) -> Sharing {
    together(bodies, |body| parts(body))
}

/// Whether they have one where each may have its reference point.
pub(in super::super) fn in_sight(bodies: &[&Body]) -> Sharing {
    together(bodies, |body| sight(body))
}

/// Whether a parent's core reaches where a child, which is no wall, may have its reference point.
pub(in super::super) fn sight_and_core(child: &Body, parent: &Body) -> Sharing {
    if parent.wall {
        return beyond(parent, child, &|ray| match &child.shape {
            Shape::Star(star) => SIGHT / star.beyond(&ray.component_div(&child.hard)),
            _ => child.reach(ray, 1.0, false),
        });
    }
    together(&[child, parent], |body| if std::ptr::eq(body, child) { sight(body) } else { parts(body) })
}

fn together<'a>(bodies: &[&'a Body], parts: impl Fn(&'a Body) -> Vec<Piece<'a>>) -> Sharing {
    for (i, a) in bodies.iter().enumerate() {
        for b in &bodies[i + 1..] {
            if length(&(&a.center - &b.center)) > (a.bound() + b.bound()) * (1.0 + CLEAR) {
                return Sharing::Apart;
            }
        }
    }
    let all: Vec<Vec<Piece>> = bodies.iter().map(|body| parts(body)).collect();
    let mut found = Sharing::Apart;
    let mut choice = vec![0; all.len()];
    // Every choice of one piece from each core.
    loop {
        let chosen: Vec<&Piece> = all.iter().zip(&choice).map(|(own, i)| &own[*i]).collect();
        match least(&chosen, bodies) {
            Sharing::Common => return Sharing::Common,
            Sharing::Unclear => found = Sharing::Unclear,
            Sharing::Apart => {}
        }
        let Some(next) = (0..all.len()).find(|n| choice[*n] + 1 < all[*n].len()) else {
            return found;
        };
        choice[next] += 1;
        choice[..next].fill(0);
    }
}

/// The sign of the least of the largest of the pieces' functions.
fn least(chosen: &[&Piece], bodies: &[&Body]) -> Sharing {
    let d = bodies[0].center.len() as f64;
    let smallest = bodies.iter().min_by(|a, b| a.bound().total_cmp(&b.bound()));
    let Some(smallest) = smallest else {
        return Sharing::Apart;
    };
    // A common point is in the ball around the smallest.
    let mut x = smallest.center.clone();
    let mut shape = DMatrix::identity(x.len(), x.len()) * smallest.bound().powi(2);
    let mut lowest = f64::INFINITY;
    for _ in 0..STEPS {
        let (value, slope) = chosen
            .iter()
            .map(|piece| piece.at(&x))
            .fold((f64::NEG_INFINITY, DVector::zeros(x.len())), |worst, own| if own.0 > worst.0 { own } else { worst });
        lowest = lowest.min(value);
        let reach = slope.dot(&(&shape * &slope)).max(0.0).sqrt();
        if lowest < -CLEAR {
            return Sharing::Common;
        }
        if value - reach > CLEAR {
            return Sharing::Apart;
        }
        if reach < 0.1 * CLEAR {
            break;
        }
        let step = &shape * slope / reach;
        x -= &step / (d + 1.0);
        shape = (shape - &step * step.transpose() * (2.0 / (d + 1.0))) * (d * d / (d * d - 1.0));
    }
    Sharing::Unclear
}

/// Whether a core sticks out of a wall.
pub(in super::super) fn through(wall: &Body, body: &Body) -> Sharing {
    beyond(wall, body, &|ray| body.reach(ray, 1.0, false))
}

/// The same with a reach of the body's along a ray of its frame.
fn beyond(wall: &Body, body: &Body, reach: &dyn Fn(&DVector<f64>) -> f64) -> Sharing {
    let away = length(&(&body.center - &wall.center)) + body.bound();
    if away < inner_ball(wall) * (1.0 - CLEAR) {
        return Sharing::Apart;
    }
    let d = body.center.len();
    let out = |ray: &DVector<f64>| wall.gauge(&body.world(&(ray * reach(ray))));
    let (mut best, mut ray) = (0.0, DVector::zeros(d));
    for candidate in rays(d) {
        let value = out(&candidate);
        if value > best {
            (best, ray) = (value, candidate);
        }
    }
    // From the best direction on, by ever smaller turns.
    let mut turn = 0.1;
    while turn > 1e-5 {
        let around = tangents(&ray).into_iter().flat_map(|t| [&ray + &t * turn, &ray - &t * turn]);
        let better = around.filter_map(|r| unit(&r)).map(|r| (out(&r), r)).find(|(value, _)| *value > best);
        match better {
            Some((value, r)) => (best, ray) = (value, r),
            None => turn *= 0.5,
        }
    }
    match best - 1.0 {
        depth if depth > CLEAR => Sharing::Common,
        depth if depth < -CLEAR => Sharing::Apart,
        _ => Sharing::Unclear,
    }
}

/// Directions all around.
fn rays(d: usize) -> Vec<DVector<f64>> {
    let count = if d == 2 { 180 } else { 400 };
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count)
        .map(|i| {
            let i = f64::from(i);
            if d == 2 {
                let (sin, cos) = (i * std::f64::consts::TAU / 180.0).sin_cos();
                return DVector::from_column_slice(&[cos, sin]);
            }
            let z = 1.0 - (2.0 * i + 1.0) / 400.0;
            let (sin, cos) = (i * golden).sin_cos();
            let across = (1.0 - z * z).sqrt();
            DVector::from_column_slice(&[across * cos, across * sin, z])
        })
        .collect()
}
