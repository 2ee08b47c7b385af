//! A scene in the core's types.

use nalgebra::Vector3;
use pliant_core::{
    Ageing, Controller, Guard, Limits, Matrix, Motion, Obstacle, ObstacleError, ObstacleSpec, RANGE, Scalar, Scan,
    ScanError, Settings, SteeringPolicy, Vector,
};

use super::{Method, PosedObstacle, Scene, Steering};

/// Why a scene is not to be had in the type that was asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum ConvertError {
    /// Another dimension was asked for.
    #[error("the scene has {scene} dimensions, not {asked}")]
    Dimension {
        /// The scene's.
        scene: usize,
        /// The one asked for.
        asked: usize,
    },
    /// The core refuses an obstacle: long after the scene's timeout it may have left the range.
    #[error("obstacle \"{name}\" has an unusable {error:?}")]
    Obstacle {
        /// Its name.
        name: String,
        /// What the core says.
        error: ObstacleError,
    },
    /// The core refuses the motion.
    #[error("the motion is refused: {0}")]
    Motion(String),
    /// The core refuses the scan.
    #[error("the scan has an unusable {0:?}")]
    Scan(ScanError),
    /// The attractor has left the range, long after the scene's timeout.
    #[error("the attractor is beyond +-1000 m")]
    Attractor,
    /// More obstacles than the table that was asked for has room for.
    #[error("there is room for {0} obstacles, and the scene has more")]
    TableFull(usize),
}

/// The first D entries of a point, or of anything else with three.
pub(super) fn vector<S: Scalar, const D: usize>(v: &Vector3<f64>) -> Vector<S, D> {
    Vector::from_fn(|i, _| v.get(i).map_or(S::zero(), |x| S::from_f64(*x)))
}

impl Scene {
    fn in_dimension<const D: usize>(&self) -> Result<(), ConvertError> {
        if D == self.dimension { Ok(()) } else { Err(ConvertError::Dimension { scene: self.dimension, asked: D }) }
    }

    /// The nominal motion.
    ///
    /// # Errors
    /// Another dimension than the scene's.
    pub fn motion<S: Scalar, const D: usize>(&self) -> Result<Motion<S, D>, ConvertError> {
        self.in_dimension::<D>()?;
        self.motion.to_core()
    }

    /// The settings.
    pub fn settings<S: Scalar>(&self) -> Settings<S> {
        let number = S::from_f64;
        Settings {
            deformable: self.modulation.method == Method::Deformable,
            gain: number(self.modulation.c),
            steering: match self.modulation.steering {
                Steering::WithFlow { beta } => SteeringPolicy::WithFlow { beta: number(beta) },
                Steering::Fixed { angle } => SteeringPolicy::fixed(number(angle)),
            },
            limits: Limits {
                speed: number(self.limits.speed),
                acceleration: self.limits.acceleration.map(number),
                deceleration: number(self.limits.deceleration),
            },
            ageing: Ageing {
                time_to_live: number(self.ageing.time_to_live),
                growth: number(self.ageing.growth),
                hold: number(self.ageing.hold),
            },
            guard: self.guard.map(|guard| Guard { approach: number(guard.approach) }),
        }
    }

    /// Where runs start, m.
    ///
    /// # Errors
    /// Another dimension than the scene's.
    pub fn start_positions<S: Scalar, const D: usize>(&self) -> Result<Vec<Vector<S, D>>, ConvertError> {
        self.in_dimension::<D>()?;
        Ok(self.starts.iter().map(vector).collect())
    }

    /// The obstacles at scene time `t` (s) with their ids.
    ///
    /// # Errors
    /// Another dimension than the scene's, or a time at which an obstacle has left the range.
    pub fn core_obstacles<S: Scalar, const D: usize>(
        &self,
        t: f64,
    ) -> Result<Vec<(u16, Obstacle<S, D>)>, ConvertError> {
        self.in_dimension::<D>()?;
        self.obstacles_at(t).map(|o| Ok((o.obstacle.id, o.to_core()?))).collect()
    }

    /// The scan; none if the scene has none.
    ///
    /// # Errors
    /// Another dimension than the scene's.
    pub fn core_scan<S: Scalar, const D: usize>(&self) -> Result<Option<Scan<S, D>>, ConvertError> {
        self.in_dimension::<D>()?;
        self.scan.as_ref().map(|scan| scan.to_core().map_err(ConvertError::Scan)).transpose()
    }

    /// A controller with the scene's motion, settings, obstacles and scan as they are at scene time `t`, s.
    ///
    /// # Errors
    /// As [`Scene::core_obstacles`], a time at which the attractor has left the range, or a table that is too small.
    pub fn controller<S: Scalar, const D: usize, const CAP: usize>(
        &self,
        t: f64,
    ) -> Result<Controller<S, D, CAP>, ConvertError> {
        let mut controller = Controller::new(self.motion()?, self.settings());
        if self.attractor_moves() {
            let (position, velocity) = self.attractor_at(t);
            if !controller.aim(&vector(&position), &vector(&velocity)) {
                return Err(ConvertError::Attractor);
            }
        }
        if let Some(scan) = self.core_scan()? {
            controller.set_scan(scan, S::zero());
        }
        for (id, obstacle) in self.core_obstacles(t)? {
            controller.upsert(id, obstacle, S::zero()).map_err(|_| ConvertError::TableFull(CAP))?;
        }
        Ok(controller)
    }
}

impl PosedObstacle<'_> {
    /// What the core makes an obstacle from. In 2-D the z of everything is left out.
    ///
    /// # Errors
    /// None for an obstacle of a checked scene, asked for in the scene's dimension.
    pub fn spec<S: Scalar, const D: usize>(&self) -> Result<ObstacleSpec<S, D>, ConvertError> {
        let o = self.obstacle;
        let rotation = self.pose.rotation.to_rotation_matrix();
        let spin = self.pose.angular_velocity.cross_matrix();
        // It shrinks with the core, as it does between two sightings.
        let shrunk =
            self.shape.extent().zip_map(&o.shape.extent(), |now, first| if now < first { now / first } else { 1.0 });
        let square =
            |m: &nalgebra::Matrix3<f64>| Matrix::from_fn(|i, j| m.get((i, j)).map_or(S::zero(), |x| S::from_f64(*x)));
        Ok(ObstacleSpec {
            center: vector(&self.pose.center),
            rotation: square(rotation.matrix()),
            shape: self.shape.to_core().map_err(|error| self.refused(error))?,
            wall: o.wall,
            soft_ratio: vector(&o.soft_ratio),
            margin: vector(&o.margin),
            reference: vector(&o.reference.component_mul(&shrunk)),
            velocity: vector(&self.pose.velocity),
            spin: square(&spin),
            growth: S::from_f64(self.growth),
        })
    }

    /// The core's obstacle.
    ///
    /// # Errors
    /// It has left the range of +-1000 m.
    pub fn to_core<S: Scalar, const D: usize>(&self) -> Result<Obstacle<S, D>, ConvertError> {
        Obstacle::new(self.spec()?).map_err(|error| self.refused(error))
    }

    fn refused(&self, error: ObstacleError) -> ConvertError {
        ConvertError::Obstacle { name: self.obstacle.name.clone(), error }
    }
}

/// Is a point one the core takes?
pub(super) fn in_range(point: &Vector3<f64>) -> bool {
    point.iter().all(|x| x.abs() <= RANGE)
}
