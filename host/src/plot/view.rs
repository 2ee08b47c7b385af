//! From which side a scene is looked at.

use nalgebra::{Point2, Vector2, Vector3};

use crate::scene::Scene;

/// Two of the axes; in 3-D the scene is projected along the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The axes shown to the right and upwards.
    axes: [usize; 2],
    /// The axis looked along and the sign of the direction to the viewer; none if there are only two.
    toward: Option<(usize, f64)>,
}

impl View {
    /// One view in 2-D; from above and from the side in 3-D.
    pub fn of(scene: &Scene) -> Vec<Self> {
        if scene.dimension() == 2 {
            return vec![Self { axes: [0, 1], toward: None }];
        }
        vec![Self { axes: [0, 1], toward: Some((2, 1.0)) }, Self { axes: [0, 2], toward: Some((1, -1.0)) }]
    }

    /// Is there a third axis?
    pub fn is_projection(&self) -> bool {
        self.toward.is_some()
    }

    /// The unit direction to the viewer; zero in 2-D.
    pub fn toward(&self) -> Vector3<f64> {
        self.toward.map_or(Vector3::zeros(), |(axis, sign)| Vector3::ith(axis, sign))
    }

    /// A point as seen.
    pub fn project(&self, p: &Vector3<f64>) -> Point2<f64> {
        Point2::new(p[self.axes[0]], p[self.axes[1]])
    }

    /// A direction as seen.
    pub fn project_direction(&self, v: &Vector3<f64>) -> Vector2<f64> {
        self.project(v).coords
    }

    /// The point that is seen there, at zero along the third axis.
    pub fn lift(&self, p: &Point2<f64>) -> Vector3<f64> {
        let mut lifted = Vector3::zeros();
        lifted[self.axes[0]] = p.x;
        lifted[self.axes[1]] = p.y;
        lifted
    }

    /// The names of both axes.
    pub fn names(&self) -> [String; 2] {
        self.axes.map(|i| format!("{} (m)", ["x", "y", "z"][i]))
    }

    /// Where the viewer is; nothing in 2-D.
    pub fn title(&self) -> Option<&'static str> {
        self.toward.map(
            |(axis, _)| if axis == 2 { "seen from above (from +z)" } else { "seen from the side (from \u{2212}y)" },
        )
    }
}
