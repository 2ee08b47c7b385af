use proptest::prelude::*;

use super::*;

prop_compose! {
    fn random_scene()(
        spatial in any::<bool>(),
        axes in prop::array::uniform3(1e-4..0.2f64),
        center in prop::array::uniform3(0.5..2.0f64),
        turn in (0.1..1.0f64, prop::array::uniform3(-1.0..1.0f64)),
        softness in 0..4,
        k in 1.0..1e6f64,
        curvature in 1..9u8,
        margin in prop::array::uniform3(1.0..1.5f64),
        reference in prop::array::uniform3(-0.9..0.9f64),
        velocity in prop::array::uniform3(-3.0..3.0f64),
        angular in -5.0..5.0f64,
        fixed in any::<bool>(),
        kind in 0..5,
        wall in any::<bool>(),
        growth in -0.05..0.05f64,
    ) -> String {
        let d = if spatial { 3 } else { 2 };
        let list = |v: &[f64]| format!("{:?}", &v[..d]);
        let turn = [turn.0, turn.1[0], turn.1[1], turn.1[2]];
        let length = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit: Vec<f64> = turn.iter().map(|x| x / length).collect();
        let soft: Vec<f64> = axes.iter().map(|a| a * 1.4).collect();
        let softness = match softness {
            0 => String::new(),
            1 => format!("stiffness = {k:?}"),
            2 => format!("soft = {}", list(&soft)),
            _ => format!("layer = {:?}", axes.iter().fold(f64::MAX, |m, a| m.min(*a)) * 0.3),
        };
        let mut point = [0.0; 3];
        for i in 0..3 { point[i] = reference[i] * axes[i] / 2.0; }
        let (turn, spin) = if spatial {
            (format!("rotation = {unit:?}"), format!("[{angular:?}, 0.5, -1.0]"))
        } else {
            (format!("angle = {:?}", turn[0]), format!("{angular:?}"))
        };
        let thin = axes.iter().take(d).fold(f64::MAX, |m, a| m.min(*a));
        let [a, b, _] = axes;
        let shape = match (kind, spatial) {
            (1, _) => Some(format!("{{ box = {} }}", list(&axes))),
            (2, true) => Some(format!("{{ cylinder = [{a:?}, {b:?}], rounding = {:?} }}", a.min(b))),
            (3, true) => Some(format!("{{ capsule = [{a:?}, {b:?}] }}")),
            (4, false) => {
                let [c, d] = [-a, -b];
                Some(format!("{{ polygon = [[{a:?}, {d:?}], [{c:?}, {d:?}], [{c:?}, {b:?}], [{a:?}, {b:?}]] }}"))
            }
            _ => None,
        };
        // Only of an ellipsoid is it known what is inside.
        let reference = if shape.is_some() { [0.0; 3] } else { point };
        let wall = wall && shape.is_some() && thin > 0.01;
        // A factor an axis would uncover parts of a polygon.
        let polygonal = (kind, spatial) == (4, false);
        let margin = if polygonal { [margin[0]; 3] } else { margin };
        let softness = match shape {
            Some(_) if polygonal => format!("stiffness = 1.3\nwall = {wall}"),
            Some(_) => format!("layer = {:?}\nwall = {wall}", thin * 0.3),
            None => format!("{softness}\ncurvature = {curvature}"),
        };
        let shape = shape.unwrap_or_else(|| format!("{{ ellipsoid = {} }}", list(&axes)));
        let (home, start) = if wall { (center, center) } else { ([0.0; 3], [-1.0; 3]) };
        let steering = if fixed { "{ fixed = 0.785 }" } else { "\"with-flow\"" };
        format!(
            "[ds]\nlinear = {{ attractor = {}, gain = 1.0 }}\n[modulation]\nsteering = {steering}\n[[start]]\nposition = {}\n\
             [[obstacle]]\nname = \"o\"\nshape = {shape}\ncenter = {}\n{turn}\n{softness}\n\
             growth = {growth:?}\nmargin = {}\nreference = {}\nvelocity = {}\nangular_velocity = {spin}\n",
            list(&home), list(&start), list(&center), list(&margin), list(&reference), list(&velocity)
        )
    }
}

fn converts<S: pliant_core::Scalar, const D: usize>(scene: &Scene, t: f64) -> bool {
    scene.settings::<S>().check().is_ok()
        && scene.controller::<S, D, 64>(t).is_ok()
        && scene.start_positions::<S, D>().is_ok_and(|s| s.iter().all(|x| pliant_core::RobotState::new(*x).is_some()))
}

proptest! {
    #[test]
    fn a_scene_that_was_read_always_converts(text in random_scene(), share in 0.0..1.0f64) {
        let scene = parse(&text).unwrap();
        let t = share * scene.goal().timeout;
        if scene.dimension() == 2 {
            prop_assert!(converts::<f32, 2>(&scene, t) && converts::<f64, 2>(&scene, t));
            prop_assert!(!converts::<f64, 3>(&scene, t));
        } else {
            prop_assert!(converts::<f32, 3>(&scene, t) && converts::<f64, 3>(&scene, t));
            prop_assert!(!converts::<f64, 2>(&scene, t));
        }
    }

    #[test]
    fn gamma_is_one_on_the_surfaces(text in random_scene(), d in prop::array::uniform3(-1.0..1.0f64), t in 0.0..5.0f64) {
        let scene = parse(&text).unwrap();
        let posed = scene.obstacles()[0].at(t);
        let z = if scene.dimension() == 3 { d[2] } else { 0.0 };
        let direction = Vector3::new(d[0], d[1], z);
        prop_assume!(direction.norm() > 0.1);
        let near_one = |gamma: f64| (gamma - 1.0).abs() < 1e-6;
        prop_assert!(near_one(posed.gamma(&posed.surface(&direction))));
        prop_assert!(near_one(posed.gamma_soft(&posed.soft_surface(&direction))));
        // A margin moves the surface outwards, of a wall inwards.
        let bare = posed.without_margin().surface(&direction) - posed.pose.center;
        let whole = posed.surface(&direction) - posed.pose.center;
        let outwards = whole.norm() - bare.norm();
        let beyond = if posed.obstacle.is_wall() { -outwards } else { outwards };
        prop_assert!(beyond > -1e-9);
    }

    #[test]
    fn no_text_makes_it_panic(text in "[\\[\\]a-z={}\"0-9., \n]{0,200}") {
        let _ = parse(&text);
    }

    #[test]
    fn no_damage_to_a_scene_makes_it_panic(at in 0..GOOD.len(), with in "[\\[\\]a-z={}\"0-9.\n-]{0,3}", cut in 0..6usize) {
        let end = (at + cut).min(GOOD.len());
        let damaged = format!("{}{with}{}", &GOOD[..at], &GOOD[end..]);
        if let Err(error) = parse(&damaged) {
            prop_assert!(error.to_string().starts_with("dir/bad.toml, line "));
        }
    }
}
