//! Reference points where cores overlap.

use pliant_core::{Controller, RobotState, Status, Vector};
use pliant_tests::oracle::random_scene::{RandomScene, Recipe, generate_from};
use pliant_tests::oracle::{OracleScene, Sharing, clusters, pair_reference, reference_in_world};

use super::convert::{as_used, controller};
use super::size;

/// How many clusters were looked at.
#[derive(Debug, Default)]
struct Looked {
    pairs: usize,
    common: usize,
    trees: usize,
    rings: usize,
    walls: usize,
}

/// What a tick says; an evaluation does not say it.
fn flagged<const D: usize>(mut controller: Controller<f64, D, 16>) -> bool {
    let anywhere = RobotState::new(Vector::repeat(0.123)).unwrap();
    controller.tick(&anywhere, 0.001).status.contains(Status::CLUSTER)
}

fn look<const D: usize>(seed: u64, random: &RandomScene, looked: &mut Looked) {
    let own = &random.scene;
    let controller = controller::<D>(own, &random.ageing);
    let used: OracleScene = as_used(own, &controller);
    let found = clusters(own).unwrap().expect("random cores overlap clearly or not at all");
    let mut apart = false;
    for n in 0..own.obstacles.len() {
        if found.iter().all(|cluster| !cluster.members.contains(&n)) {
            assert_eq!(used.obstacles[n].reference, own.obstacles[n].reference, "seed {seed}: {n} is alone");
        }
    }
    for cluster in &found {
        let complaint = cluster.check(own, &used);
        assert_eq!(complaint, Ok(()), "seed {seed}: {cluster:?}");
        looked.walls += usize::from(!cluster.walls.is_empty());
        match cluster.common {
            Sharing::Common => looked.common += 1,
            Sharing::Apart => {
                looked.trees += usize::from(cluster.is_tree());
                looked.rings += usize::from(!cluster.is_tree());
                apart = true;
            }
            // With or without a point in common: either is right.
            Sharing::Unclear => return,
        }
        if let [a, b] = cluster.members[..]
            && let Some(page) = pair_reference(own, a, b).unwrap()
        {
            for n in [a, b] {
                let point = reference_in_world(&used, n).unwrap();
                let error: Vec<f64> = point.iter().zip(&page).map(|(p, q)| p - q).collect();
                assert!(size(&error) < 1e-6, "seed {seed}: {point:?} is not {page:?}");
            }
            looked.pairs += 1;
        }
    }
    assert_eq!(flagged(controller), apart, "seed {seed}: {found:?}");
}

#[test]
fn overlapping_cores_share_reference_points() {
    let mut looked = Looked::default();
    for seed in 0..1200 {
        let dimension = if seed % 2 == 0 { 2 } else { 3 };
        let recipe = Recipe { clusters: 1.0, walls: 0.2, obstacles: 2..=7, ..Recipe::new(dimension) };
        let recipe = if seed % 3 == 0 { Recipe { shapes: 0.0, curvature: 1..=1, ..recipe } } else { recipe };
        let random = generate_from(&recipe, seed, 0);
        match dimension {
            2 => look::<2>(seed, &random, &mut looked),
            _ => look::<3>(seed, &random, &mut looked),
        }
    }
    println!("{looked:?}");
    let Looked { pairs, common, trees, rings, walls } = looked;
    assert!(pairs > 100 && common > 300 && trees > 100 && rings > 30 && walls > 30);
}
