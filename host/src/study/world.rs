//! A skill and what is in its way, as a scene file.

use std::fmt::Write as _;

use nalgebra::Vector2;

use super::column::Way;
use super::skill::Skill;
use crate::error::Error;
use crate::scene::Scene;

/// The speed limit of every study, m/s: that of a Franka Emika robot's hand, so that it hardly ever binds. The paper gives none.
pub const SPEED: f64 = 1.7;

/// An elliptic cylinder on the table, seen from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// No other of its world has it.
    pub name: String,
    /// Hard semi-axes, m.
    pub axes: [f64; 2],
    /// Soft over hard semi-axes: ln k + 1.
    pub ratio: f64,
    /// m
    pub center: Vector2<f64>,
    /// theta_1, rad.
    pub angle: f64,
    /// t (s), x, y (m) instead of a centre that stays.
    pub path: Vec<[f64; 3]>,
}

impl Body {
    /// One that stays where it is.
    pub fn new(name: &str, axes: [f64; 2], ratio: f64, center: Vector2<f64>, angle: f64) -> Self {
        Self { name: name.into(), axes, ratio, center, angle, path: Vec::new() }
    }

    /// k
    pub fn stiffness(&self) -> f64 {
        (self.ratio - 1.0).exp()
    }

    /// How far its core reaches from its centre in a direction of length one, m.
    pub fn reach(&self, direction: &Vector2<f64>) -> f64 {
        let first = Vector2::new(self.angle.cos(), self.angle.sin());
        let second = Vector2::new(-first.y, first.x);
        (self.axes[0] * direction.dot(&first)).hypot(self.axes[1] * direction.dot(&second))
    }

    /// The same with its soft layer made hard, as the original method has to take it.
    pub fn hardened(&self) -> Self {
        Self { axes: self.axes.map(|a| a * self.ratio), ratio: 1.0, ..self.clone() }
    }

    fn write(&self, text: &mut String) {
        let _ = writeln!(text, "[[obstacle]]\nname = \"{}\"\nshape = {{ ellipsoid = {:?} }}", self.name, self.axes);
        let _ = match &self.path[..] {
            [] => writeln!(text, "center = {:?}", [self.center.x, self.center.y]),
            path => writeln!(text, "path = {path:?}"),
        };
        let _ = writeln!(text, "angle = {:?}\nstiffness = {:?}", self.angle, self.stiffness());
    }
}

/// A skill and what is in its way.
#[derive(Clone, Debug)]
pub struct World<'a> {
    /// The motion.
    pub skill: &'a Skill,
    /// What is in its way.
    pub bodies: Vec<Body>,
    /// Where it starts, m; at least one place.
    pub starts: Vec<Vector2<f64>>,
    /// Distance to the attractor that counts as there, m.
    pub tolerance: f64,
    /// After this a run is given up, s.
    pub timeout: f64,
}

impl<'a> World<'a> {
    /// From where the skill starts.
    pub fn new(skill: &'a Skill, bodies: Vec<Body>) -> Self {
        Self { skill, bodies, starts: vec![skill.start], tolerance: 0.01, timeout: 30.0 }
    }

    /// The scene file; the model is in the folder `models` beside its own.
    pub fn toml(&self, way: impl Into<Way>) -> String {
        let mut text =
            format!("[ds]\nmodel = \"../models/{}.toml\"\n{}", self.skill.name.to_lowercase(), way.into().toml());
        let _ = writeln!(text, "[limits]\nspeed = {SPEED:?}");
        let _ = writeln!(text, "[goal]\ntolerance = {:?}\ntimeout = {:?}", self.tolerance, self.timeout);
        for start in &self.starts {
            let _ = writeln!(text, "[[start]]\nposition = {:?}", [start.x, start.y]);
        }
        self.bodies.iter().for_each(|body| body.write(&mut text));
        text
    }

    /// The scene.
    ///
    /// # Errors
    /// What is wrong with it, as with any scene file.
    pub fn scene(&self, name: &str, way: impl Into<Way>) -> Result<Scene, Error> {
        let name = format!("{name}.toml");
        Ok(Scene::parse_with_model(&name, &self.toml(way), &self.skill.text)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::column::Column;
    use crate::study::skill::Skills;
    use nalgebra::Vector3;

    #[test]
    fn a_world_is_the_scene_it_says() {
        let skills = Skills::new(None, &|_| {}).unwrap();
        let skill = &skills.s;
        let center = skill.place(0.5).at;
        let body = Body::new("ellipse", [0.05, 0.02], 1.5, center, 0.7);
        let out = Vector2::new(0.7_f64.cos(), 0.7_f64.sin());
        assert!((body.reach(&out) - 0.05).abs() < 1e-12);
        assert!((body.stiffness() - 0.5_f64.exp()).abs() < 1e-12);
        for column in Column::ALL {
            let scene = World::new(skill, vec![body.clone()]).scene("w", column).unwrap();
            let o = scene.obstacles()[0].at(0.0);
            let on = |far: f64| (center + out * far).push(0.0);
            assert!((o.gamma(&on(0.05)) - 1.0).abs() < 1e-9 && (o.gamma_soft(&on(0.075)) - 1.0).abs() < 1e-9);
            assert_eq!(scene.guard().is_some(), column == Column::Pliant);
            let other = World::new(skill, vec![body.clone()]).scene("w", Way::other(column)).unwrap();
            assert_eq!(other.guard().is_some(), column != Column::Pliant);
            assert_eq!(scene.starts(), [Vector3::new(skill.start.x, skill.start.y, 0.0)]);
        }
        let hard = body.hardened();
        assert_eq!((hard.axes, hard.ratio), ([0.05 * 1.5, 0.02 * 1.5], 1.0));
    }
}
