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
        assert_eq!(overlapping_texts(svg), Vec::<String>::new(), "{}", scene.name());
        let has = |text: &str| svg.contains(text);
        let in_space = scene.dimension() == 3;
        assert_eq!(has("seen from above (from +z)") && has("seen from the side (from \u{2212}y)"), in_space);
        assert_eq!(has("hard core (silhouette)"), in_space);
        let changes = scene.attractor_moves() || scene.obstacles().iter().any(|o| o.is_moving());
        assert_eq!(svg.matches(">t = ").count(), if changes { 4 } else { 0 }, "{}", scene.name());
        assert_eq!(has("flow at that time"), changes);
        assert!(svg.len() < 1_000_000, "{}: {} bytes", scene.name(), svg.len());
    }
    if std::env::var_os("PLIANT_KEEP_FIGURES").is_none() {
        std::fs::remove_dir_all(folder).unwrap();
    }
}

/// Pairs of texts that are written over one another, as far as their widths are known.
fn overlapping_texts(svg: &str) -> Vec<String> {
    let number = |line: &str, name: &str| -> Option<f64> {
        line.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.parse().ok()
    };
    let boxes: Vec<_> = svg
        .lines()
        .filter(|line| line.starts_with("<text"))
        .map(|line| {
            let text = line.split_once('>').unwrap().1.trim_end_matches("</text>");
            let size = number(line, "font-size").unwrap_or(figure::FONT_SIZE);
            let (x, y) = (number(line, "x").unwrap(), number(line, "y").unwrap());
            let width = figure::text_width(text) * size / figure::FONT_SIZE;
            let before = if line.contains("\"middle\"") { 0.5 } else { f64::from(u8::from(line.contains("\"end\""))) };
            // From the baseline up to the height of capitals; turned texts run upwards.
            let (along, up) = ((-before * width, (1.0 - before) * width), 0.73 * size);
            let (xs, ys) = if line.contains("rotate(-90") {
                ((x - up, x), (y - along.1, y - along.0))
            } else {
                ((x + along.0, x + along.1), (y - up, y))
            };
            (text, xs, ys)
        })
        .collect();
    let meet = |a: (f64, f64), b: (f64, f64)| a.0 < b.1 && b.0 < a.1;
    let pairs = boxes.iter().enumerate().flat_map(|(i, a)| boxes[i + 1..].iter().map(move |b| (a, b)));
    pairs.filter(|(a, b)| meet(a.1, b.1) && meet(a.2, b.2)).map(|(a, b)| format!("{} / {}", a.0, b.0)).collect()
}

#[test]
fn texts_over_one_another_are_found() {
    let mut svg = Svg::default();
    for (x, text) in [(10.0, "0.1 s"), (30.0, "0.2 s"), (90.0, "0.3 s")] {
        svg.text(Point2::new(x, 20.0), figure::Anchor::Start, "", text);
    }
    assert_eq!(overlapping_texts(&svg.finish(Vector2::new(120.0, 30.0))), ["0.1 s / 0.2 s"]);
}

const BALLS: &str = "ds.linear = { attractor = [1, 0, 0], gain = 1 }\n[[start]]\nposition = [-1, 0, 0]\n\
    [[obstacle]]\nname = \"ball\"\ncenter = [0, 0, 0.5]\nshape = { ellipsoid = [0.2, 0.2, 0.2] }\n\
    [[obstacle]]\nname = \"can\"\ncenter = [0, 0.6, 0]\nshape = { cylinder = [0.1, 0.3], rounding = 0.02 }\n";

fn straight() -> Trajectory {
    let positions: Vec<_> = (0..=200).map(|i| Vector3::new(-1.0 + 0.01 * f64::from(i), 0.0, 0.0)).collect();
    Trajectory::from_positions(&positions, 0.01)
}

#[test]
fn the_nearest_approach_is_that_to_the_true_surface() {
    let scene = Scene::parse("s.toml", BALLS, "".as_ref()).unwrap();
    let nearest = approach::nearest_approach(&scene, &straight()).unwrap();
    assert!((nearest.distance() - 0.3).abs() < 1e-6 && nearest.robot.norm() < 1e-9, "{nearest:?}");
    assert_eq!(nearest.label(), "300 mm");
    // To a flat side, and to a rim.
    let can = scene.obstacles()[1].at(0.0);
    let distance = |p: Vector3<f64>| (outline::nearest(&can, &p) - p).norm();
    assert!((distance(Vector3::new(0.0, 0.4, 0.1)) - 0.1).abs() < 1e-5);
    assert!((distance(Vector3::new(0.03, 0.62, 0.5)) - 0.2).abs() < 1e-5);
    let rim = distance(Vector3::new(0.2, 0.6, 0.4)) - (0.12f64.hypot(0.12) - 0.02);
    assert!(rim.abs() < 1e-3, "{rim}");
}

