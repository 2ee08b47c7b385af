//! An obstacle of a scene: what it is, and where it is at which time.

use nalgebra::{UnitQuaternion, Vector3};

/// What an obstacle's hard core looks like.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// An ellipsoid, or with a curvature above 1 a rounded box.
    Ellipsoid {
        /// Hard semi-axes, m.
        axes: Vector3<f64>,
    },
}

/// How the centre moves.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Track {
    Straight {
        from: Vector3<f64>,
        velocity: Vector3<f64>,
    },
    /// Time and centre, by increasing time, at least one.
    Path(Vec<(f64, Vector3<f64>)>),
}

/// An obstacle with its motion over scene time.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObstacle {
    pub(super) id: u16,
    pub(super) name: String,
    pub(super) shape: Shape,
    pub(super) soft_ratio: Vector3<f64>,
    pub(super) curvature: u8,
    pub(super) margin: Vector3<f64>,
    pub(super) reference: Vector3<f64>,
    pub(super) track: Track,
    pub(super) rotation: UnitQuaternion<f64>,
    pub(super) angular_velocity: Vector3<f64>,
}

/// Where an obstacle is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// m
    pub center: Vector3<f64>,
    /// From the obstacle's frame to the world's; in 2-D a turn about z.
    pub rotation: UnitQuaternion<f64>,
    /// Of the centre, m/s.
    pub velocity: Vector3<f64>,
    /// rad/s; in 2-D only z is not zero.
    pub angular_velocity: Vector3<f64>,
}

/// An obstacle at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosedObstacle<'a> {
    /// What it is.
    pub obstacle: &'a SceneObstacle,
    /// Where it is.
    pub pose: Pose,
}

impl SceneObstacle {
    /// Its place in the file, from 0.
    pub fn id(&self) -> u16 {
        self.id
    }
    /// Its name, of which there is no other in the scene.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Its hard core.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }
    /// Its hard semi-axes, m; for shapes that have none, those of a box around it.
    pub fn axes(&self) -> Vector3<f64> {
        match &self.shape {
            Shape::Ellipsoid { axes } => *axes,
        }
    }
    /// rho = b/a, soft over hard semi-axis; ones for a rigid obstacle.
    pub fn soft_ratio(&self) -> Vector3<f64> {
        self.soft_ratio
    }
    /// Has it a soft layer?
    pub fn is_soft(&self) -> bool {
        self.soft_ratio.iter().any(|rho| *rho > 1.0)
    }
    /// p
    pub fn curvature(&self) -> u8 {
        self.curvature
    }
    /// Safety factors eta on the hard semi-axes.
    pub fn margin(&self) -> Vector3<f64> {
        self.margin
    }
    /// The reference point in the obstacle's frame, m.
    pub fn reference(&self) -> Vector3<f64> {
        self.reference
    }
    /// Does it ever move?
    pub fn is_moving(&self) -> bool {
        let travels = match &self.track {
            Track::Straight { velocity, .. } => *velocity != Vector3::zeros(),
            Track::Path(points) => points.windows(2).any(|w| w[0].1 != w[1].1),
        };
        travels || self.angular_velocity != Vector3::zeros()
    }

    /// The obstacle as it is at scene time `t`, s. A path is followed in straight lines; before its first point and after its last the
    /// obstacle is at rest there.
    pub fn at(&self, t: f64) -> PosedObstacle<'_> {
        let (center, velocity) = match &self.track {
            Track::Straight { from, velocity } => (from + velocity * t, *velocity),
            Track::Path(points) => along(points, t),
        };
        let turned = UnitQuaternion::from_scaled_axis(self.angular_velocity * t);
        PosedObstacle {
            obstacle: self,
            pose: Pose { center, rotation: turned * self.rotation, velocity, angular_velocity: self.angular_velocity },
        }
    }
}

impl PosedObstacle<'_> {
    /// Gamma at `x`, safety factors included: at most 1 in the hard core.
    pub fn gamma(&self, x: &Vector3<f64>) -> f64 {
        self.level(x, &self.obstacle.margin)
    }

    /// Gamma_k at `x`: at most 1 in the soft layer and what is within it.
    pub fn gamma_soft(&self, x: &Vector3<f64>) -> f64 {
        self.level(x, &self.obstacle.soft_ratio)
    }

    fn level(&self, x: &Vector3<f64>, scale: &Vector3<f64>) -> f64 {
        let q = self.pose.rotation.inverse_transform_vector(&(x - self.pose.center));
        level(&q, &self.obstacle.axes().component_mul(scale), self.obstacle.curvature)
    }
}

/// sum_i |q_i / a_i|^2p over the axes there are.
pub(super) fn level(q: &Vector3<f64>, axes: &Vector3<f64>, p: u8) -> f64 {
    q.iter().zip(axes.iter()).filter(|(_, a)| **a > 0.0).map(|(q, a)| (q / a).powi(2 * i32::from(p))).sum()
}

fn along(points: &[(f64, Vector3<f64>)], t: f64) -> (Vector3<f64>, Vector3<f64>) {
    let after = points.partition_point(|(time, _)| *time <= t);
    match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
        (Some((t0, a)), Some((t1, b))) => {
            let velocity = (b - a) / (t1 - t0);
            (a + velocity * (t - t0), velocity)
        }
        (Some((_, only)), None) | (None, Some((_, only))) => (*only, Vector3::zeros()),
        (None, None) => (Vector3::zeros(), Vector3::zeros()),
    }
}
