//! An obstacle of a scene: what it is, and where it is at which time.

use nalgebra::{UnitQuaternion, Vector3};
use pliant_core::{Obstacle, ObstacleSpec};

use super::convert::vector;
use super::shape::Shape;
use super::track::Track;

/// An obstacle with its motion over scene time.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObstacle {
    pub(super) id: u16,
    pub(super) name: String,
    pub(super) dimension: usize,
    pub(super) shape: Shape,
    pub(super) wall: bool,
    pub(super) soft_ratio: Vector3<f64>,
    pub(super) margin: Vector3<f64>,
    pub(super) reference: Vector3<f64>,
    pub(super) track: Track,
    pub(super) rotation: UnitQuaternion<f64>,
    pub(super) angular_velocity: Vector3<f64>,
    pub(super) growth: f64,
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
#[derive(Clone, Debug, PartialEq)]
pub struct PosedObstacle<'a> {
    /// What it is.
    pub obstacle: &'a SceneObstacle,
    /// Where it is.
    pub pose: Pose,
    /// Its hard core as large as it is then.
    pub shape: Shape,
    /// How fast each half extent becomes longer, m/s.
    pub growth: f64,
    /// None if it has left the range.
    body: Option<Body>,
}

/// The core's obstacle in the scene's dimension.
#[derive(Clone, Debug, PartialEq)]
enum Body {
    Planar(Box<Obstacle<f64, 2>>),
    Spatial(Box<Obstacle<f64, 3>>),
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
    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }
    /// Its hard core at time 0.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }
    /// Is it what is around its shape, and the shape free?
    pub fn is_wall(&self) -> bool {
        self.wall
    }
    /// rho: the soft layer's surface over the hard one (of a wall, the inverse) along each axis; ones for a rigid obstacle.
    pub fn soft_ratio(&self) -> Vector3<f64> {
        self.soft_ratio
    }
    /// Has it a soft layer?
    pub fn is_soft(&self) -> bool {
        self.soft_ratio.iter().any(|rho| *rho > 1.0)
    }
    /// Safety factors eta along each axis.
    pub fn margin(&self) -> Vector3<f64> {
        self.margin
    }
    /// Is its core larger to the device than it is?
    pub fn has_margin(&self) -> bool {
        self.margin.max() > 1.0
    }
    /// The reference point in the obstacle's frame, m.
    pub fn reference(&self) -> Vector3<f64> {
        self.reference
    }
    /// How fast each half extent becomes longer at first (below zero: shorter), m/s.
    pub fn growth(&self) -> f64 {
        self.growth
    }
    /// Does it ever move, turn or grow?
    pub fn is_moving(&self) -> bool {
        self.track.moves() || self.angular_velocity != Vector3::zeros() || self.growth != 0.0
    }

    /// The obstacle as it is at scene time `t`, s. A path is followed in straight lines; before its first point and after its last the
    /// obstacle is at rest there. One that shrinks ends very small.
    pub fn at(&self, t: f64) -> PosedObstacle<'_> {
        let (center, velocity) = self.track.at(t);
        let turned = UnitQuaternion::from_scaled_axis(self.angular_velocity * t);
        let by = self.growth * t;
        let least = if self.growth < 0.0 { self.shape.smallest() } else { by };
        let growth = if by < least { 0.0 } else { self.growth };
        let mut posed = PosedObstacle {
            obstacle: self,
            pose: Pose { center, rotation: turned * self.rotation, velocity, angular_velocity: self.angular_velocity },
            shape: self.shape.grown(by.max(least)),
            growth,
            body: None,
        };
        posed.body = posed.body(&self.margin);
        posed
    }
}

impl PosedObstacle<'_> {
    /// Gamma at `x`, safety factors included: at most 1 in the hard core. Infinite for one that has left the range.
    pub fn gamma(&self, x: &Vector3<f64>) -> f64 {
        match &self.body {
            Some(Body::Planar(o)) => o.gamma(&vector(x)),
            Some(Body::Spatial(o)) => o.gamma(x),
            None => f64::INFINITY,
        }
    }

    /// Gamma_k at `x`: at most 1 in the soft layer and what is within it.
    pub fn gamma_soft(&self, x: &Vector3<f64>) -> f64 {
        match &self.body {
            Some(Body::Planar(o)) => o.gamma_soft(&vector(x)),
            Some(Body::Spatial(o)) => o.gamma_soft(x),
            None => f64::INFINITY,
        }
    }

    /// The point of the hard surface, safety factors included, that a ray from the centre meets, m. `direction` is in the world's frame and
    /// not zero.
    pub fn surface(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        match &self.body {
            Some(Body::Planar(o)) => o.surface(&vector(direction)).push(0.0),
            Some(Body::Spatial(o)) => o.surface(direction),
            None => self.pose.center,
        }
    }

    /// The same for the end of the soft layer.
    pub fn soft_surface(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        match &self.body {
            Some(Body::Planar(o)) => o.soft_surface(&vector(direction)).push(0.0),
            Some(Body::Spatial(o)) => o.soft_surface(direction),
            None => self.pose.center,
        }
    }

    /// The same obstacle without its safety factors.
    pub fn without_margin(&self) -> Self {
        let ones = self.obstacle.margin.map(|_| 1.0);
        Self { body: self.body(&ones), ..self.clone() }
    }

    fn body(&self, margin: &Vector3<f64>) -> Option<Body> {
        Some(match self.obstacle.dimension {
            2 => Body::Planar(Box::new(self.solid(margin)?)),
            _ => Body::Spatial(Box::new(self.solid(margin)?)),
        })
    }

    fn solid<const D: usize>(&self, margin: &Vector3<f64>) -> Option<Obstacle<f64, D>> {
        Obstacle::new(ObstacleSpec { margin: vector(margin), ..self.spec().ok()? }).ok()
    }
}
