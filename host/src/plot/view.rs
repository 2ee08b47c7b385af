//! From which side a scene is looked at.

use nalgebra::{Point2, Vector2, Vector3};

use crate::scene::Scene;

/// Two of the axes, and the plane they span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The axes shown to the right and upwards.
    axes: [usize; 2],
    /// The axis looked along, and where on it the section is; none if there are only two.
    pub plane: Option<(usize, f64)>,
}

impl View {
    /// One view in 2-D; from above and from the side in 3-D.
    pub fn of(scene: &Scene) -> Vec<Self> {
        if scene.dimension() == 2 {
            return vec![Self { axes: [0, 1], plane: None }];
        }
        let at = scene.attractor();
        vec![Self { axes: [0, 1], plane: Some((2, at.z)) }, Self { axes: [0, 2], plane: Some((1, at.y)) }]
    }

    /// A point as seen.
    pub fn project(&self, p: &Vector3<f64>) -> Point2<f64> {
        Point2::new(p[self.axes[0]], p[self.axes[1]])
    }

    /// A direction as seen.
    pub fn project_direction(&self, v: &Vector3<f64>) -> Vector2<f64> {
        self.project(v).coords
    }

    /// The point of the plane that is seen there.
    pub fn lift(&self, p: &Point2<f64>) -> Vector3<f64> {
        let mut lifted = Vector3::zeros();
        lifted[self.axes[0]] = p.x;
        lifted[self.axes[1]] = p.y;
        if let Some((axis, level)) = self.plane {
            lifted[axis] = level;
        }
        lifted
    }

    /// The names of both axes.
    pub fn names(&self) -> [String; 2] {
        self.axes.map(|i| format!("{} (m)", ["x", "y", "z"][i]))
    }
}
