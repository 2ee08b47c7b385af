use std::f64::consts::FRAC_PI_4;

use super::super::random_scene::{Recipe, generate_from};
use super::super::scene::{OracleObstacle, OracleRotation, OracleShape};
use super::*;

fn scene(obstacles: Vec<OracleObstacle>) -> OracleScene {
    let mut scene = generate_from(&Recipe::plain(obstacles[0].center.len()), 2, 0).scene;
    scene.obstacles = obstacles;
    scene
}

fn disc(x: f64, y: f64) -> OracleObstacle {
    OracleObstacle::still(&[x, y], &[1.0, 1.0])
}

fn square(x: f64, y: f64, half: f64) -> OracleObstacle {
    let vertices = vec![[half, -half], [half, half], [-half, half], [-half, -half]];
    OracleObstacle::of(&[x, y], OracleShape::Polygon { vertices })
}

#[test]
fn overlaps_by_hand() {
    let of = |a: OracleObstacle, b: OracleObstacle| {
        let both = scene(vec![a, b]);
        let found = sharing(&both, 0, 1).unwrap();
        assert_eq!(sharing(&both, 1, 0).unwrap(), found);
        found
    };
    assert_eq!(of(disc(0.0, 0.0), disc(1.9, 0.0)), Sharing::Common);
    assert_eq!(of(disc(0.0, 0.0), disc(2.1, 0.0)), Sharing::Apart);
    assert_eq!(of(disc(0.0, 0.0), disc(2.001, 0.0)), Sharing::Unclear);
    // Beside the corner of a square, but within the discs' reach of its sides' lines.
    assert_eq!(of(disc(0.0, 0.0), square(1.75, 1.75, 1.0)), Sharing::Apart);
    assert_eq!(of(disc(0.0, 0.0), square(1.65, 1.65, 1.0)), Sharing::Common);
    assert_eq!(of(square(0.0, 0.0, 1.0), square(1.9, 1.9, 1.0)), Sharing::Common);
    let turned = OracleObstacle { rotation: OracleRotation::Angle(FRAC_PI_4), ..square(2.3, 0.0, 1.0) };
    assert_eq!(of(square(0.0, 0.0, 1.0), turned), Sharing::Common);
    let turned = OracleObstacle { rotation: OracleRotation::Angle(FRAC_PI_4), ..square(2.5, 0.0, 1.0) };
    assert_eq!(of(square(0.0, 0.0, 1.0), turned), Sharing::Apart);
    // In the notch of a star nothing overlaps.
    let star = vec![[2.0, 0.0], [0.3, 0.3], [0.0, 2.0], [-0.3, 0.3], [-2.0, 0.0], [0.0, -0.3]];
    let star = || OracleObstacle::of(&[0.0, 0.0], OracleShape::Polygon { vertices: star.clone() });
    assert_eq!(of(star(), OracleObstacle::still(&[0.9, 0.9], &[0.5, 0.5])), Sharing::Apart);
    assert_eq!(of(star(), OracleObstacle::still(&[0.5, 0.5], &[0.5, 0.5])), Sharing::Common);
    // Whoever is wholly within another has points in common as well.
    assert_eq!(of(disc(0.0, 0.0), OracleObstacle::still(&[0.2, 0.1], &[0.1, 0.1])), Sharing::Common);
}

#[test]
fn a_wall_is_overlapped_by_what_sticks_out() {
    let ring = || OracleObstacle::still(&[0.0, 0.0], &[3.0, 3.0]).inside_out();
    let of = |other: OracleObstacle| sharing(&scene(vec![ring(), other]), 0, 1).unwrap();
    assert_eq!(of(disc(0.0, 0.0)), Sharing::Apart);
    assert_eq!(of(disc(1.4, 1.2)), Sharing::Apart);
    assert_eq!(of(disc(1.5, 1.5)), Sharing::Common);
    // A corner alone.
    assert_eq!(of(square(1.3, 1.3, 0.9)), Sharing::Common);
    assert_eq!(of(square(1.1, 1.1, 0.9)), Sharing::Apart);
}

