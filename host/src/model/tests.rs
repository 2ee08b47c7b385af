use super::*;
use proptest::prelude::*;

const TEXT: &str = r#"format = 1
name = "test"
dimension = 2
attractor = [0.0, 0.5]
lyapunov = [[1.0, 0.1], [0.1, 2.0]]

[[component]]
prior = 0.25
mean = [0.1, 0.2]
covariance = [[0.01, 0.002], [0.002, 0.02]]
a = [[-1.0, 0.5], [-0.5, -1.0]]

[[component]]
prior = 0.75
mean = [0.3, 0.4]
covariance = [[0.01, 0.0], [0.0, 0.02]]
a = [[-2.0, 0.0], [0.0, -1.0]]

[learnt]
seed = 1
"#;

fn refused(from: &str, to: &str) -> String {
    let text = TEXT.replacen(from, to, 1);
    assert_ne!(text, TEXT);
    ModelFile::parse("m.toml", &text).expect_err("must be refused").to_string()
}

#[test]
fn reads_and_certifies() {
    let model = ModelFile::parse("m.toml", TEXT).expect("valid");
    assert_eq!(model.component.len(), 2);
    assert!(model.certified::<f32>() && model.certified::<f64>());
    assert!(matches!(model.skill::<f32>(), Ok(Skill::Planar(_))));
    assert!(matches!(model.lpv_ds::<f64, 3>(), Err(ModelFileError::Dimension { found: 2, wanted: 3, .. })));
}

#[test]
fn every_mistake_has_its_line_and_field() {
    let cases = [
        ("format = 1", "format = 2", "m.toml, line 1: `format` is 2; allowed is 1"),
        ("dimension = 2", "dimension = 4", "m.toml, line 3: `dimension` is 4"),
        ("[0.0, 0.5]", "[0.0]", "line 4: `attractor` has 1 number for dimension 2"),
        ("[0.0, 0.5]", "[0.0, nan]", "line 4: `attractor` holds NaN"),
        ("[0.1, 2.0]]", "[0.2, 2.0]]", "line 5: `lyapunov` is not symmetric"),
        ("[0.1, 2.0]]", "[0.1, -2.0]]", "line 5: `lyapunov` is not positive definite"),
        ("prior = 0.75", "prior = 0.0", "line 14: component 2: `prior` is 0"),
        ("mean = [0.3, 0.4]", "mean = [0.3, 4e9]", "line 15: component 2: `mean` holds 4000000000"),
        ("[0.002, 0.02]]", "[0.002]]", "line 10: component 1: `covariance` is not 2 x 2"),
        ("[0.0, -1.0]]", "[0.0, inf]]", "line 17: component 2: `a` holds inf"),
        ("prior = 0.75", "prior = \"much\"", "line 14: invalid type"),
        ("prior = 0.75", "priour = 0.75", "line 14: unknown field `priour`"),
        ("name = \"test\"\n", "", "missing field `name`"),
        ("name = \"test\"", "name = \"test", "line 2"),
    ];
    for (from, to, expected) in cases {
        let text = refused(from, to);
        assert!(text.contains(expected), "{text}\nwanted: {expected}");
    }
}

#[test]
fn seventeen_components_are_too_many() {
    let mut model = ModelFile::parse("m.toml", TEXT).expect("valid");
    model.component = vec![model.component[0].clone(); 17];
    assert!(model.validate().expect_err("too many").to_string().contains("occurs 17 times"));
    model.component.clear();
    assert!(model.validate().is_err());
}

#[test]
fn an_unstable_component_has_no_certificate() {
    let mut model = ModelFile::parse("m.toml", TEXT).expect("valid");
    model.component[1].a[1][1] = 0.5;
    let text = model.skill::<f32>().expect_err("unstable").to_string();
    assert!(text.contains("component 2"), "{text}");
}

#[test]
fn the_core_evaluates_as_the_learner_does() {
    let model = ModelFile::parse("m.toml", TEXT).expect("valid");
    let motion = crate::learn::motion_of::<2>(&model).expect("planar");
    let core = model.lpv_ds::<f64, 2>().expect("valid");
    for x in [[0.1, 0.2], [0.25, 0.3], [-3.0, 5.0]] {
        let x = nalgebra::Vector2::from(x);
        assert!((motion.velocity(&x) - core.velocity(&x)).norm() < 1e-12);
    }
}

