//! The simplest robot there is.

use nalgebra::Vector3;

/// A point whose velocity follows the command with a first-order lag: v' = (command - v)/lag, x' = v.
#[derive(Clone, Debug)]
pub struct PointRobot {
    /// m
    pub position: Vector3<f64>,
    /// m/s
    pub velocity: Vector3<f64>,
}

impl PointRobot {
    /// Time constant of the lag, s: that of a well-tuned arm.
    pub const LAG: f64 = 0.01;

    /// At rest at `position`.
    pub fn at(position: Vector3<f64>) -> Self {
        Self { position, velocity: Vector3::zeros() }
    }

    /// `dt` seconds under a constant command (m/s), integrated exactly.
    pub fn step(&mut self, command: &Vector3<f64>, dt: f64) {
        let decay = (-dt / Self::LAG).exp();
        let off = self.velocity - command;
        self.position += command * dt + off * (Self::LAG * (1.0 - decay));
        self.velocity = command + off * decay;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_small_steps_are_one_large() {
        let command = Vector3::new(0.2, -0.1, 0.0);
        let (mut one, mut many) = (PointRobot::at(Vector3::zeros()), PointRobot::at(Vector3::zeros()));
        one.step(&command, 0.02);
        for _ in 0..20 {
            many.step(&command, 0.001);
        }
        assert!((one.position - many.position).norm() < 1e-15 && (one.velocity - many.velocity).norm() < 1e-15);
        assert!((one.velocity - command * (1.0 - (-2.0_f64).exp())).norm() < 1e-15);
    }
}
