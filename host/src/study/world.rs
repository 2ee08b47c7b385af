//! A skill and what is in its way, as a scene file.

use std::fmt::Write as _;

use nalgebra::Vector2;

use super::column::Column;
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

    /// The scene file; the model is beside it.
    pub fn toml(&self, column: Column) -> String {
        let mut text = format!("[ds]\nmodel = \"{}.toml\"\n{}", self.skill.name.to_lowercase(), column.toml());
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
    pub fn scene(&self, name: &str, column: Column) -> Result<Scene, Error> {
        let name = format!("{name}.toml");
        Ok(Scene::parse_with_model(&name, &self.toml(column), &self.skill.text)?)
    }
}
