//! Clusters, scans, growth and moving attractors: what a robot does among them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::{
    Ageing, Controller, Fixed, Guard, Limits, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Scan, Settings,
    Shape, Status, SteeringPolicy, Table, Vector, rotation,
};
use rand::{Rng, SeedableRng};

type V = Vector<f64, 2>;

const FOREVER: Ageing<f64> = Ageing { time_to_live: 3600.0, growth: 0.02, hold: 3600.0 };

fn controller(attractor: V) -> Controller<f64, 2, 16> {
    let settings = Settings { ageing: FOREVER, ..Settings::default() };
    Controller::new(Motion::linear(attractor, 2.0).unwrap(), settings)
}

fn ellipse(x: f64, y: f64, a: f64, b: f64, angle: f64) -> ObstacleSpec<f64, 2> {
    ObstacleSpec {
        center: V::new(x, y),
        rotation: rotation::planar(angle),
        shape: Shape::ellipsoid(V::new(a, b)),
        ..ObstacleSpec::default()
    }
}

fn put(c: &mut Controller<f64, 2, 16>, specs: &[ObstacleSpec<f64, 2>]) {
    for (id, spec) in specs.iter().enumerate() {
        c.upsert(id as u16, Obstacle::new(spec.clone()).unwrap(), 0.0).unwrap();
    }
}

fn reference(c: &Controller<f64, 2, 16>, id: u16) -> V {
    c.table().iter().find(|e| e.id() == id).unwrap().obstacle().reference()
}

fn gamma(c: &Controller<f64, 2, 16>, id: u16, x: &V) -> f64 {
    c.table().iter().find(|e| e.id() == id).unwrap().obstacle().gamma(x)
}

/// Drives for `seconds`; the last position, the least Gamma on the way, and all flags that were set.
fn drive(c: &mut Controller<f64, 2, 16>, mut x: V, seconds: f64) -> (V, f64, Status) {
    let (mut least, mut flags) = (f64::MAX, Status::empty());
    for _ in 0..(seconds * 1000.0) as u32 {
        let command = c.tick(&RobotState::new(x).unwrap(), 0.001);
        x += command.velocity * 0.001;
        least = least.min(command.gamma);
        flags |= command.status;
    }
    (x, least, flags)
}

#[test]
fn two_that_overlap_share_the_best_point() {
    let mut c = controller(V::zeros());
    put(&mut c, &[ellipse(0.5, 0.0, 0.1, 0.05, 0.4), ellipse(0.6, 0.08, 0.1, 0.04, -0.8)]);
    let shared = reference(&c, 0);
    assert!((shared - reference(&c, 1)).norm() < 1e-12);
    let worst = |x: &V| gamma(&c, 0, x).max(gamma(&c, 1, x));
    assert!(worst(&shared) < 1.0);
    for i in 0..60 {
        let (sin, cos) = (f64::from(i) * 0.1047).sin_cos();
        assert!(worst(&(shared + V::new(cos, sin) * 1e-4)) >= worst(&shared) - 1e-12, "not the minimiser");
    }
    assert!(c.table_mut().remove(1));
    assert_eq!(reference(&c, 0), V::new(0.5, 0.0), "alone again");
}

#[test]
fn the_flow_goes_round_a_union_and_round_a_chain() {
    // Four in a row across the way; each overlaps only the next.
    let chain: Vec<_> = (0..4).map(|i| ellipse(0.4, -0.15 + 0.1 * f64::from(i), 0.05, 0.07, 0.0)).collect();
    for specs in [&chain[1..3], &chain[..]] {
        for y in [-0.21, -0.12, -0.031, 0.013, 0.1, 0.22] {
            let mut c = controller(V::zeros());
            put(&mut c, specs);
            let (end, least, flags) = drive(&mut c, V::new(0.8, y), 15.0);
            assert!(end.norm() < 0.01, "from {y} past {} to {end}", specs.len());
            assert!(least > 1.0 && !flags.contains(Status::INFEASIBLE), "{least} {flags:?}");
            assert_eq!(flags.contains(Status::CLUSTER), specs.len() > 2, "only two have a point in common");
        }
    }
}

