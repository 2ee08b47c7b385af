//! And what is driven, after the limits and the guard: it is turned as well.

use crate::frames::{Frame, farthest, parts};
use crate::world::scene::{PLACES, place};
use crate::world::{is_long, numbers, random, share, turn, vector, within};
use pliant_core::scalar::Fixed;
use pliant_core::{Command, Controller, Matrix, Obstacle, RobotState, Scalar, Shape, Status, Vector};

const DT: f64 = 1e-3;
/// What is done to a distance on its way is no worse than this many units of rounding of the numbers it is made from.
const UNITS: f64 = 64.0;
const NEIGHBOURS: usize = 3;

fn tick<S: Scalar, const D: usize>(controller: &Controller<S, D, 16>, x: &Vector<f64, D>) -> Command<S, D> {
    controller.clone().tick(&RobotState::new(x.map(S::from_f64)).unwrap(), S::from_f64(DT))
}

/// Is x as near to a surface as a hundredth of the way from the centre?
fn touches<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &Vector<f64, D>) -> bool {
    (o.gamma(&x.map(S::from_f64)).to_f64() - 1.0).abs() < 0.02
}

/// Distances are known to a rounding, so velocities that keep them to that over dt; by more only where the velocity before the guard differs by more,
/// which is measured in neighbouring worlds. The least violation of half-spaces that leave nothing is flat about its best, where it moves by a root.
fn driven<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let eps = S::EPSILON.to_f64();
    let (one, none) = (Matrix::identity(), Vector::zeros());
    let (mut compared, mut guarded, mut infeasible) = (0u64, 0u64, 0u64);
    let (mut others, mut blurred, mut worst) = (0u64, 0u64, 0.0f64);
    while compared < share(2) {
        let q = turn::<f64, D>(r);
        let t: Vector<f64, D> = vector(&within(r, 0.8));
        let mut parts = parts::<D>(r);
        parts.obstacles.retain(|o| Frame { q: one, t: none, jitter: 0.0, random: r }.obstacle::<S>(o).is_some());
        let here: Controller<S, D, 16> = Frame { q: one, t: none, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let there: Controller<S, D, 16> = Frame { q, t, jitter: 0.0, random: r }.controller(&parts).unwrap();
        // Of a cluster another common point does as well, and the flow is another.
        if farthest(&here, &there, |x| q * x + t) > UNITS * eps {
            continue;
        }
        let near: Option<Vec<Controller<S, D, 16>>> =
            (0..NEIGHBOURS).map(|_| Frame { q: one, t: none, jitter: eps, random: r }.controller(&parts)).collect();
        let Some(near) = near else { continue };
        let obstacles: Vec<_> = here.table().iter().map(|e| e.obstacle().clone()).collect();
        for _ in 0..PLACES {
            let x = numbers(&place(r, &obstacles));
            let (a, b) = (tick(&here, &x), tick(&there, &(q * x + t)));
            compared += 1;
            guarded += u64::from(a.status.contains(Status::GUARDED));
            // Rounding may decide what there is to say, as at a surface.
            if a.status != b.status {
                others += 1;
                continue;
            }
            let speed = here.settings().limits.speed.to_f64();
            let mut bound = UNITS * eps * x.amax().max(1.0) / DT;
            if a.status.contains(Status::INFEASIBLE) {
                infeasible += 1;
                bound += 4.0 * eps.sqrt() * speed;
            }
            let changes = near.iter().map(|c| (numbers(&tick(c, &x).velocity) - numbers(&a.velocity)).norm());
            bound += UNITS * changes.fold(0.0, f64::max);
            let error = (q * numbers(&a.velocity) - numbers(&b.velocity)).norm();
            if error > bound && !S::FLOATS {
                // Beside a polygon's corner the way from it has as many digits as its distance has.
                blurred += 1;
                let beside = obstacles.iter().any(|o| matches!(o.spec().shape, Shape::Polygon(_)) && touches(o, &x));
                assert!(beside, "{error:e} over {bound:e} at {x}: {a:?} {b:?} of {here:?}");
                continue;
            }
            worst = worst.max(error / bound);
            assert!(error <= bound, "{error:e} over {bound:e} at {x}: {a:?} {b:?} of {here:?}");
        }
    }
    println!("{D}-D: {compared}, {guarded} guarded, {infeasible} infeasible, worst {worst}");
    println!("{others} with another status, {blurred} blurred");
    if is_long() {
        assert!(5 * guarded > compared && 20 * infeasible > compared, "nothing was tried");
        let rarely = if S::FLOATS { 5000 } else { 1000 };
        assert!(rarely * others < compared && 50_000 * blurred < compared, "too often");
    }
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { driven::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    driven_2d_f64: f64, 2, 61;
    driven_3d_f64: f64, 3, 62;
    driven_2d_f32: f32, 2, 63;
    driven_3d_f32: f32, 3, 64;
    driven_2d_fixed: Fixed, 2, 65;
    driven_3d_fixed: Fixed, 3, 66;
}