#[test]
fn how_deep_a_robot_is_in_a_core_is_no_distance() {
    let margin = BALLS.replace("\"ball\"", "\"ball\"\nmargin = [1.5, 1.5, 1.5]");
    let scene = Scene::parse("s.toml", &margin, "".as_ref()).unwrap();
    let at = |z: f64| {
        let path = Trajectory::from_positions(&[Vector3::new(0.0, 0.0, z); 2], 0.01);
        approach::nearest_approach(&scene, &path).unwrap()
    };
    assert_eq!(at(0.36).label(), "60 mm inside");
    assert!(at(0.36).distance() < at(0.31).distance());
    // Only within the margin.
    assert_eq!(at(0.25).label(), "50 mm");
}

#[test]
fn a_path_is_dashed_where_a_core_is_before_it_and_nowhere_else() {
    let scene = Scene::parse("s.toml", BALLS, "".as_ref()).unwrap();
    let path = straight();
    let hidden = |view: &View| -> Vec<f64> {
        let seen: Vec<_> = scene.obstacles_at(0.0).map(|o| seen::Seen::new(&o, view, None, (0.0, 2.0))).collect();
        let parts = paths::parts(&path.points, &seen, view);
        let behind = parts.iter().filter(|part| part.0);
        behind.flat_map(|(_, part)| [part[0].position.x, part[part.len() - 1].position.x]).collect()
    };
    let views = View::of(&scene);
    // From above the ball hides it; from the side the can is behind it.
    let above = hidden(&views[0]);
    assert!(above.len() == 2 && (above[0] + 0.2).abs() < 0.021 && (above[1] - 0.2).abs() < 0.021, "{above:?}");
    assert_eq!(hidden(&views[1]), Vec::<f64>::new());
}

#[test]
fn moments_are_those_at_which_robots_pass_what_moves() {
    let text = BALLS.replace("[[obstacle]]\nname = \"can\"", "[[obstacle]]\nvelocity = [0, 0, 0.01]\nname = \"can\"");
    let scene = Scene::parse("s.toml", &text, "".as_ref()).unwrap();
    let moments = approach::moments(&scene, &[straight()], 0.0);
    let times: Vec<f64> = moments.iter().map(|m| m.time).collect();
    assert!(moments.len() == 4 && times.is_sorted() && times[0] == 0.0, "{times:?}");
    assert!(times.iter().any(|t| (t - 1.0).abs() < 0.02), "{times:?}");
    let still = Scene::parse("s.toml", BALLS, "".as_ref()).unwrap();
    assert_eq!(approach::moments(&still, &[straight()], 0.0), [approach::Moment { time: 0.0, tail: None }]);
}