#[test]
fn a_child_refers_into_its_parent() {
    let chain: Vec<_> = (0..4).map(|i| ellipse(0.4, 0.1 * f64::from(i), 0.05, 0.07, 0.0)).collect();
    let mut c = controller(V::zeros());
    put(&mut c, &chain);
    // Of the two in the middle, both with two neighbours, the first is the root.
    assert_eq!(reference(&c, 1), chain[1].center);
    for (child, parent) in [(0, 1), (2, 1), (3, 2)] {
        let (point, towards) = (reference(&c, child), reference(&c, parent));
        let own = chain[usize::from(child)].center;
        assert!(
            gamma(&c, child, &point) < 1.0 && (point - towards).norm() < (own - towards).norm(),
            "{child} in {parent}"
        );
    }
}

#[test]
fn without_a_point_in_common_the_status_says_so() {
    let ring = |n: u32, radius: f64| -> Vec<_> {
        let at = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
        (0..n).map(|i| ellipse(radius * at(i).cos(), radius * at(i).sin(), 0.1, 0.1, 0.0)).collect()
    };
    let flags = |specs: &[ObstacleSpec<f64, 2>]| {
        let mut c = controller(V::new(2.0, 0.0));
        put(&mut c, specs);
        c.tick(&RobotState::new(V::new(1.0, 1.0)).unwrap(), 0.001).status
    };
    assert!(flags(&ring(6, 0.18)).contains(Status::CLUSTER));
    assert!(flags(&ring(3, 0.11)).contains(Status::CLUSTER), "three that overlap in pairs only");
    assert!(!flags(&ring(3, 0.09)).contains(Status::CLUSTER), "three with a point in common");
    assert!(!flags(&ring(5, 0.18)).contains(Status::CLUSTER), "five in a ring that do not touch");
    let row: Vec<_> = (0..3).map(|i| ellipse(0.15 * f64::from(i), 0.0, 0.1, 0.1, 0.0)).collect();
    assert!(flags(&row).contains(Status::CLUSTER), "three in a row");
    assert!(!flags(&row[1..]).contains(Status::CLUSTER), "two of them");
}

#[test]
fn an_obstacle_in_the_wall_refers_into_the_wall() {
    let room = ObstacleSpec {
        shape: Shape::Box { half: V::new(1.0, 0.6), rounding: 0.1 },
        wall: true,
        ..ObstacleSpec::default()
    };
    let mut c = controller(V::new(-0.7, 0.1));
    put(&mut c, &[room, ellipse(0.1, 0.55, 0.1, 0.12, 0.0)]);
    let point = reference(&c, 1);
    assert!(gamma(&c, 1, &point) < 1.0 && gamma(&c, 0, &point) < 1.0 && point.y > 0.6, "{point}");
    for y in [0.5, 0.3, 0.0, -0.5] {
        let mut c = c.clone();
        let (end, least, flags) = drive(&mut c, V::new(0.8, y), 15.0);
        assert!((end - V::new(-0.7, 0.1)).norm() < 0.01, "{y}: {end}");
        assert!(least > 1.0 && !flags.contains(Status::INFEASIBLE));
    }
}

fn row(x: f64, y: f64, n: u32) -> impl Iterator<Item = V> {
    (0..n).map(move |i| V::new(x, y + 0.01 * f64::from(i)))
}

