use super::*;

#[test]
fn all_shipped_scenes_are_right_and_their_cores_apart() {
    let mut seen = 0;
    for entry in std::fs::read_dir(folder("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let scene = Scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
        seen += 1;
        // Here they are meant to.
        if ["cluster-chain", "box-room"].contains(&scene.name()) {
            continue;
        }
        for step in 0..=60 {
            let all: Vec<_> = scene.obstacles_at(scene.goal().timeout.min(15.0) * f64::from(step) / 60.0).collect();
            for (i, a) in all.iter().enumerate() {
                for b in &all[i + 1..] {
                    let reach = a.shape.extent().norm() + b.shape.extent().norm();
                    let apart = (a.pose.center - b.pose.center).norm() > reach;
                    assert!(
                        apart || !touching(a, b),
                        "{}: {} and {}",
                        path.display(),
                        a.obstacle.name(),
                        b.obstacle.name()
                    );
                }
            }
        }
    }
    assert!(seen >= 17, "{seen} scenes");
    assert!(Scene::builtin().is_ok_and(|s| s.name() == "sbend-foam"));
}

/// Is any point of a fine grid in both cores?
fn touching(a: &PosedObstacle<'_>, b: &PosedObstacle<'_>) -> bool {
    let axes = a.shape.extent();
    let n = 60;
    let side = |i: i32| f64::from(i) / f64::from(n);
    let depth = if axes.z > 0.0 { n } else { 0 };
    (-n..=n).any(|i| {
        (-n..=n).any(|j| {
            (-depth..=depth).any(|k| {
                let q = Vector3::new(side(i), side(j), side(k)).component_mul(&axes);
                let x = a.pose.center + a.pose.rotation * q;
                a.gamma(&x) <= 1.0 && b.gamma(&x) <= 1.0
            })
        })
    })
}
