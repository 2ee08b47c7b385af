use super::*;

fn points(flat: &[[f64; 2]]) -> Vec<DVector<f64>> {
    flat.iter().map(|p| DVector::from_row_slice(p)).collect()
}

fn message<T: std::fmt::Debug>(result: Result<T, LearnError>) -> String {
    result.expect_err("must be refused").to_string()
}

#[test]
fn duplicates_are_dropped_and_velocity_is_computed() {
    let x = points(&[[0.0, 0.0], [0.0, 0.0], [1.0, 2.0]]);
    let d = Demonstration::new("a", vec![0.0, 0.0, 1.0], x, None).expect("valid");
    assert_eq!(d.t, [0.0, 1.0]);
    assert_eq!(d.v[0].as_slice(), [1.0, 2.0]);
}

#[test]
fn what_is_not_a_motion_is_refused() {
    assert!(message(Demonstration::new("a", vec![], vec![], None)).contains("empty"));
    let one = Demonstration::new("a", vec![0.0], points(&[[1.0, 1.0]]), None);
    assert!(message(one).contains("one sample"));
    let still = points(&[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]);
    assert!(message(Demonstration::new("a", vec![0.0, 1.0, 2.0], still, None)).contains("never moves"));
    let nan = points(&[[1.0, f64::NAN], [1.0, 1.0]]);
    assert!(message(Demonstration::new("a", vec![0.0, 1.0], nan, None)).contains("not a number"));
    let back = points(&[[1.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
    assert!(message(Demonstration::new("a", vec![0.0, 1.0, 0.5], back, None)).contains("from 1 to 0.5"));
    let flat = vec![DVector::from_element(4, 1.0), DVector::from_element(4, 2.0)];
    assert!(message(Demonstration::new("a", vec![0.0, 1.0], flat, None)).contains("dimension 4"));
}

#[test]
fn velocities_that_go_elsewhere_are_refused() {
    let x = points(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]);
    let with = |v: f64| {
        let v = points(&[[v, 0.1], [v, 0.1], [v, 0.1]]);
        Demonstration::new("a", vec![0.0, 0.5, 1.0], x.clone(), Some(v))
    };
    assert!(message(with(0.0)).contains("do not go where"));
    assert!(message(with(-1.0)).contains("do not go where"));
    assert!(with(0.1).is_ok());
}

#[test]
fn few_samples_are_told_of() {
    let few = |n: u32| {
        let t: Vec<f64> = (0..n).map(f64::from).collect();
        let x = t.iter().map(|t| DVector::from_row_slice(&[*t, 0.0])).collect();
        let all = Demonstration::new("a", t, x, None).expect("valid").warnings;
        all.iter().any(|w| matches!(w, Warning::Few { .. }))
    };
    assert!(few(2) && few(19) && !few(20));
}

#[test]
fn all_end_at_the_attractor() {
    let make =
        |end: f64| Demonstration::new("a", vec![0.0, 1.0], points(&[[1.0, 1.0], [end, 0.0]]), None).expect("valid");
    let all = Demonstrations::new(vec![make(0.02), make(-0.01)]).expect("ends agree");
    assert_eq!(all.attractor().as_slice(), [0.005, 0.0]);
    for item in all.items() {
        assert!((item.x.last().expect("two") - all.attractor()).norm() < 1e-12);
    }
    let apart = Demonstrations::new(vec![make(0.0), make(0.5)]);
    assert!(message(apart).contains("from the mean end point"));
}

#[test]
fn a_recording_that_is_there_twice_is_told_of() {
    let make = |name: &str, x: f64| {
        Demonstration::new(name, vec![0.0, 1.0], points(&[[x, 1.0], [0.0, 0.0]]), None).expect("valid")
    };
    let said = |items| -> Vec<String> {
        let all: Demonstrations = Demonstrations::new(items).expect("one skill");
        let again = all.warnings().iter().filter(|w| matches!(w, Warning::Again { .. }));
        again.map(ToString::to_string).collect()
    };
    assert!(said(vec![make("a", 1.0), make("b", 1.1)]).is_empty());
    let twice = said(vec![make("a", 1.0), make("b", 1.1), make("a", 1.0), make("c", 1.1)]);
    assert_eq!(twice.len(), 1, "{twice:?}");
    assert!(twice[0].starts_with("a: it is given twice; of 4 demonstrations 2 repeat another"), "{twice:?}");
    let other = said(vec![make("a", 1.0), make("b", 1.0)]);
    assert!(other[0].starts_with("b: it is the same as a; of 2 demonstrations 1 repeat"), "{other:?}");
}

#[test]
fn dimensions_must_agree() {
    let flat = Demonstration::new("a", vec![0.0, 1.0], points(&[[1.0, 1.0], [0.0, 0.0]]), None);
    let solid = vec![DVector::from_element(3, 1.0), DVector::from_element(3, 0.0)];
    let solid = Demonstration::new("b", vec![0.0, 1.0], solid, None).expect("valid");
    let text = message(Demonstrations::new(vec![flat.expect("valid"), solid]));
    assert!(text.contains("b: it has dimension 3, and a has 2"), "{text}");
}
