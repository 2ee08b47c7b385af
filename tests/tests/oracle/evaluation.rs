//! Every stage at positions of every kind.

use pliant_core::{Region, RobotState};
use pliant_tests::oracle::random_scene::{RandomScene, generate};
use pliant_tests::oracle::{self, OracleShape};

use super::convert::{as_used, controller, vector};
use super::{SWITCH, close, decided, scale};

fn same_region(ours: Region, theirs: oracle::Region) -> bool {
    matches!(
        (ours, theirs),
        (Region::Free, oracle::Region::Free)
            | (Region::Soft, oracle::Region::Soft)
            | (Region::Intersection, oracle::Region::Intersection)
            | (Region::Hard, oracle::Region::Hard)
    )
}

/// How much was compared.
#[derive(Debug, Default)]
struct Compared {
    /// Points in each region.
    regions: [usize; 4],
    /// Points of scenes with a box, cylinder, capsule, polygon; a wall, a scan, growth, ageing, a moving attractor.
    features: [usize; 9],
}

fn features(random: &RandomScene) -> [bool; 9] {
    let scene = &random.scene;
    let any = |test: &dyn Fn(&oracle::OracleObstacle) -> bool| scene.obstacles.iter().any(test);
    [
        any(&|o| matches!(o.shape, OracleShape::Box { .. })),
        any(&|o| matches!(o.shape, OracleShape::Cylinder { .. })),
        any(&|o| matches!(o.shape, OracleShape::Capsule { .. })),
        any(&|o| matches!(o.shape, OracleShape::Polygon { .. })),
        any(&|o| o.wall),
        scene.scan.is_some(),
        any(&|o| o.grown != 0.0),
        any(&|o| o.aged != 0.0),
        scene.drift.is_some(),
    ]
}

fn compare<const D: usize>(seed: u64, random: &RandomScene, compared: &mut Compared) {
    let controller = controller::<D>(&random.scene, &random.ageing);
    let scene = as_used(&random.scene, &controller);
    let tick = &random.tick;
    for point in &random.points {
        let theirs = oracle::evaluate(&scene, &point.x, Some(tick)).unwrap();
        if !decided(&scene, &theirs) {
            continue;
        }
        let ours = controller.evaluate(&RobotState::new(vector(&point.x)).unwrap());
        let scale = scale(&scene, &theirs);
        let place = || format!("seed {seed}, {:?} at {:?}\nours {ours:?}\ntheirs {theirs:?}", point.kind, point.x);
        assert!(close(ours.nominal.as_slice(), &theirs.nominal, 0.0), "nominal: {}", place());
        if theirs.min_gamma < 1e15 {
            assert!((ours.gamma / theirs.min_gamma - 1.0).abs() < 1e-9, "gamma: {}", place());
        }
        if theirs.switches.soft > SWITCH {
            assert!(same_region(ours.region, theirs.region), "region: {}", place());
        }
        assert!(close(ours.modulated.as_slice(), &theirs.modulated, scale), "modulated: {}", place());
        assert!(close(ours.adapted.as_slice(), &theirs.adapted, scale), "adapted: {}", place());
        let previous = vector(&tick.previous);
        let (limited, _) = controller.settings().limits.apply(ours.adapted, &previous, tick.dt);
        assert!(close(limited.as_slice(), &theirs.limited, scale), "limited: {}", place());
        compared.regions[theirs.region as usize] += 1;
        compared.features.iter_mut().zip(features(random)).for_each(|(sum, has)| *sum += usize::from(has));
    }
}

#[test]
fn the_core_agrees_with_the_independent_evaluation() {
    let mut compared = Compared::default();
    for seed in 0..1500 {
        let random = generate(seed, 4);
        match random.scene.dimension {
            2 => compare::<2>(seed, &random, &mut compared),
            _ => compare::<3>(seed, &random, &mut compared),
        }
    }
    println!("{compared:?}");
    assert!(compared.regions.iter().all(|n| *n > 1500), "too few points compared: {compared:?}");
    assert!(compared.features.iter().all(|n| *n > 1500), "too few points compared: {compared:?}");
}
