use super::*;
use proptest::prelude::*;

const YAML: &str = "name: test
K: 2.0
M: 2.0
Priors: [0.25, 0.75]
Mu: [0.1, 0.2, 0.3,
  0.4]
Sigma: [0.01, 0.002, 0.002, 0.02, 0.01, 0.0, 0.0, 0.02]
A: [-1.0, -3.5, 0.5, -1.0, -2.0, 0.0, 0.0, -1.0]
attractor: [0.0, 0.5]
x0_all: [0.4, 0.4, 0.5, 0.4]
dt: 0.01
";

fn yaml(text: &str) -> Result<Imported, ImportError> {
    parse("m.yml", text.as_bytes(), Layout::default())
}

fn refused(from: &str, to: &str) -> String {
    let text = YAML.replacen(from, to, 1);
    assert_ne!(text, YAML);
    yaml(&text).expect_err("must be refused").to_string()
}

#[test]
fn matrices_are_by_column_in_yaml_and_by_row_in_json() {
    let found = yaml(YAML).expect("valid");
    assert_eq!(found.model.component[0].a, [[-1.0, 0.5], [-3.5, -1.0]]);
    assert_eq!(found.model.component[1].mean, [0.3, 0.4]);
    assert_eq!((found.proof, found.starts), (Proof::Found, vec![vec![0.4, 0.4], vec![0.5, 0.4]]));
    let json = r#"{"name": "DAMM-LPVDS", "K": 2, "M": 2, "Prior": [0.25, 0.75], "Mu": [0.1, 0.2, 0.3, 0.4],
        "Sigma": [0.01, 0.002, 0.002, 0.02, 0.01, 0.0, 0.0, 0.02], "A": [-1.0, 0.5, -3.5, -1.0, -2.0, 0.0, 0.0, -1.0],
        "attractor": [0.0, 0.5], "att_all": [0.0, 0.5], "x_0": [0.4, 0.4], "gripper_open": 0}"#;
    let other = parse("m.json", json.as_bytes(), Layout::default()).expect("valid");
    assert_eq!(other.model.component, found.model.component);
    let nested = YAML.replace(
        "A: [-1.0, -3.5, 0.5, -1.0, -2.0, 0.0, 0.0, -1.0]",
        "A: [[[-1.0, 0.5], [-3.5, -1.0]], [[-2, 0], [0, -1]]]",
    );
    assert_eq!(yaml(&nested).expect("valid").model.component, found.model.component);
}

#[test]
fn means_axis_by_axis_are_noticed_and_read_where_declared() {
    let yaml = |text: &str, means| parse("m.yml", text.as_bytes(), Layout { means, ..Layout::default() });
    // By axes the second component is at the attractor, by components none is near it.
    let text = YAML.replace("0.3,\n  0.4]", "0.4, 0.5]").replace("Mu: [0.1, 0.2", "Mu: [0.9, 0.0");
    let said = yaml(&text, None).expect_err("must be refused").to_string();
    assert!(said.contains("line 5: `Mu` read component by component") && said.contains("--means axes"), "{said}");
    assert_eq!(yaml(&text, Some(Means::Axes)).expect("valid").model.component[1].mean, [0.0, 0.5]);
    assert_eq!(yaml(&text, Some(Means::Components)).expect("valid").model.component[1].mean, [0.4, 0.5]);
}

#[test]
fn matrices_in_the_other_order_are_noticed_and_read_where_declared() {
    // A component that is long along x, and a motion that goes along it: A (mean - attractor) = (-0.9, 0) by columns.
    let text = "K: 1\nM: 2\nPriors: [1]\nMu: [0.5, 0.2]\nSigma: [0.04, 0, 0, 0.001]\nattractor: [0, 0]\n";
    let with =
        |a: &str, order| parse("m.yml", format!("{text}A: [{a}]\n").as_bytes(), Layout { order, ..Layout::default() });
    assert!(with("-2.0, 2.0, 0.5, -5.0", None).is_ok());
    let said = with("-2.0, 0.5, 2.0, -5.0", None).expect_err("must be refused").to_string();
    assert!(said.contains("line 7: `A` as read moves across") && said.contains("--order rows"), "{said}");
    let found = with("-2.0, 0.5, 2.0, -5.0", Some(Order::Rows)).expect("valid");
    assert_eq!(found.model.component[0].a, [[-2.0, 0.5], [2.0, -5.0]]);
    assert!(with("-2.0, 0.5, 2.0, -5.0", Some(Order::Columns)).is_ok());
}

