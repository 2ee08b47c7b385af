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
    /// Limits of the velocity.
    pub limits: OracleLimits,
    /// Raw points.
    pub scan: Option<OracleScan>,
    /// How far the attractor is from where the motion has it, and how it moves.
    pub drift: Option<OracleDrift>,
    /// The approach alpha of the guard; none for no guard. The evaluation ends before the guard.
    pub guard: Option<f64>,
}

/// Raw points, each with the same radius.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleScan {
    /// p_i, m.
    pub points: Vec<Vec<f64>>,
    /// R, m.
    pub radius: f64,
}

/// A moving attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleDrift {
    /// d, from where the motion was learnt, m.
    pub displacement: Vec<f64>,
    /// v, m/s.
    pub velocity: Vec<f64>,
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
    /// The core without its margin.
    pub shape: OracleShape,
    /// Whether the shape is the free space instead.
    pub wall: bool,
    /// rho, soft over hard semi-extents, each at least 1.
    pub soft_ratio: Vec<f64>,
    /// eta, the safety factors, each at least 1.
    pub margin: Vec<f64>,
    /// r0 in the obstacle's frame, m.
    pub reference: Vec<f64>,
    /// The reference point of the root of the tree it belongs to, in the obstacle's frame, m.
    pub hub: Option<Vec<f64>>,
    /// v, m/s.
    pub velocity: Vec<f64>,
    /// w.
    pub spin: OracleSpin,
    /// By how much every semi-extent has grown, m.
    pub grown: f64,
    /// The rate of that, m/s.
    pub growth: f64,
    /// By how much the core has come nearer with age, m.
    pub aged: f64,
    /// The rate of that, m/s.
    pub ageing: f64,
}

/// Shape of a core, in the obstacle's frame.
#[derive(Debug, Clone, PartialEq)]
pub enum OracleShape {
    /// sum |q_i / a_i|^2p <= 1.
    Ellipsoid {
        /// a, m.
        axes: Vec<f64>,
        /// p, 1 to 8.
        curvature: u8,
    },
    /// A box with rounded edges.
    Box {
        /// h, m.
        half: Vec<f64>,
        /// R, above 0 and at most the least h, m.
        rounding: f64,
    },
    /// A cylinder about the third axis with rounded rims. Only in 3-D.
    Cylinder {
        /// P, m.
        radius: f64,
        /// H, m.
        half_length: f64,
        /// R, above 0 and at most P and H, m.
        rounding: f64,
    },
    /// Everything within the radius of a segment of the third axis. Only in 3-D.
    Capsule {
        /// P, m.
        radius: f64,
        /// H, of the segment, m.
        half_length: f64,
    },
    /// Counter-clockwise, star-shaped about the origin. Only in 2-D.
    Polygon {
        /// v, m.
        vertices: Vec<[f64; 2]>,
    },
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

impl OracleShape {
    /// e, the semi-extents along the axes of the frame, m.
    pub fn semi_extents(&self) -> Vec<f64> {
        match self {
            Self::Ellipsoid { axes, .. } => axes.clone(),
            Self::Box { half, .. } => half.clone(),
            Self::Cylinder { radius, half_length, .. } => vec![*radius, *radius, *half_length],
            Self::Capsule { radius, half_length } => vec![*radius, *radius, half_length + radius],
            Self::Polygon { vertices } => {
                (0..2).map(|i| vertices.iter().map(|v| v[i].abs()).fold(0.0, f64::max)).collect()
            }
        }
    }
}

impl OracleShape {
    /// e as growth and ageing count it, m: the semi-extents, but of a polygon along both axes the distance of its nearest edge.
    pub fn growing_extents(&self) -> Vec<f64> {
        let Self::Polygon { vertices } = self else {
            return self.semi_extents();
        };
        let next = vertices.iter().cycle().skip(1);
        let nearest = vertices.iter().zip(next).map(|(v, w)| to_edge(v, w)).fold(f64::INFINITY, f64::min);
        vec![nearest; 2]
    }
}

/// Distance of the origin from the line of the edge between two corners, m.
fn to_edge(v: &[f64; 2], w: &[f64; 2]) -> f64 {
    (v[0] * w[1] - v[1] * w[0]) / f64::hypot(w[0] - v[0], w[1] - v[1])
}

impl OracleScene {
    /// The scene at its first moment: nothing has grown or aged, and the attractor is where it was learnt. This is
    /// what a scene file can say.
    pub fn at_first(&self) -> Self {
        let mut first = self.clone();
        for obstacle in &mut first.obstacles {
            (obstacle.grown, obstacle.aged, obstacle.ageing) = (0.0, 0.0, 0.0);
        }
        if let Some(drift) = &mut first.drift {
            drift.displacement.iter_mut().for_each(|d| *d = 0.0);
        }
        first
    }
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
        Self::of(center, OracleShape::Ellipsoid { axes: axes.to_vec(), curvature: 1 })
    }

    /// An unrotated core of any shape at rest, rigid, without margin, its reference point at its centre.
    pub fn of(center: &[f64], shape: OracleShape) -> Self {
        let d = center.len();
        Self {
            center: center.to_vec(),
            rotation: OracleRotation::Angle(0.0),
            shape,
            wall: false,
            soft_ratio: vec![1.0; d],
            margin: vec![1.0; d],
            reference: vec![0.0; d],
            hub: None,
            velocity: vec![0.0; d],
            spin: OracleSpin::Planar(0.0),
            grown: 0.0,
            growth: 0.0,
            aged: 0.0,
            ageing: 0.0,
        }
    }

    /// The same ellipsoid with another curvature; other shapes have none to change.
    pub fn curved(mut self, p: u8) -> Self {
        if let OracleShape::Ellipsoid { curvature, .. } = &mut self.shape {
            *curvature = p;
        }
        self
    }

    /// The same shape as free space.
    pub fn inside_out(mut self) -> Self {
        self.wall = true;
        self
    }

    /// The same obstacle with all its soft ratios set.
    pub fn soft(mut self, ratio: f64) -> Self {
        self.soft_ratio = vec![ratio; self.center.len()];
        self
    }
}
