use super::*;
use crate::learn::Warning;
use nalgebra::DVector;
use proptest::prelude::*;

/// A folder of its own, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("pliant-read-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("writable");
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).expect("writable");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn files_and_folders_are_read_in_their_units() {
    let folder = Folder::new("units");
    let csv = folder.write("a.csv", "t,x,y\n0,400,300\n1,0,0\n");
    let mat = folder.write("b.mat", mat_writer::file(&mat_writer::demos(&[2], 9, true), true));
    let x = [400.0, 300.0, 0.0, 0.0];
    let npz = folder.write("c.NPZ", npz_writer::file(&[("x", &[2, 2], &x), ("t", &[2], &[0.0, 1.0])], true));
    let start = |path: &Path, unit| read(&[path.to_owned()], unit).expect("valid").items()[0].x[0].clone();
    for path in [&csv, &npz] {
        assert_eq!(start(path, Some(Unit::Mm)).as_slice(), [0.4, 0.3]);
        assert_eq!(start(path, None).as_slice(), [400.0, 300.0]);
    }
    assert!((start(&mat, None) - DVector::from_vec(vec![0.1, 0.1])).norm() < 1e-12);
    assert_eq!(read(std::slice::from_ref(&folder.0), Some(Unit::Mm)).expect("valid").items().len(), 3);

    let text = |path: PathBuf| read(&[path], None).expect_err("must be refused").to_string();
    assert!(text(folder.0.join("none.csv")).contains("cannot be read"));
    assert!(text(folder.write("d.txt", "")).contains("unknown format"));
    fs::create_dir_all(folder.0.join("empty")).expect("writable");
    assert!(text(folder.0.join("empty")).contains("no demonstrations here"));
}

/// A bent motion as text, and its points.
fn motion(samples: usize, seconds: f64, factor: f64) -> String {
    let mut text = "t,x,y\n".to_owned();
    for i in 0..=samples {
        let s = i as f64 / samples as f64;
        let fade = (1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s);
        let (x, y) = (0.4 * fade * (3.0 * s).cos(), 0.3 * fade * (1.0 - s * (6.0 * s).sin()));
        text += &format!("{},{},{}\n", seconds * s, factor * x, factor * y);
    }
    text
}

/// The point at a part of the duration, by straight lines.
fn at(d: &Demonstration, part: f64) -> (DVector<f64>, DVector<f64>) {
    let t = d.t[0] + part * d.duration();
    let i = d.t.partition_point(|&u| u <= t).clamp(1, d.t.len() - 1);
    let s = ((t - d.t[i - 1]) / (d.t[i] - d.t[i - 1])).clamp(0.0, 1.0);
    (&d.x[i - 1] * (1.0 - s) + &d.x[i] * s, &d.v[i - 1] * (1.0 - s) + &d.v[i] * s)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// However often a motion is sampled, it is the same motion.
    #[test]
    fn the_rate_changes_nothing(samples in 150usize..30_000, seconds in 0.5..20.0f64) {
        let a = csv::read("a.csv", motion(400, seconds, 1.0).as_bytes()).expect("valid").remove(0);
        let b = csv::read("b.csv", motion(samples, seconds, 1.0).as_bytes()).expect("valid").remove(0);
        prop_assert!(b.t.len() <= 2002, "{}", b.t.len());
        for part in 0..=50 {
            let ((xa, va), (xb, vb)) = (at(&a, f64::from(part) / 50.0), at(&b, f64::from(part) / 50.0));
            prop_assert!((&xa - &xb).norm() < 1e-3 * 0.5, "{part}: {xa} {xb}");
            prop_assert!((&va - &vb).norm() * seconds < 0.08 * 0.5 * 3.0, "{part}: {va} {vb}");
        }
    }

    /// The same numbers in millimetres and declared so are the same demonstrations as in metres.
    #[test]
    fn units_commute(samples in 10usize..3000, seconds in 0.5..20.0f64) {
        let folder = Folder::new(&format!("commute-{samples}"));
        let in_m = read(&[folder.write("m.csv", motion(samples, seconds, 1.0))], Some(Unit::M)).expect("valid");
        let in_mm = read(&[folder.write("mm.csv", motion(samples, seconds, 1000.0))], Some(Unit::Mm)).expect("valid");
        let (a, b) = (&in_m.items()[0], &in_mm.items()[0]);
        prop_assert_eq!(&a.t, &b.t);
        for (p, q) in a.x.iter().zip(&b.x).chain(a.v.iter().zip(&b.v)) {
            prop_assert!((p - q).norm() < 1e-9 * (1.0 + p.norm()));
        }
    }
}

#[test]
fn the_order_of_files_changes_only_the_order() {
    let folder = Folder::new("order");
    let paths: Vec<_> =
        (0..3).map(|i| folder.write(&format!("{i}.csv"), motion(100 << (2 * i), 2.0 + f64::from(i), 1.0))).collect();
    let forth = read(&paths, None).expect("valid");
    let back: Vec<_> = paths.iter().rev().cloned().collect();
    let back = read(&back, None).expect("valid");
    assert_eq!(forth.attractor(), back.attractor());
    assert_eq!(forth.extent(), back.extent());
    let mut items = back.items().to_vec();
    items.reverse();
    assert_eq!(forth.items(), items);
    let mut said = back.warnings().to_vec();
    said.reverse();
    assert_eq!(forth.warnings(), said);
}

#[test]
fn a_fast_recorder_does_not_outvote_the_others() {
    let folder = Folder::new("rates");
    let paths = [
        folder.write("a.csv", motion(100, 2.0, 1.0)),
        folder.write("b.csv", motion(120, 2.0, 1.0)),
        folder.write("c.csv", motion(2000, 2.0, 1.0)),
        folder.write("d.csv", motion(25, 2.0, 1.0)),
        folder.write("e.csv", motion(80, 2.0, 1.0)),
    ];
    let all = read(&paths, None).expect("valid");
    let counts: Vec<_> = all.items().iter().map(|d| d.t.len()).collect();
    assert!(counts.iter().all(|n| (75..=140).contains(n)), "{counts:?}");
    let rates = all.warnings().iter().filter(|w| matches!(w, Warning::Rate { .. })).count();
    assert_eq!(rates, 2, "{:?}", all.warnings());
}

/// Recordings of the LASA set, where somebody has it (`PLIANT_LASA=folder`), are clean: nothing is left out.
#[test]
fn clean_recordings_stay_whole() {
    let Some(folder) = std::env::var_os("PLIANT_LASA") else {
        eprintln!("PLIANT_LASA is not set: nothing tested");
        return;
    };
    let mut count = 0;
    for item in recordings(&[PathBuf::from(folder)], None).expect("valid") {
        assert_eq!(item.t.len(), 1000, "{}: {:?}", item.name, item.warnings);
        assert!(item.warnings.is_empty(), "{:?}", item.warnings);
        count += 1;
    }
    assert!(count > 0);
}
