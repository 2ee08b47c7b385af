//! `pliant eval` on scene files.

use std::fs;

use pliant_tests::oracle::random_scene::{PointKind, Recipe, generate_from};
use pliant_tests::oracle::{Region, evaluate};
use pliant_tests::{programs, scene_file};

use super::{close, decided, scale};

#[test]
fn pliant_eval_agrees_with_the_independent_evaluation() {
    let folder = std::env::temp_dir().join(format!("pliant-oracle-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let mut compared = 0;
    for seed in 0..36 {
        let dimension = if seed % 2 == 0 { 2 } else { 3 };
        // What has grown before and whose cores overlap a file cannot say, or does not say by itself.
        let recipe = Recipe { clusters: 0.0, walls: 0.3, ..Recipe::new(dimension) };
        let mut s = generate_from(&recipe, 10_000 + seed, 3);
        s.scene = s.scene.at_first();
        // The guard has its own comparison.
        s.scene.guard = None;
        // A file may not say that a core will leave its reference point.
        s.scene.obstacles.iter_mut().for_each(|o| o.growth = o.growth.abs());
        // The scene reader refuses a start in a core, as it should.
        let outside = |x: &[f64]| evaluate(&s.scene, x, None).unwrap().region != Region::Hard;
        let start = s.points.iter().find(|p| p.kind == PointKind::Free && outside(&p.x));
        let Some(start) = start else { continue };
        fs::write(folder.join("scene.toml"), scene_file::scene_toml(&s.scene, std::slice::from_ref(&start.x))).unwrap();
        if let Some(model) = scene_file::model_toml(&s.scene.motion) {
            fs::write(folder.join("model.toml"), model).unwrap();
        }
        let mut csv = String::from(if dimension == 2 { "x,y\n" } else { "x,y,z\n" });
        for p in &s.points {
            csv += &p.x.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            csv.push('\n');
        }
        fs::write(folder.join("p.csv"), csv).unwrap();
        for stage in ["nominal", "modulated", "adapted", "final"] {
            let ended =
                programs::run(&folder, ["eval", "scene.toml", "--points", "p.csv", "-o", "v.csv", "--stage", stage])
                    .unwrap();
            let refused = ["core", "radius", "growth"].iter().any(|what| ended.stderr.contains(what));
            if ended.code != Some(0) && refused {
                continue; // A random scene may put its goal into a core or a point, which a scene file may not.
            }
            assert_eq!(ended.code, Some(0), "seed {seed}: {}", ended.stderr);
            let rows = fs::read_to_string(folder.join("v.csv")).unwrap();
            for (row, p) in rows.lines().skip(1).zip(&s.points) {
                let theirs = evaluate(&s.scene, &p.x, None).unwrap();
                if !decided(&s.scene, &theirs) {
                    continue;
                }
                let cells: Vec<&str> = row.split(',').collect();
                let velocity: Vec<f64> = cells[dimension..2 * dimension].iter().map(|c| c.parse().unwrap()).collect();
                let expected = match stage {
                    "nominal" => &theirs.nominal,
                    "modulated" => &theirs.modulated,
                    "adapted" => &theirs.adapted,
                    _ => &theirs.limited,
                };
                assert!(
                    close(&velocity, expected, scale(&s.scene, &theirs)),
                    "seed {seed}, {stage}: {row}\n{expected:?}"
                );
                compared += 1;
            }
        }
    }
    fs::remove_dir_all(&folder).unwrap();
    assert!(compared > 500, "too few points compared: {compared}");
}
