//! What the oracle is asked about: plain data, metres, seconds and radians.

/// Everything that decides a velocity, apart from the position.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleScene {
    /// 2 or 3.
    pub dimension: usize,
    /// The nominal motion.
    pub motion: OracleMotion,
    /// The obstacles, in any number.
    pub obstacles: Vec<OracleObstacle>,
    /// Whether obstacles have a soft layer.
    pub method: OracleMethod,
    /// How the push in a soft layer is directed.
    pub steering: OracleSteering,
    /// The gain c of the adaptive motion, m/s.
    pub gain: f64,
    /// Limits of the last stage.
    pub limits: OracleLimits,
}

/// Whether soft layers count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OracleMethod {
    /// Every soft ratio is taken as 1.
    Original,
    /// Soft ratios as given.
    Deformable,
}

/// The policy of the adaptive motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OracleSteering {
    /// The paper: a fixed angle theta, rad.
    Fixed {
        /// theta, rad.
        angle: f64,
    },
    /// Along the modulated flow.
    WithFlow {
        /// The push is at most beta times the nominal speed.
        beta: f64,
    },
}

/// The last stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleLimits {
    /// Largest speed, m/s; infinity for none.
    pub speed: f64,
    /// Largest acceleration, m/s^2; it needs an [`OracleTick`] to act.
    pub acceleration: Option<f64>,
}

/// The velocity commanded before, for the acceleration limit.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleTick {
    /// The velocity of the tick before, m/s.
    pub previous: Vec<f64>,
    /// Time since then, s.
    pub dt: f64,
}

/// The nominal motion f.
#[derive(Debug, Clone, PartialEq)]
pub enum OracleMotion {
    /// f = -gain (x - attractor).
    Linear {
        /// Where the motion ends, m.
        attractor: Vec<f64>,
        /// 1/s.
        gain: f64,
    },
    /// A mixture of linear systems.
    Lpv {
        /// Where the motion ends, m.
        attractor: Vec<f64>,
        /// P of the certificate, by rows. The evaluation does not use it; whoever loads the model does.
        lyapunov: Vec<Vec<f64>>,
        /// The components.
        components: Vec<OracleComponent>,
    },
}

/// One Gaussian and its linear system. Matrices are lists of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleComponent {
    /// pi, above 0; the priors need not sum to one.
    pub prior: f64,
    /// mu, m.
    pub mean: Vec<f64>,
    /// Sigma, m^2.
    pub covariance: Vec<Vec<f64>>,
    /// A, 1/s.
    pub a: Vec<Vec<f64>>,
}

/// One obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleObstacle {
    /// c, m.
    pub center: Vec<f64>,
    /// Q, from the obstacle's frame to the world.
    pub rotation: OracleRotation,
    /// Hard semi-axes a, m.
    pub axes: Vec<f64>,
    /// rho, soft over hard semi-axes, each at least 1.
    pub soft_ratio: Vec<f64>,
    /// p, 1 to 8.
    pub curvature: u8,
    /// eta, the safety factors, each at least 1.
    pub margin: Vec<f64>,
    /// r0 in the obstacle's frame, m.
    pub reference: Vec<f64>,
    /// v, m/s.
    pub velocity: Vec<f64>,
    /// w.
    pub spin: OracleSpin,
}

/// Rotation of an obstacle's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OracleRotation {
    /// Counter-clockwise, rad; in 3-D about z.
    Angle(f64),
    /// Quaternion w, x, y, z; it is normalised. Only in 3-D.
    Quaternion([f64; 4]),
}

/// Angular velocity of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OracleSpin {
    /// Counter-clockwise in the plane, rad/s; in 3-D about z.
    Planar(f64),
    /// World frame, rad/s. Only in 3-D.
    Spatial([f64; 3]),
}

impl OracleMotion {
    /// Where the motion ends.
    pub fn attractor(&self) -> &[f64] {
        match self {
            Self::Linear { attractor, .. } | Self::Lpv { attractor, .. } => attractor,
        }
    }
}

impl OracleObstacle {
    /// An unrotated ellipse or ellipsoid at rest, rigid, without margin, its reference point at its centre.
    pub fn still(center: &[f64], axes: &[f64]) -> Self {
        let d = center.len();
        Self {
            center: center.to_vec(),
            rotation: OracleRotation::Angle(0.0),
            axes: axes.to_vec(),
            soft_ratio: vec![1.0; d],
            curvature: 1,
            margin: vec![1.0; d],
            reference: vec![0.0; d],
            velocity: vec![0.0; d],
            spin: OracleSpin::Planar(0.0),
        }
    }

    /// The same obstacle with all its soft ratios set.
    pub fn soft(mut self, ratio: f64) -> Self {
        self.soft_ratio = vec![ratio; self.center.len()];
        self
    }
}