#[test]
fn a_corridor_of_range_points_is_gone_through_and_a_dead_end_is_not_touched() {
    let (one, other): (Vec<V>, Vec<V>) = (row(0.0, 0.1, 40).collect(), row(0.16, 0.1, 40).collect());
    let corridor = [one, other].concat();
    for x in [0.02, 0.07, 0.08, 0.11, 0.13] {
        let mut c = controller(V::new(0.08, -0.2));
        c.set_scan(Scan::new(&corridor, 0.02).unwrap(), 0.0);
        let (end, least, flags) = drive(&mut c, V::new(x, 0.8), 25.0);
        assert!(least > 1.0 && !flags.contains(Status::INFEASIBLE), "{least}");
        assert!((end - V::new(0.08, -0.2)).norm() < 0.01, "from {x} to {end}");
    }
    // Straight at a flat row there is no way round that points alone could tell.
    let mut c = controller(V::zeros());
    c.set_scan(Scan::new(&row(0.4, -0.2, 40).collect::<Vec<_>>(), 0.02).unwrap(), 0.0);
    let (end, least, _) = drive(&mut c, V::new(0.8, -0.1), 25.0);
    assert!(least > 1.0 && end.x > 0.41, "{least} {end}");
}

#[test]
fn one_range_point_is_a_ball() {
    let mut one = controller(V::zeros());
    one.set_scan(Scan::new(&[V::new(0.4, 0.0)], 0.05).unwrap(), 0.0);
    let mut other = controller(V::zeros());
    put(&mut other, &[ellipse(0.4, 0.0, 0.05, 0.05, 0.0)]);
    for i in 0..200 {
        let angle = f64::from(i) * 0.0314;
        let x = RobotState::new(V::new(0.4 + 0.07 * angle.cos(), 0.07 * angle.sin())).unwrap();
        let (a, b) = (one.evaluate(&x), other.evaluate(&x));
        assert!((a.adapted - b.adapted).norm() < 1e-12, "{a:?} {b:?}");
    }
}

#[test]
fn a_growing_ball_pushes_and_a_shrinking_one_lets_by() {
    let ball = |growth: f64| ObstacleSpec { growth, ..ellipse(0.0, 0.0, 0.1, 0.1, 0.0) };
    let mut c = controller(V::new(0.15, 0.0));
    put(&mut c, &[ball(0.1)]);
    let (end, least, flags) = drive(&mut c, V::new(0.15, 0.0), 1.0);
    assert!(end.x > 0.199 && least > 1.0 && !flags.contains(Status::INFEASIBLE), "{end} {least} {flags:?}");
    let mut c = controller(V::zeros());
    put(&mut c, &[ball(-0.1)]);
    let (end, least, _) = drive(&mut c, V::new(0.15, 0.001), 2.0);
    assert!(end.norm() < 0.01 && least > 1.0, "{end}");
    let left = c.table().iter().next().unwrap().obstacle().surface(&V::x()).norm();
    assert!((left - 1e-4).abs() < 1e-9, "what shrinks ends as a speck: {left}");
}

#[test]
fn a_moving_attractor_is_caught_and_kept() {
    let mut c = controller(V::zeros());
    assert!(c.aim(&V::new(0.5, 0.0), &V::new(0.05, 0.1)));
    let (end, ..) = drive(&mut c, V::zeros(), 6.0);
    let there = c.motion().attractor();
    assert!((there - V::new(0.8, 0.6)).norm() < 1e-9, "{there}");
    assert!((end - there).norm() < 1e-3, "{end}");
    assert!(!c.aim(&V::new(f64::NAN, 0.0), &V::zeros()) && !c.aim(&V::new(1e4, 0.0), &V::zeros()));
    assert_eq!(c.motion().attractor(), there);
}

#[test]
fn squeezed_by_two_the_guard_says_so() {
    let mut c = controller(V::zeros());
    let from = |x: f64| ObstacleSpec { velocity: V::new(-2.0 * x.signum(), 0.0), ..ellipse(x, 0.0, 0.1, 0.4, 0.0) };
    put(&mut c, &[from(-0.2), from(0.2)]);
    let (_, _, flags) = drive(&mut c, V::zeros(), 0.06);
    assert!(flags.contains(Status::INFEASIBLE), "{flags:?}");
}