#[test]
fn all_walls_of_a_tree_are_its_roots() {
    let ring = |x: f64| OracleObstacle::still(&[x, 0.0], &[3.0, 3.0]).inside_out();
    assert_eq!(clusters(&scene(vec![ring(0.0), ring(0.2)])).unwrap(), Some(vec![]));
    let own = scene(vec![ring(0.0), ring(0.2), disc(-2.5, 0.0)]);
    let found = clusters(&own).unwrap().unwrap();
    let tree = &found[0];
    assert_eq!((found.len(), &tree.links, &tree.walls), (1, &vec![(0, 2), (1, 2)], &vec![0, 1]));
    assert_eq!(tree.roots(), vec![vec![0, 1]]);
    assert_eq!(tree.parents(&[0, 1]), vec![(0, None), (1, None), (2, Some(0))]);
    let with = |wall: [f64; 2], ball: [f64; 2]| {
        let mut scene = own.clone();
        (scene.obstacles[1].reference, scene.obstacles[2].reference) = (wall.to_vec(), ball.to_vec());
        tree.check(&own, &scene)
    };
    assert_eq!(with([0.0, 0.0], [-0.75, 0.0]), Ok(()));
    assert!(with([0.0, 0.0], [0.0, 0.0]).is_err());
    assert!(with([-3.3, 0.0], [-0.75, 0.0]).is_err());
}

#[test]
fn groups_links_and_roots() {
    let chain = scene(vec![disc(0.0, 0.0), disc(9.0, 0.0), disc(3.4, 0.0), disc(1.7, 0.0)]);
    let found = clusters(&chain).unwrap().unwrap();
    assert_eq!(found.len(), 1);
    let tree = &found[0];
    assert_eq!((&tree.members, &tree.links), (&vec![0, 2, 3], &vec![(0, 3), (2, 3)]));
    assert!(tree.is_tree() && tree.roots() == vec![vec![3]] && tree.common == Sharing::Apart);
    assert_eq!(tree.parents(&[3]), vec![(3, None), (0, Some(3)), (2, Some(3))]);
    let three = clusters(&scene(vec![disc(0.0, 0.0), disc(1.0, 0.0), disc(0.5, 0.8)])).unwrap().unwrap();
    assert!(three[0].common == Sharing::Common && !three[0].is_tree());
    assert_eq!(clusters(&scene(vec![disc(0.0, 0.0), disc(2.0, 0.0)])).unwrap(), None);
}

#[test]
fn the_point_of_two_discs_and_of_two_ellipses() {
    // Two equal discs meet half way; of unequal ones Gamma is equal where the distances are as the radii.
    let pair = |a: OracleObstacle, b: OracleObstacle| pair_reference(&scene(vec![a, b]), 0, 1).unwrap();
    let found = pair(disc(0.0, 0.0), disc(1.0, 1.0)).unwrap();
    assert!(found.iter().all(|c| (c - 0.5).abs() < 1e-13));
    let found = pair(disc(0.0, 0.0), OracleObstacle::still(&[1.2, 0.0], &[0.5, 0.5])).unwrap();
    assert!((found[0] - 0.8).abs() < 1e-13 && found[1].abs() < 1e-13);
    assert_eq!(pair(disc(0.0, 0.0), disc(1.0, 0.0).curved(2)), None);
}

