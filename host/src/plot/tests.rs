use std::path::Path;

use nalgebra::{SVector, Vector3};
use pliant_core::{Controller, RobotState};

use super::*;

/// A point robot at 1 kHz, as far as a figure goes.
fn rollouts<const D: usize>(scene: &Scene) -> Vec<Trajectory> {
    let dt = 1e-3;
    let lift = |x: &SVector<f64, D>| Vector3::from_fn(|i, _| x.get(i).copied().unwrap_or_default());
    let mut all = Vec::new();
    for start in scene.start_positions::<f64, D>().unwrap() {
        let mut controller: Controller<f64, D, 64> = scene.controller(0.0).unwrap();
        let mut at = start;
        let mut positions = vec![lift(&at)];
        for step in 0..(scene.goal().timeout / dt) as usize {
            if step % 33 == 0 {
                for (id, o) in scene.core_obstacles(step as f64 * dt).unwrap() {
                    controller.upsert(id, o, 0.0).unwrap();
                }
                if let Some(scan) = scene.core_scan().unwrap() {
                    controller.set_scan(scan, 0.0);
                }
                if scene.attractor_moves() {
                    let (position, velocity) = scene.attractor_at(step as f64 * dt);
                    let flat = |x: &Vector3<f64>| SVector::<f64, D>::from_fn(|i, _| x[i]);
                    assert!(controller.aim(&flat(&position), &flat(&velocity)));
                }
            }
            at += controller.tick(&RobotState::new(at).unwrap(), dt).velocity * dt;
            let goal = scene.attractor_at((step + 1) as f64 * dt).0;
            let there = (lift(&at) - goal).norm() < scene.goal().tolerance;
            if step % 10 == 9 || there {
                positions.push(lift(&at));
            }
            if there {
                break;
            }
        }
        all.push(Trajectory::from_positions(&positions, 10.0 * dt));
    }
    all
}

fn shipped() -> Vec<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut all: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    all.sort();
    all
}

#[test]
fn every_shipped_scene_arrives_and_has_a_figure() {
    let folder = std::env::temp_dir().join(format!("pliant-figures-{}", std::process::id()));
    for path in shipped() {
        let scene = Scene::load(&path).unwrap();
        let trajectories = if scene.dimension() == 2 { rollouts::<2>(&scene) } else { rollouts::<3>(&scene) };
        for t in &trajectories {
            let end = t.points.last().unwrap();
            assert!(
                // The last point's time is rounded up to the next hundredth.
                (end.position - scene.attractor_at(end.time).0).norm()
                    < scene.goal().tolerance + 0.01 * scene.attractor_at(end.time).1.norm(),
                "{}: ends at {:?}",
                scene.name(),
                end
            );
            for p in &t.points {
                let scan = scene.scan().map_or(f64::MAX, |s| s.gamma(&p.position));
                let nearest = scene.obstacles_at(p.time).map(|o| o.gamma(&p.position)).fold(scan, f64::min);
                assert!(nearest > 1.0, "{}: a core is touched at {:?}", scene.name(), p);
            }
        }
        let figure = scene_figure(&scene, &trajectories, &Options::default()).unwrap();
        let stem = folder.join(scene.name());
        for ending in ["svg", "png"] {
            let file = stem.with_extension(ending);
            figure.save(&file).unwrap();
            assert!(std::fs::metadata(file).unwrap().len() > 5_000);
        }
        let svg = figure.svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", scene.name());
        assert!(svg.contains("x (m)") && svg.contains("attractor"));
    }
    if std::env::var_os("PLIANT_KEEP_FIGURES").is_none() {
        std::fs::remove_dir_all(folder).unwrap();
    }
}

/// Mean speed (m/s) where two soft layers overlap, with layers that give and with layers that are not there.
#[test]
fn the_pair_slows_the_robot_in_its_overlap() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let text = std::fs::read_to_string(folder.join("sbend-pair.toml")).unwrap();
    let original = text.replacen("[modulation]", "[modulation]\nmethod = \"original\"", 1);
    assert_ne!(text, original);
    let speed = |text: &str| {
        let scene = Scene::parse("pair.toml", text, &folder).unwrap();
        let path = rollouts::<2>(&scene).remove(0).points;
        let inside = |p: &&TrajectoryPoint| scene.obstacles_at(0.0).all(|o| o.gamma_soft(&p.position) <= 1.0);
        let there: Vec<f64> = path.iter().filter(inside).map(|p| p.speed).collect();
        assert!(there.len() >= 5, "it hardly passes the overlap: {} points", there.len());
        there.iter().sum::<f64>() / there.len() as f64
    };
    let (soft, rigid) = (speed(&text), speed(&original));
    assert!(soft < 0.9 * rigid, "{soft} m/s against {rigid} m/s");
}

#[test]
fn text_is_really_drawn_in_the_png() {
    let mut svg = Svg::default();
    svg.text(Point2::new(5.0, 20.0), figure::Anchor::Start, "", "soft layer");
    let with = Figure::from_svg(svg.finish(Vector2::new(120.0, 30.0))).png().unwrap();
    let without = Figure::from_svg(Svg::default().finish(Vector2::new(120.0, 30.0))).png().unwrap();
    assert_ne!(with, without);
    assert!(with.len() > without.len() + 300);
}

#[test]
fn other_endings_and_bad_places_are_errors() {
    assert!(check_format("a.pdf".as_ref()).is_err() && check_format("a".as_ref()).is_err());
    assert!(check_format("a.PNG".as_ref()).is_ok());
    let figure = Figure::from_svg(Svg::default().finish(Vector2::new(1.0, 1.0)));
    let error = figure.save("/proc/nowhere/a.svg".as_ref()).unwrap_err();
    assert!(matches!(error, PlotError::Unwritable { .. }));
    assert!(matches!(Figure::from_svg("no".into()).png(), Err(PlotError::Png(_))));
}

#[test]
fn a_scene_without_obstacles_or_trajectories_has_a_figure_too() {
    let text = "ds.linear = { attractor = [0, 0], gain = 1 }\n[[start]]\nposition = [0, 0]";
    let scene = Scene::parse("s.toml", text, "".as_ref()).unwrap();
    let options = Options { streamlines: false, ..Options::default() };
    assert!(scene_figure(&scene, &[], &options).unwrap().png().is_ok());
}