/// From where neither the robot nor its rate of approach would make it look.
#[test]
fn what_comes_faster_than_the_robot_goes_is_seen_in_time() {
    let mut entered = 0;
    for i in 0..400 {
        let mut c = controller(V::zeros());
        let guard = Some(Guard { approach: 1.0 });
        c.set_settings(Settings { guard, limits: Limits { speed: 1e-3, ..Limits::default() }, ..*c.settings() });
        let ahead = 0.05 + 1e-5 * f64::from(i);
        let way = rotation::planar(0.1 * f64::from(i));
        let velocity = way * V::new(-2.0, 0.0);
        put(
            &mut c,
            &[ObstacleSpec { center: way * V::new(ahead, 0.0), velocity, ..ellipse(0.0, 0.0, 0.05, 0.05, 0.0) }],
        );
        let command = c.tick(&RobotState::new(V::zeros()).unwrap(), 0.001);
        let inside = gamma(&c, 0, &(command.velocity * 0.001)) < 1.0;
        assert_eq!(command.status.contains(Status::INFEASIBLE), inside, "{ahead}: {command:?}");
        entered += i32::from(inside);
    }
    assert!((150..250).contains(&entered), "{entered}");
}

/// What the rate of approach would keep the robot from is nearer, but a push out of a core counts for more.
#[test]
fn what_comes_may_push_the_robot_towards_what_is_near() {
    for i in 0..400 {
        let mut c = controller(V::zeros());
        let way = rotation::planar(0.1 * f64::from(i));
        let ball = |x: f64, speed: f64| ObstacleSpec {
            center: way * V::new(x, 0.0),
            velocity: way * V::new(speed, 0.0),
            ..ellipse(0.0, 0.0, 0.05, 0.05, 0.0)
        };
        put(&mut c, &[ball(-0.0501, 0.25 + 5e-4 * f64::from(i)), ball(0.055, 0.0)]);
        let command = c.tick(&RobotState::new(V::zeros()).unwrap(), 0.001);
        assert!(!command.status.contains(Status::INFEASIBLE), "{i}: {command:?}");
        let x = command.velocity * 0.001;
        assert!(gamma(&c, 0, &x) >= 1.0 && gamma(&c, 1, &x) >= 1.0, "{i}: {command:?}");
    }
}

#[test]
fn one_ball_alone_bends_the_flow_as_in_the_book() {
    // Potential flow round a cylinder: M applied to a uniform flow.
    let mut c: Controller<f64, 2, 16> =
        Controller::new(Motion::linear(V::new(900.0, 0.0), 1.0).unwrap(), Settings::default());
    put(&mut c, &[ellipse(0.0, 0.0, 0.1, 0.1, 0.0)]);
    for i in 0..100 {
        let angle = f64::from(i) * 0.063;
        let x = V::new(angle.cos(), angle.sin()) * 0.15;
        let v = c.modulated(&RobotState::new(x).unwrap()) / 900.0;
        let (s, ratio) = ((2.0 * angle).sin_cos(), (0.1f64 / 0.15).powi(2));
        let book = V::new(1.0 - ratio * s.1, -ratio * s.0);
        assert!((v - book).norm() < 1e-3, "{v} {book}");
    }
}

#[test]
fn growth_by_ageing_is_seen_before_it_begins() {
    // At its time to live it begins to grow nearly as fast as the robot may go, and one sample may use up all of the distance.
    let settings = Settings {
        ageing: Ageing { time_to_live: 0.1, growth: 0.4, hold: 1.0 },
        guard: Some(Guard { approach: 1.0 }),
        ..Settings::default()
    };
    for i in 0..200 {
        let mut c: Controller<f64, 2, 16> = Controller::new(Motion::linear(V::new(-1.0, 0.0), 10.0).unwrap(), settings);
        put(&mut c, &[ellipse(0.0, 0.0, 0.05, 0.05, 0.0)]);
        let mut x = V::new(0.0995 + 1e-5 * f64::from(i), 0.0);
        for _ in 0..400 {
            let command = c.tick(&RobotState::new(x).unwrap(), 0.001);
            x += command.velocity * 0.001;
            let inside = gamma(&c, 0, &x) < 1.0;
            assert!(!inside || command.status.contains(Status::INFEASIBLE), "{i}: {x} {command:?}");
        }
    }
}