#[test]
fn the_point_of_two_ellipsoids_is_the_pages_and_nothing_is_better() {
    let mut checked = 0;
    for seed in 0..400 {
        let d = 2 + (seed % 2) as usize;
        let recipe = Recipe { clusters: 1.0, obstacles: 2..=5, curvature: 1..=1, ..Recipe::plain(d) };
        let scene = generate_from(&recipe, seed, 0).scene;
        for cluster in clusters(&scene).unwrap().unwrap_or_default() {
            let (a, b) = cluster.links[0];
            let point = DVector::from_vec(pair_reference(&scene, a, b).unwrap().unwrap());
            let bodies = bodies(&scene).unwrap();
            let (a, b) = (&bodies[a], &bodies[b]);
            let worse = |x: &DVector<f64>| a.gamma(x).max(b.gamma(x));
            let own = worse(&point);
            assert!(own < 1.0 && (a.gamma(&point) - b.gamma(&point)).abs() < 1e-10 * own.max(1e-3));
            for i in 0..200 {
                let i = f64::from(i);
                let step = DVector::from_fn(d, |j, _| (i * [12.9, 78.2, 37.7][j]).sin());
                for size in [1e-5, 1e-3, 0.1] {
                    assert!(worse(&(&point + &step * size)) >= own - 1e-12);
                }
            }
            // x(l) of the page, with l from the gradients there.
            let (ga, gb) = (a.gradient(&point).norm(), b.gradient(&point).norm());
            let l = ga / (ga + gb);
            let squares = |body: &Body| {
                let q = &body.rotation;
                // Half of the second derivative, by columns: P e_i = gradient(c + e_i) / 2.
                nalgebra::DMatrix::from_columns(
                    &(0..d)
                        .map(|i| {
                            let mut x = body.center.clone();
                            x[i] += 1.0;
                            body.gradient(&x) / 2.0
                        })
                        .collect::<Vec<_>>(),
                ) * (q.transpose() * q).trace()
                    / d as f64
            };
            let (pa, pb) = (squares(a) * (1.0 - l), squares(b) * l);
            let page = (&pa + &pb).try_inverse().unwrap() * (pa * &a.center + pb * &b.center);
            assert!((page - &point).norm() < 1e-9, "seed {seed}");
            checked += 1;
        }
    }
    assert!(checked > 150, "{checked}");
}

#[test]
fn reference_points_are_checked() {
    let own = scene(vec![disc(0.0, 0.0), disc(1.0, 0.0)]);
    let cluster = &clusters(&own).unwrap().unwrap()[0];
    let with = |references: [[f64; 2]; 2]| {
        let mut scene = own.clone();
        scene.obstacles.iter_mut().zip(references).for_each(|(o, r)| o.reference = r.to_vec());
        cluster.check(&own, &scene)
    };
    assert_eq!(with([[0.5, 0.0], [-0.5, 0.0]]), Ok(()));
    assert_eq!(with([[0.5, 0.1], [-0.5, 0.1]]), Ok(()));
    assert!(with([[0.5, 0.9], [-0.5, 0.9]]).is_err());
    assert!(with([[0.0, 0.0], [-0.5, 0.0]]).is_err());

    let own = scene(vec![disc(0.0, 0.0), disc(1.7, 0.0), disc(3.4, 0.0)]);
    let cluster = &clusters(&own).unwrap().unwrap()[0];
    let leaning = |references: [[f64; 2]; 3], hubs: [Option<[f64; 2]>; 3]| {
        let mut scene = own.clone();
        scene.obstacles.iter_mut().zip(references).for_each(|(o, r)| o.reference = r.to_vec());
        for (n, hub) in hubs.iter().enumerate() {
            lean(&mut scene, n, hub.as_ref().map(|place| place.as_slice())).unwrap();
        }
        cluster.check(&own, &scene)
    };
    let root = Some([1.7, 0.0]);
    let with = |references| leaning(references, [root, None, root]);
    // From the overlap at 0.7 to 1 towards the root's centre, as far as 0.8 of the square of the child's radius.
    let deep = 0.8_f64.sqrt();
    assert_eq!(with([[deep, 0.0], [0.0, 0.0], [-deep, 0.0]]), Ok(()));
    // Not as far, too far, and beside the way.
    assert!(with([[0.75, 0.0], [0.0, 0.0], [-deep, 0.0]]).is_err());
    assert!(with([[1.3, 0.0], [0.0, 0.0], [-deep, 0.0]]).is_err());
    assert!(with([[deep - 0.1, 0.6], [0.0, 0.0], [-deep, 0.0]]).is_err());
    // The root has to keep its own, a child to be with its parent.
    assert!(with([[deep, 0.0], [0.1, 0.0], [-deep, 0.0]]).is_err());
    assert!(with([[0.5, 0.0], [0.0, 0.0], [-deep, 0.0]]).is_err());
    // Both children lean towards the root.
    let own_references = [[deep, 0.0], [0.0, 0.0], [-deep, 0.0]];
    assert!(leaning(own_references, [root, None, None]).is_err());
    assert!(leaning(own_references, [root, None, Some([1.7, 0.1])]).is_err());
}
