use super::report::median;
use super::*;
use crate::learn::{Demonstration, Demonstrations};
use nalgebra::DVector;
use proptest::prelude::*;

#[test]
fn the_middle_is_what_half_lie_below() {
    assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
    assert_eq!((median([7.0]), median([])), (Some(7.0), None));
}

proptest! {
    #[test]
    fn a_median_has_as_many_on_either_side(values in proptest::collection::vec(-1e3..1e3f64, 1..40)) {
        let m = median(values.clone()).unwrap();
        let below = values.iter().filter(|v| **v < m).count();
        let above = values.iter().filter(|v| **v > m).count();
        prop_assert!(2 * below <= values.len() && 2 * above <= values.len());
    }
}

/// A line to the origin, beside the x axis by `y`, with a bow of `bow`; m.
fn stroke(y: f64, bow: f64) -> Demonstration {
    let t: Vec<f64> = (0..=150).map(|i| f64::from(i) / 75.0).collect();
    let place = |t: &f64| {
        let left = (1.0 - t / 2.0).powi(2) * (1.0 + t);
        DVector::from_row_slice(&[0.04 * left, y * left + bow * left * (1.0 - left)])
    };
    Demonstration::new(format!("stroke {y}"), t.clone(), t.iter().map(place).collect(), None).unwrap()
}

#[test]
fn what_is_held_out_is_not_learnt_from() {
    let alike: Vec<_> = (0..4).map(|i| stroke(0.002 * f64::from(i), 0.02)).collect();
    // One goes another way: it can only be followed where it was shown.
    let mut all = alike.clone();
    all.push(stroke(0.004, -0.02));
    let all = Demonstrations::new(all).unwrap();
    let options = Options::default();
    let folds: Vec<Quality> = (0..5).map(|i| held_out(&all, i, &options).unwrap()).collect();
    let odd = folds[4].dtwd;
    // Where it was drawn, the others move elsewhere.
    assert!(folds[..4].iter().all(|q| q.rollouts == 1 && folds[4].rmse > 2.0 * q.rmse), "{folds:?}");
    // The same as learning from the others by hand, for all end in the origin; only where a rollout has arrived depends on the size of all.
    let learnt = crate::learn::learn_from(Demonstrations::new(alike).unwrap(), &options, &|_| {}).unwrap();
    let alone = Demonstrations::new(vec![stroke(0.004, -0.02)]).unwrap();
    let by_hand = crate::learn::evaluate(&learnt.model, &alone).unwrap();
    assert_eq!((by_hand.rmse, by_hand.e_dot), (folds[4].rmse, folds[4].e_dot));
    assert!((by_hand.dtwd - odd).abs() < 0.05 * odd, "{by_hand:?}, {odd}");
    assert!(held_out(&all, 5, &options).is_err() && held_out(&alone, 0, &options).is_err());
}

#[test]
fn a_mean_is_over_demonstrations_and_counts_add_up() {
    let one = Quality {
        rmse: 1.0,
        e_dot: 0.5,
        dtwd: 2.0,
        path_error: 0.0,
        pace: 1.0,
        converged: 1,
        rollouts: 1,
        robust: 1,
        beside: 2,
        excursion: 0.0,
        excursion_from: None,
    };
    let HeldOut { mean, worst } = HeldOut::of(&[one, Quality { rmse: 3.0, dtwd: 8.0, converged: 0, ..one }]).unwrap();
    assert_eq!((mean.rmse, mean.dtwd, mean.converged, mean.rollouts), (2.0, 5.0, 1, 2));
    assert_eq!((worst, HeldOut::of(&[])), (8.0, None));
}

#[test]
fn motions_are_files_and_folders_of_files() {
    let folder = std::env::temp_dir().join(format!("pliant-motions-{}", std::process::id()));
    for file in ["b.csv", "a.MAT", ".hidden.csv", "notes.md", "c/2.csv", "c/1.npz", "c/deep/1.csv", "none/notes.md"] {
        let path = folder.join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "").unwrap();
    }
    let found = sources(&folder).unwrap();
    assert_eq!(found.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["a", "b", "c"]);
    assert_eq!(found[2].files, [folder.join("c/1.npz"), folder.join("c/2.csv")]);
    let said = sources(&folder.join("none")).unwrap_err().to_string();
    assert!(said.contains("none: no motion in it"), "{said}");
    assert!(sources(&folder.join("b.csv")).is_err() && sources(&folder.join("x")).is_err());
    std::fs::remove_dir_all(folder).unwrap();
}