#[test]
fn a_tree_seen_from_its_root_is_gone_round_from_everywhere_to_everywhere() {
    let chain = [
        ellipse(0.03, 0.14, 0.12, 0.045, 0.9),
        ellipse(-0.03, 0.0, 0.1, 0.05, 1.7),
        ellipse(0.01, -0.14, 0.12, 0.045, 2.3),
    ];
    for way in 0..12 {
        let goal = rotation::planar(0.1 + 0.5 * f64::from(way)) * V::new(0.4, 0.0);
        for start in 0..40 {
            let mut c = controller(goal);
            put(&mut c, &chain);
            let x = -goal + V::new(0.011 * f64::from(start % 8), 0.02 * f64::from(start) - 0.39);
            if (0..3).any(|id| gamma(&c, id, &x) <= 1.0) {
                continue;
            }
            let (end, least, flags) = drive(&mut c, x, 15.0);
            assert!((end - goal).norm() < 0.01, "from {x} to {end}, not {goal}");
            assert!(least > 1.0 && flags.contains(Status::CLUSTER));
        }
    }
}

/// A core comes faster than the robot may go, at any length of step: it is entered with `INFEASIBLE` only, in fixed point too, where 1/dt is out of range.
#[test]
fn short_steps_are_guarded_as_others() {
    fn drive<S: Scalar>(dt: f64) {
        let s = S::from_f64;
        let mut controller: Controller<S, 2, 4> =
            Controller::new(Motion::linear(Vector::<S, 2>::zeros(), S::one()).unwrap(), Settings::default());
        let mut settings = *controller.settings();
        settings.limits.speed = s(0.5);
        controller.set_settings(settings);
        let coming = ObstacleSpec {
            shape: Shape::ellipsoid(Vector::<S, 2>::new(s(0.05), s(0.05))),
            center: Vector::<S, 2>::new(s(-0.06), S::zero()),
            velocity: Vector::<S, 2>::new(s(2.0), S::zero()),
            ..ObstacleSpec::default()
        };
        controller.upsert(1, Obstacle::new(coming).unwrap(), S::zero()).unwrap();
        let mut x = Vector::<f64, 2>::zeros();
        for n in 0..(0.02 / dt) as u32 {
            let state = RobotState::new(x.map(s)).unwrap();
            let command = controller.tick(&state, s(dt));
            x += command.velocity.map(|v| v.to_f64()) * s(dt).to_f64();
            let inside = controller.table().iter().any(|e| e.obstacle().gamma(&x.map(s)) < S::one());
            assert!(!inside || command.status.contains(Status::INFEASIBLE), "dt {dt}, {n}: {command:?}");
        }
    }
    for dt in [1e-3, 4e-4, 1e-4, 5e-5] {
        drive::<f64>(dt);
        drive::<f32>(dt);
        drive::<Fixed>(dt);
    }
}

/// A flat ellipsoid comes broadside: its nearest way out is across, though from the middle of the robot's place it looks longest.
#[test]
fn a_flat_ellipsoid_is_left_across() {
    fn drive<S: Scalar>() {
        let s = S::from_f64;
        let v = |x: f64, y: f64| Vector::<S, 2>::new(s(x), s(y));
        let mut controller: Controller<S, 2, 4> =
            Controller::new(Motion::linear(v(0.0, 1.0), S::one()).unwrap(), Settings::default());
        let mut settings = *controller.settings();
        settings.limits.speed = s(2.0);
        controller.set_settings(settings);
        let flat =
            ObstacleSpec { shape: Shape::ellipsoid(v(0.05, 0.005)), velocity: v(0.0, 2.0), ..ObstacleSpec::default() };
        controller.upsert(1, Obstacle::new(flat).unwrap(), S::zero()).unwrap();
        let state = RobotState::new(v(0.0475, 0.002)).unwrap();
        let command = controller.tick(&state, s(0.001));
        let next = state.position() + command.velocity * s(0.001);
        assert!(!command.status.contains(Status::INFEASIBLE), "{command:?}");
        assert!(controller.table().iter().all(|e| e.obstacle().gamma(&next) >= S::one()), "{command:?}");
    }
    drive::<f64>();
    drive::<f32>();
    drive::<Fixed>();
}

