//! How something moves over scene time.

use nalgebra::Vector3;

/// Straight on, or along a path.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Track {
    Straight {
        from: Vector3<f64>,
        velocity: Vector3<f64>,
    },
    /// Time and place, by increasing time, at least one.
    Path(Vec<(f64, Vector3<f64>)>),
}

impl Track {
    /// Place (m) and velocity (m/s) at scene time `t`, s. A path is followed in straight lines; before its first point and after its last
    /// there is rest.
    pub fn at(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Self::Straight { from, velocity } => (from + velocity * t, *velocity),
            Self::Path(points) => along(points, t),
        }
    }

    /// Does it ever move?
    pub fn moves(&self) -> bool {
        match self {
            Self::Straight { velocity, .. } => *velocity != Vector3::zeros(),
            Self::Path(points) => points.windows(2).any(|w| w[0].1 != w[1].1),
        }
    }

    /// When (s) and where (m) something that is there begins, and comes to rest if it ever does: the places that have to be free.
    pub fn rests(&self) -> Vec<(f64, Vector3<f64>)> {
        let begin = (0.0, self.at(0.0).0);
        match self {
            Self::Path(points) if self.moves() => std::iter::once(begin).chain(points.last().copied()).collect(),
            _ => vec![begin],
        }
    }
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