#[test]
fn units_are_declared() {
    let (m, cm) = (
        yaml(YAML).expect("valid").model,
        parse("m.yml", YAML.as_bytes(), Layout { unit: Some(Unit::Cm), ..Layout::default() }).expect("valid"),
    );
    assert_eq!(cm.model.attractor, [0.0, 0.005]);
    assert_eq!(cm.starts[0], [0.004, 0.004]);
    for (a, b) in m.component.iter().zip(&cm.model.component) {
        assert_eq!(a.a, b.a);
        assert!(
            (a.mean[1] * 0.01 - b.mean[1]).abs() < 1e-9
                && (a.covariance[0][0] * 1e-4 - b.covariance[0][0]).abs() < 1e-12
        );
    }
}

#[test]
fn a_p_of_its_own_is_kept_if_it_proves_the_motion() {
    let own = yaml(&format!("{YAML}P: [6.0, 0.5, 0.5, 1.0]\n")).expect("valid");
    assert_eq!(own.proof, Proof::Given);
    assert!((own.model.lyapunov[0][0] / own.model.lyapunov[1][1] - 6.0).abs() < 1e-6);
    for wrong in ["P: [1.0, 0.0, 0.0, 1.0]", "P: [-1.0, 0.0, 0.0, 1.0]", "P: [0.0, 0.0, 0.0, 0.0]"] {
        let found = yaml(&format!("{YAML}{wrong}\n")).expect("valid");
        assert_eq!(found.proof, Proof::Replaced);
        assert!(found.model.certified::<f32>());
    }
}

#[test]
fn mistakes_have_their_line_and_field() {
    let cases = [
        ("K: 2.0", "K: 3.0", "m.yml, line 4: `Priors` has 2 numbers; allowed is 3 numbers"),
        ("K: 2.0", "K: 17", "line 2: `K` is 17; allowed is 1 to 16"),
        ("M: 2.0", "M: two", "line 3: `M` is `two`; allowed is 1 number, the dimension"),
        ("K: 2.0", "Prior: [0.75, 0.25]\nK: 2.0", "line 2: `Prior` is there beside `Priors`, and differs"),
        ("Mu: ", "Moo: ", "m.yml: `Mu` is missing; needed: 4 numbers"),
        ("attractor: [0.0, 0.5]", "attractor: [0.0, .nan]", "line 9: `attractor` holds NaN"),
        ("0.25, 0.75", "-0.25, 0.75", "component 1: `prior` is -0.25"),
        ("[0.01, 0.002, 0.002, 0.02", "[0.01, 0.2, 0.2, 0.02", "component 1: `covariance` is not positive definite"),
        ("-2.0, 0.0, 0.0, -1.0]", "-2.0, 0.0, 0.0, 1.0]", "component 2 by itself leads away"),
        ("-2.0, 0.0, 0.0, -1.0]", "-0.1, 99.0, -0.1, -0.1]", "no P serves all components"),
        ("dt: 0.01", "dt: [0.01", "neither YAML nor JSON"),
        ("A: [-1.0, -3.5, 0.5, -1.0, -2.0, 0.0, 0.0, -1.0]\n", "Mu_scale: 1.0\n", "it is a SEDS model"),
    ];
    for (from, to, expected) in cases {
        let text = refused(from, to);
        assert!(text.contains(expected), "{text}\nwanted: {expected}");
    }
    assert!(
        parse("m.yml", b"K: 1\n\xff", Layout::default())
            .expect_err("no text")
            .to_string()
            .contains("line 2: it is not UTF-8")
    );
}

proptest! {
    #[test]
    fn damaged_text_never_panics(at: prop::sample::Index, with in "\\PC{0,4}") {
        let at = at.index(YAML.len());
        let _ = yaml(&format!("{}{with}{}", &YAML[..at], &YAML[at + 1..]));
    }
}