/// Whatever settings are given: those in force are within their ranges, and so is what they lead to.
#[test]
fn settings_out_of_range_lead_to_nothing_out_of_range() {
    fn drive<S: Scalar>(hostile: &[S]) {
        let s = S::from_f64;
        let v = |x: f64, y: f64| Vector::<S, 2>::new(s(x), s(y));
        let usual = Settings::<S>::default();
        let mut seen = 0;
        for x in hostile {
            let of = |limits: Limits<S>| Settings { limits, ..usual };
            let given = [
                of(Limits { speed: *x, ..usual.limits }),
                of(Limits { acceleration: Some(*x), ..usual.limits }),
                of(Limits { deceleration: *x, ..usual.limits }),
                Settings { gain: *x, ..usual },
                Settings { steering: SteeringPolicy::WithFlow { beta: *x }, ..usual },
                Settings { steering: SteeringPolicy::Fixed { cos: *x, sin: *x }, ..usual },
                Settings { guard: Some(Guard { approach: *x }), ..usual },
                Settings { ageing: Ageing { time_to_live: *x, ..usual.ageing }, ..usual },
                Settings { ageing: Ageing { growth: *x, ..usual.ageing }, ..usual },
                Settings { ageing: Ageing { hold: *x, ..usual.ageing }, ..usual },
            ];
            for settings in given {
                seen += u32::from(settings.check().is_err());
                let mut controller: Controller<S, 2, 4> =
                    Controller::new(Motion::linear(v(0.0, 0.0), S::one()).unwrap(), usual);
                controller.set_settings(settings);
                assert_eq!(controller.settings().check(), Ok(()), "{settings:?}");
                let ball = ObstacleSpec { center: v(0.3, 0.0), ..ObstacleSpec::default() };
                controller.upsert(1, Obstacle::new(ball).unwrap(), S::zero()).unwrap();
                let mut x = v(0.4, 0.01);
                for _ in 0..300 {
                    let command = controller.tick(&RobotState::new(x).unwrap(), s(0.001));
                    let most = controller.settings().limits.speed + s(1e-5);
                    assert!(command.velocity.iter().all(|u| u.abs() <= most), "{settings:?}: {command:?}");
                    assert!(command.gamma >= S::one(), "{settings:?}: {command:?}");
                    x += command.velocity * s(0.001);
                }
            }
        }
        assert!(seen > 20, "{seen}");
    }
    drive(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e300]);
    drive(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e30]);
    drive(&[Fixed::MAX, Fixed::from_f64(-2048.0), Fixed::from_f64(-1.0), Fixed::from_f64(0.0)]);
}