/// Above and from the side, the panels' paths at other times and their starts are drawn after all cores, dashed where one hides them.
#[test]
fn in_space_what_moves_hides_neither_starts_nor_paths_at_other_times() {
    let text = BALLS.replace("[[obstacle]]\nname = \"can\"", "[[obstacle]]\nvelocity = [0, 0, 0.01]\nname = \"can\"");
    let scene = Scene::parse("s.toml", &text, "".as_ref()).unwrap();
    let options = Options { clearances: false, ..Options::default() };
    let figure = scene_figure(&scene, &[straight()], &options).unwrap();
    // One piece a panel, without the legend's.
    let panels: Vec<&str> = figure.svg().split("id=\"panel").skip(1).collect();
    assert_eq!(panels.len(), 8);
    for panel in panels {
        let panel = panel.split("id=\"legend").next().unwrap();
        let first = |what: &str| panel.find(what).unwrap_or_else(|| panic!("no {what}"));
        let starts = first(style::START);
        let cores: Vec<usize> = panel.match_indices(style::CORE).map(|(at, _)| at).take(2).collect();
        let thin = first("fill=\"none\" stroke-width=\"1.3\" stroke-linecap=");
        assert!(cores.iter().all(|core| *core < starts && *core < thin), "{cores:?} {thin} {starts}");
    }
    assert!(figure.svg().contains(style::THIN_CASING) && figure.svg().contains("path behind a core"));
    let apart = scene_figure(&scene, &[], &options).unwrap();
    assert!(!apart.svg().contains(style::THIN_CASING));
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

/// Two soft discs with a gap of 2 cm between their cores, and a path through it.
const GAP: &str = "\
[ds]
linear = { attractor = [0.0, 0.0], gain = 1.0 }
[limits]
speed = 0.5
[[start]]
position = [0.5, 0.0]
[[obstacle]]
name = \"above\"
shape = { ellipsoid = [0.04, 0.04] }
center = [0.25, 0.05]
stiffness = 1.6487
[[obstacle]]
name = \"below\"
shape = { ellipsoid = [0.04, 0.04] }
center = [0.25, -0.05]
stiffness = 1.6487
";

#[test]
fn an_overlap_is_over_the_edge_of_a_path_and_under_the_path() {
    let scene = Scene::parse("gap.toml", GAP, Path::new(".")).unwrap();
    let straight: Vec<Vector3<f64>> = (0..=100).map(|i| Vector3::new(0.5 - f64::from(i) * 5e-3, 0.0, 0.0)).collect();
    let paths = [Trajectory::from_positions(&straight, 0.01)];
    let options = Options { speed: false, clearances: false, ..Options::default() };
    let text = scene_figure(&scene, &paths, &options).unwrap().svg().to_owned();
    let line = format!(r#"stroke="{}" stroke-width="3.2""#, style::LINE_COLOUR);
    let at = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}"));
    let edge = style::casing(3.2);
    assert!(at(style::CORE) < at(&edge) && at(&edge) < at(style::OVERLAP) && at(style::OVERLAP) < at(&line));
    // It does not hide the cores: both are cut out.
    assert_eq!(text.matches(r#"clipPath id="beside"#).count(), 2);
}

#[test]
fn where_paths_end_before_the_goal_is_marked_and_so_is_what_was_shown() {
    let scene = Scene::parse("gap.toml", GAP, Path::new(".")).unwrap();
    let text = |options: &Options| scene_figure(&scene, &[], options).unwrap().svg().to_owned();
    let plain = text(&Options::default());
    for word in ["ends in a core", "never arrives", "demonstration"] {
        assert!(!plain.contains(word), "{word}");
    }
    let marked = text(&Options {
        entries: vec![Vector3::new(0.25, 0.03, 0.0)],
        lost: vec![Vector3::new(0.3, 0.0, 0.0); 2],
        demonstrations: vec![vec![Vector3::new(0.5, 0.0, 0.0), Vector3::zeros()]],
        ..Options::default()
    });
    // Each sign once more, in the legend; a cross has two lines.
    assert_eq!(marked.matches(&format!(r#"stroke="{}""#, style::ENTRY)).count(), 4);
    assert_eq!(marked.matches(style::LOST).count(), 3);
    assert_eq!(marked.matches("#e8862a").count(), 2);
    for word in ["ends in a core", "never arrives", "demonstration"] {
        assert!(marked.contains(&format!(">{word}</text>")), "{word}");
    }
}

#[test]
fn a_path_beyond_the_limit_is_cut_and_counted_and_stretches_nothing() {
    let scene = Scene::parse("gap.toml", GAP, Path::new(".")).unwrap();
    let path = |far: f64| {
        let bow =
            (0..=100).map(|i| f64::from(i) / 100.0).map(|s| Vector3::new(0.5 * (1.0 - s), far * s * (1.0 - s), 0.0));
        Trajectory::from_positions(&bow.collect::<Vec<_>>(), 0.01)
    };
    let drawn = |paths: &[Trajectory], limit| {
        let options = Options { speed: false, clearances: false, streamlines: false, limit, ..Options::default() };
        let tile = Tile { title: "one".into(), scene: &scene, trajectories: paths, options: options.clone() };
        let (one, many) = (scene_figure(&scene, paths, &options).unwrap(), gallery(&[tile], 1, 400.0).unwrap());
        assert_eq!(one.cut(), many.cut());
        (
            one.cut(),
            [one, many].map(|figure| figure.svg().lines().filter(|l| l.starts_with("<text")).collect::<String>()),
        )
    };
    let limit = Some([Vector3::new(-0.2, 0.2, 0.0), Vector3::new(0.6, -0.2, 0.0)]);
    let near = [path(0.1), path(-0.2)];
    let all = [path(0.1), path(40.0), path(-0.2)];
    let shown = drawn(&near, None);
    assert_eq!((shown.0, &shown), (0, &drawn(&near, limit)), "what is inside is drawn as without it");
    // All numbers at the axes stay, but for the part of the long path that is within the limit.
    let cut = drawn(&all, limit);
    let whole = drawn(&all, None);
    assert_eq!((cut.0, whole.0), (1, 0));
    assert!(!cut.1[0].contains(">2<") && whole.1[0].contains(">2<"), "{} {}", cut.1[0], whole.1[0]);
}
