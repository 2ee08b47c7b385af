//! Learns every .mat of a folder on one core and prints a table.

use pliant::learn::{self, Demonstrations, Options, Unit, quality};
use std::path::PathBuf;

fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

/// DTWD under other readings of its definition: start at the 20th of every fifth sample against the whole; and in time instead of length.
fn others(model: &pliant::model::ModelFile, demos: &Demonstrations) -> Option<[f64; 3]> {
    let motion = learn::motion_of::<2>(model)?;
    let mut sums = [0.0; 3];
    for d in demos.items() {
        let x: Vec<_> = d.x.iter().map(|p| nalgebra::Vector2::new(p[0], p[1])).collect();
        let duration = d.duration();
        let near = 0.01 * demos.extent();
        let n = x.len();
        let by_time = |p: &[nalgebra::Vector2<f64>]| -> Vec<_> {
            (0..200).map(|j| p[(j as f64 / 199.0 * (p.len() - 1) as f64).round() as usize]).collect()
        };
        let fifth: Vec<_> = x.iter().copied().step_by(5).collect();
        // 20th of the thinned, whole demonstration, rollout as long as the demonstration
        let (roll, _) = motion.rollout(&fifth[19], duration / 1000.0, duration, 0.0);
        sums[0] += quality::warping_distance(&by_time(&fifth), &by_time(&roll)).0;
        // raw 20th, in time, as long as the demonstration
        let (roll, _) = motion.rollout(&x[19], duration / 1000.0, duration * (n - 19) as f64 / n as f64, 0.0);
        sums[1] += quality::warping_distance(&by_time(&x[19..]), &by_time(&roll)).0;
        // raw 20th, in time, until arrival
        let (roll, _) = motion.rollout(&x[19], duration / 1000.0, duration * 10.0, near);
        sums[2] += quality::warping_distance(&by_time(&x[19..]), &by_time(&roll)).0;
    }
    Some(sums.map(|s| 1e3 * s / demos.items().len() as f64))
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    (v[(v.len() - 1) / 2] + v[v.len() / 2]) / 2.0
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().unwrap_or_else(|| "/work/shared/data/lasa".into()));
    let components = args.next().and_then(|k| k.parse().ok()).filter(|&k| k > 0);
    let only = args.next();
    let mut files: Vec<_> = std::fs::read_dir(folder)?.filter_map(|e| e.ok().map(|e| e.path())).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "mat"));
    files.sort();
    let mut table: Vec<[f64; 9]> = vec![];
    println!(
        "{:20} {:>3} {:>7} {:>7} {:>7} {:>6} {:>6} | other DTWD",
        "motion", "K", "rmse", "e_dot", "dtwd", "pace", "cpu s"
    );
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if only.as_ref().is_some_and(|o| !name.contains(o.as_str())) {
            continue;
        }
        let demos = learn::read(std::slice::from_ref(&file), Some(Unit::Mm))?;
        let begin = cpu();
        let options = Options { components, ..Options::default() };
        let learnt = match learn::learn_from(demos, &options, &|_| ()) {
            Ok(l) => l,
            Err(e) => {
                println!("{name}: {e}");
                continue;
            }
        };
        let seconds = cpu() - begin;
        let q = learnt.quality;
        let o = others(&learnt.model, &learnt.demonstrations).unwrap_or([0.0; 3]);
        let ok = learnt.model.certified::<f32>() && learnt.model.certified::<f64>();
        println!(
            "{name:20} {:3} {:7.3} {:7.4} {:7.1} {:6.2} {seconds:6.3} | {:6.0} {:6.0} {:6.0} {}{}",
            learnt.model.component.len(),
            q.rmse * 1e3,
            q.e_dot,
            q.dtwd * 1e3,
            q.pace,
            o[0],
            o[1],
            o[2],
            if ok { "" } else { "NOT CERTIFIED " },
            if q.converged == q.rollouts { "" } else { "STRANDED" },
        );
        if std::env::var("T_DECILES").is_ok() {
            let motion = learn::motion_of::<2>(&learnt.model).ok_or("planar")?;
            let mut sums = [0.0; 10];
            let (mut first, mut last) = (0.0, 0.0);
            for d in learnt.demonstrations.items() {
                for (i, (x, v)) in d.x.iter().zip(&d.v).enumerate().step_by(5) {
                    let f = motion.velocity(&nalgebra::Vector2::new(x[0], x[1]));
                    let v = nalgebra::Vector2::new(v[0], v[1]);
                    if f.norm() * v.norm() > 0.0 {
                        let e = 1.0 - f.dot(&v) / (f.norm() * v.norm());
                        sums[i * 10 / d.x.len()] += e / 1400.0;
                        if i < 20 {
                            first += e / 1400.0;
                        }
                        if i + 20 >= d.x.len() {
                            last += e / 1400.0;
                        }
                    }
                }
            }
            println!("      {sums:.4?} first 2% {first:.4} last 2% {last:.4}");
        }
        table.push([
            learnt.model.component.len() as f64,
            q.rmse * 1e3,
            q.e_dot,
            q.dtwd * 1e3,
            q.pace,
            seconds,
            o[0],
            o[1],
            o[2],
        ]);
    }
    let m: Vec<f64> = (0..9).map(|i| median(table.iter().map(|r| r[i]).collect())).collect();
    println!(
        "{:20} {:3} {:7.3} {:7.4} {:7.1} {:6.2} {:6.3} | {:6.0} {:6.0} {:6.0} worst dtwd {:.0}",
        "median",
        m[0],
        m[1],
        m[2],
        m[3],
        m[4],
        m[5],
        m[6],
        m[7],
        m[8],
        table.iter().map(|r| r[3]).fold(0.0, f64::max)
    );
    Ok(())
}