/// In fixed point the modulation is what it is in f64 beside bodies of millimetres, also of a fast motion: its products do not leave the range there.
#[test]
fn thin_bodies_are_no_less_exact_in_fixed_point() {
    let mut r = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let grid = |x: f64| (x * 1_048_576.0).round() / 1_048_576.0;
    let mut compared = 0;
    for _ in 0..20_000 {
        let short = r.random_range(0.0021..0.02);
        let axes = [short, short * 10f64.powf(r.random_range(0.0..1.5)), short * 10f64.powf(r.random_range(0.0..1.0))];
        let fast = r.random_range(0.25..5.0);
        let goal = [0; 3].map(|_| grid(r.random_range(-1.0..1.0) * fast));
        let way = [0; 3].map(|_| r.random_range(-1.0..1.0f64));
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        let far = 1.0 + 10f64.powf(r.random_range(-2.0..1.0));
        let at = [0, 1, 2].map(|i| grid(axes[i] * way[i] / length * far));
        let angle: f64 = r.random_range(-1.5..1.5);
        fn modulated<S: Scalar>(axes: [f64; 3], goal: [f64; 3], at: [f64; 3], angle: f64) -> (Vector<f64, 3>, f64) {
            let v = |v: [f64; 3]| Vector::<S, 3>::from(v.map(S::from_f64));
            let mut controller: Controller<S, 3, 1> =
                Controller::new(Motion::linear(v(goal), S::one()).unwrap(), Settings::default());
            let turn = rotation::spatial([angle.cos(), angle.sin() * 0.6, angle.sin() * -0.8, 0.0]).unwrap();
            let spec = ObstacleSpec {
                shape: Shape::ellipsoid(v(axes.map(|a| (a * 1_048_576.0).round() / 1_048_576.0))),
                rotation: turn.map(S::from_f64),
                ..ObstacleSpec::default()
            };
            controller.upsert(1, Obstacle::new(spec).unwrap(), S::zero()).unwrap();
            let stages = controller.evaluate(&RobotState::new(v(at)).unwrap());
            (stages.modulated.map(S::to_f64), stages.gamma.to_f64())
        }
        let (exact, gamma) = modulated::<f64>(axes, goal, at, angle);
        let (fixed, _) = modulated::<Fixed>(axes, goal, at, angle);
        if gamma < 1.01 {
            continue;
        }
        compared += 1;
        let error = (fixed - exact).norm();
        assert!(error <= 1e-3 + 5e-3 * exact.norm(), "{error}: {exact} {fixed}, {axes:?} {goal:?} {at:?} {angle}");
    }
    assert!(compared > 10_000, "{compared}");
}

/// A step of a second begins while a ball is trusted and ends when it has grown by ageing.
#[test]
fn ageing_that_begins_within_a_long_step_is_seen_coming() {
    fn drive<S: Scalar>() {
        let s = S::from_f64;
        let v = |x: f64, y: f64| Vector::<S, 2>::new(s(x), s(y));
        let limits = Limits { speed: s(0.01), ..Limits::default() };
        let settings = Settings { limits, guard: Some(Guard { approach: S::one() }), ..Settings::default() };
        let mut controller: Controller<S, 2, 1> =
            Controller::new(Motion::linear(v(0.0, 0.0), S::one()).unwrap(), settings);
        controller.upsert(1, Obstacle::new(ObstacleSpec::default()).unwrap(), S::zero()).unwrap();
        let state = RobotState::new(v(0.0612, 0.0)).unwrap();
        let command = controller.tick(&state, S::one());
        let after = controller.table().iter().next().unwrap().obstacle().gamma(&(state.position() + command.velocity));
        assert!(after >= S::one() || command.status.contains(Status::INFEASIBLE), "{after}: {command:?}");
    }
    drive::<f64>();
    drive::<f32>();
    drive::<Fixed>();
}

/// Thousands of times its size is out of fixed point's range, but its length is not.
#[test]
fn what_is_small_grows_as_far_in_fixed_point() {
    let s = Fixed::from_f64;
    let forever = Ageing { time_to_live: s(1000.0), growth: s(0.0), hold: s(1000.0) };
    let small = Shape::ellipsoid(Vector::<Fixed, 2>::repeat(s(0.002)));
    let spec = ObstacleSpec { shape: small, growth: s(1.0), ..ObstacleSpec::default() };
    let mut table: Table<Fixed, 2, 1> = Table::new();
    table.upsert(1, Obstacle::new(spec).unwrap(), s(0.0), &forever).unwrap();
    for _ in 0..80 {
        table.advance(s(0.0625), &forever);
    }
    let surface = table.iter().next().unwrap().obstacle().surface(&Vector::<Fixed, 2>::new(s(1.0), s(0.0)));
    assert!((surface.x.to_f64() - 5.002).abs() < 1e-3, "{surface}");
}
