//! Rollouts from beside the demonstrated starts and paths, for every .mat of a folder: their time over the demonstrators', and the usual errors.

use nalgebra::Vector2;
use pliant::learn::{self, Options, Unit};
use std::path::PathBuf;

type V = Vector2<f64>;

fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

fn median(v: &mut [f64]) -> f64 {
    v.sort_by(f64::total_cmp);
    (v[(v.len() - 1) / 2] + v[v.len() / 2]) / 2.0
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().unwrap_or_default());
    let only = args.next().filter(|o| !o.is_empty());
    let unit = if args.next().is_some() { Unit::M } else { Unit::Mm };
    let mut files: Vec<_> = std::fs::read_dir(folder)?.filter_map(|e| e.ok().map(|e| e.path())).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "mat") || p.is_dir());
    files.sort();
    println!(
        "{:18} {:>2} {:>6} {:>6} {:>6} {:>5} {:>5} | {:>6} {:>6} {:>4} | {:>6} {:>6} {:>4}",
        "motion", "K", "rmse", "e_dot", "dtwd", "pace", "cpu", "median", "worst", ">2", "median", "worst", ">2"
    );
    let mut table: Vec<[f64; 11]> = vec![];
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if only.as_ref().is_some_and(|o| !o.split(',').any(|o| name.contains(o))) {
            continue;
        }
        let demos = learn::read(std::slice::from_ref(&file), Some(unit))?;
        let begin = cpu();
        let learnt = learn::learn_from(demos, &Options::default(), &|_| ())?;
        let seconds = cpu() - begin;
        let q = learnt.quality;
        let motion = learn::motion_of::<2>(&learnt.model).ok_or("planar")?;
        let demos = &learnt.demonstrations;
        let extent = demos.extent();
        let near = 0.05 * extent;
        let away = |x: &V| (x - motion.attractor).norm() > near;
        // Time of the last place farther than `near`.
        let time = |x: &V, duration: f64| {
            let dt = duration / 200.0;
            let (path, _) = motion.rollout(x, dt, 20.0 * duration, 0.01 * extent);
            path.iter().rposition(away).map_or(0.0, |i| i as f64 * dt)
        };
        let (mut starts, mut beside) = (vec![], vec![]);
        let mut mean = V::zeros();
        let (mut total, mut longest) = (0.0, 0.0f64);
        let mut all = vec![];
        for d in demos.items() {
            let x: Vec<V> = d.x.iter().map(|p| V::new(p[0], p[1])).collect();
            mean += x[0] / demos.items().len() as f64;
            let t = x.iter().rposition(away).map_or(0.0, |i| d.t[i] - d.t[0]);
            total += t / demos.items().len() as f64;
            longest = longest.max(d.duration());
            all.push((x, d.t.clone(), t));
        }
        starts.push(time(&mean, longest) / total);
        for (x, t, whole) in &all {
            for r in [0.05, 0.1] {
                for i in 0..8 {
                    let (s, c) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
                    starts.push(time(&(x[0] + V::new(c, s) * r * extent), longest) / total);
                }
                for part in [0.15, 0.3, 0.45, 0.6, 0.75] {
                    let i = (part * x.len() as f64) as usize;
                    let along = (x[(i + 3).min(x.len() - 1)] - x[i.saturating_sub(3)]).normalize();
                    for side in [-1.0, 1.0] {
                        let p = x[i] + V::new(-along.y, along.x) * side * r * extent;
                        beside.push((t[i] - t[0] + time(&p, longest)) / whole);
                    }
                }
            }
        }
        let late = |v: &[f64]| v.iter().filter(|&&t| t > 2.0).count() as f64 / v.len() as f64 * 100.0;
        let worst = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
        let row = [
            q.rmse * 1e3,
            q.e_dot,
            q.dtwd * 1e3,
            q.pace,
            seconds,
            median(&mut starts),
            worst(&starts),
            late(&starts),
            median(&mut beside),
            worst(&beside),
            late(&beside),
        ];
        println!(
            "{name:18} {:2} {:6.3} {:6.4} {:6.1} {:5.2} {:5.3} | {:6.2} {:6.2} {:4.0} | {:6.2} {:6.2} {:4.0} {:?}",
            learnt.model.component.len(),
            row[0],
            row[1],
            row[2],
            row[3],
            row[4],
            row[5],
            row[6],
            row[7],
            row[8],
            row[9],
            row[10],
            (q.converged, q.rollouts)
        );
        table.push(row);
    }
    let m: Vec<f64> = (0..11).map(|i| median(&mut table.iter().map(|r| r[i]).collect::<Vec<_>>())).collect();
    let w: Vec<f64> = (0..11).map(|i| table.iter().map(|r| r[i]).fold(0.0, f64::max)).collect();
    for (what, r) in [("median", m), ("worst", w)] {
        println!(
            "{what:18}    {:6.3} {:6.4} {:6.1} {:5.2} {:5.3} | {:6.2} {:6.2} {:4.0} | {:6.2} {:6.2} {:4.0}",
            r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10]
        );
    }
    Ok(())
}