#[test]
fn what_is_remembered_of_learning_is_checked_too() {
    let learnt =
        "[learnt]\nseed = 1\nsigma = 0\nstarts = [[0.3, 0.4]]\nsources = [{ file = \"a.csv\", unit = \"mm\" }]\n";
    let good = format!("{}{learnt}", &TEXT[..TEXT.find("[learnt]").expect("there")]);
    let model = ModelFile::parse("m.toml", &good).expect("valid");
    let known = model.learnt.as_ref().expect("there");
    assert_eq!((known.seed, known.sigma, known.starts.len()), (Some(1), Some(0.0), 1));
    let again = ModelFile::parse("m.toml", &model.to_toml().expect("text")).expect("valid");
    assert_eq!(again, model);
    let line = |of: &str| 1 + good.lines().position(|l| l.contains(of)).expect("there");
    for (from, to, word) in [
        ("seed = 1", "sead = 1", "unknown field `sead`"),
        ("seed = 1", "seed = \"x\"", "expected i64"),
        ("file =", "fil =", "unknown field `fil`"),
        ("\"mm\"", "\"km\"", "unknown variant `km`"),
        ("[[0.3, 0.4]]", "[[0.3]]", "`learnt.starts` has 1 number for dimension 2"),
        ("[[0.3, 0.4]]", "[[0.3, nan]]", "`learnt.starts` holds NaN"),
    ] {
        let said = ModelFile::parse("m.toml", &good.replacen(from, to, 1)).expect_err("must be refused").to_string();
        assert!(said.starts_with(&format!("m.toml, line {}: ", line(from))) && said.contains(word), "{said}");
    }
}

#[test]
fn a_certificate_that_fails_points_at_what_fails() {
    let says = |from: &str, to: &str| {
        let text = Text::new("m.toml", TEXT.replacen(from, to, 1));
        let model = text.model().expect("each field by itself is right");
        text.locate(model.is_certified().expect_err("must be refused")).to_string()
    };
    let line = |of: &str| format!("m.toml, line {}: ", 1 + TEXT.lines().position(|l| l.contains(of)).expect("there"));
    let second = "a = [[-2.0, 0.0], [0.0, -1.0]]";
    let said = says(second, "a = [[2.0, 0.0], [0.0, -1.0]]");
    assert!(said.starts_with(&line(second)) && said.contains("component 2: a' P + P a"), "{said}");
    let said = says(second, "a = [[-2.0, 0.0], [0.0, -1e6]]");
    assert!(said.starts_with(&line(second)) && said.contains("`a` is out of range"), "{said}");
    // An error that is not about what is in the file stays as it is.
    let text = Text::new("m.toml", TEXT);
    let other = || ModelFileError::Dimension { name: "m".into(), found: 2, wanted: 3 };
    assert_eq!(text.locate(other()).to_string(), other().to_string());
}

proptest! {
    #[test]
    fn written_numbers_come_back_exactly(
        numbers in proptest::collection::vec(-900.0..900.0f64, 6), prior in 1e-12..1e3f64, small in 1e-9..1e-3f64,
    ) {
        let mut model = ModelFile::parse("m.toml", TEXT).expect("valid");
        model.attractor = numbers[..2].to_vec();
        model.component[0].mean = numbers[2..4].to_vec();
        model.component[0].a[0] = numbers[4..].to_vec();
        model.component[0].prior = prior;
        model.component[0].covariance = vec![vec![small, 0.3 * small], vec![0.3 * small, small]];
        let text = model.to_toml().expect("writes");
        let again = ModelFile::parse("m.toml", &text).expect("reads");
        prop_assert_eq!(&again, &model);
        prop_assert_eq!(again.to_toml().expect("writes"), text);
    }

    #[test]
    fn damaged_text_never_panics(at: prop::sample::Index, with in "\\PC{0,4}") {
        let at = at.index(TEXT.len());
        let text = format!("{}{with}{}", &TEXT[..at], &TEXT[at + 1..]);
        if let Ok(model) = ModelFile::parse("m.toml", &text) {
            let _ = model.skill::<f32>();
        }
    }
}
