//! The nominal motion, section 1.

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{matrix, vector};
use super::scene::{OracleComponent, OracleDrift, OracleMotion};

/// The nominal motion at a position.
pub(super) struct Nominal {
    /// f.
    pub(super) velocity: DVector<f64>,
    /// f less the velocity of the attractor.
    pub(super) relative: DVector<f64>,
    /// The weights of the mixture; empty for a linear motion.
    pub(super) mixture: Vec<f64>,
}

/// f(x, t), wherever the attractor has gone.
pub(super) fn carried(
    motion: &OracleMotion,
    drift: Option<&OracleDrift>,
    x: &DVector<f64>,
) -> Result<Nominal, OracleError> {
    let Some(drift) = drift else {
        let (velocity, mixture) = nominal(motion, x)?;
        return Ok(Nominal { relative: velocity.clone(), velocity, mixture });
    };
    let d = x.len();
    let learnt = x - vector(&drift.displacement, d, "displacement")?;
    let (relative, mixture) = nominal(motion, &learnt)?;
    Ok(Nominal { velocity: &relative + vector(&drift.velocity, d, "velocity of the attractor")?, relative, mixture })
}

/// f0(x), and the weights of the mixture.
fn nominal(motion: &OracleMotion, x: &DVector<f64>) -> Result<(DVector<f64>, Vec<f64>), OracleError> {
    let d = x.len();
    let offset = x - vector(motion.attractor(), d, "attractor")?;
    match motion {
        OracleMotion::Linear { gain, .. } => {
            if !gain.is_finite() {
                return Err(OracleError::Value("gain of the motion"));
            }
            Ok((offset * -*gain, Vec::new()))
        }
        OracleMotion::Lpv { components, .. } => {
            let weights = mixture(components, x)?;
            let mut f = DVector::zeros(d);
            for (component, weight) in components.iter().zip(&weights) {
                f += matrix(&component.a, d, "A of a component")? * &offset * *weight;
            }
            Ok((f, weights))
        }
    }
}

/// A component whose logarithm is farther than this below the largest counts nothing.
const NOTHING: f64 = 40.0;

/// gamma_k = 1 / sum_j exp(l_j - l_k): every weight by its own ratios, so no common factor can be 0 or infinite. Over those that count; on which side
/// of the edge rounding puts one moves f by no more than exp(-40) = 4e-18 of what the component alone would have.
fn mixture(components: &[OracleComponent], x: &DVector<f64>) -> Result<Vec<f64>, OracleError> {
    if components.is_empty() {
        return Err(OracleError::Value("components"));
    }
    let logs = components.iter().map(|component| log_density(component, x)).collect::<Result<Vec<f64>, _>>()?;
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let counts = |log: &f64| largest - log <= NOTHING;
    let weight = |own: &f64| 1.0 / logs.iter().filter(|log| counts(log)).map(|other| (other - own).exp()).sum::<f64>();
    Ok(logs.iter().map(|own| if counts(own) { weight(own) } else { 0.0 }).collect())
}

fn log_density(component: &OracleComponent, x: &DVector<f64>) -> Result<f64, OracleError> {
    let d = x.len();
    if !(component.prior.is_finite() && component.prior > 0.0) {
        return Err(OracleError::Value("prior"));
    }
    let covariance = matrix(&component.covariance, d, "covariance")?;
    let determinant = covariance.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return Err(OracleError::Singular("covariance"));
    }
    let inverse = covariance.try_inverse().ok_or(OracleError::Singular("covariance"))?;
    let offset = x - vector(&component.mean, d, "mean")?;
    let mahalanobis = offset.dot(&(inverse * &offset));
    Ok(component.prior.ln() - 0.5 * determinant.ln() - 0.5 * mahalanobis)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn component(prior: f64, mean: [f64; 2], variance: f64, rate: f64) -> OracleComponent {
        OracleComponent {
            prior,
            mean: mean.to_vec(),
            covariance: vec![vec![variance, 0.0], vec![0.0, variance]],
            a: vec![vec![-rate, 0.0], vec![0.0, -rate]],
        }
    }

    fn lpv(components: Vec<OracleComponent>) -> OracleMotion {
        OracleMotion::Lpv { attractor: vec![0.0, 0.0], lyapunov: vec![vec![1.0, 0.0], vec![0.0, 1.0]], components }
    }

    fn at(motion: &OracleMotion, x: [f64; 2]) -> (DVector<f64>, Vec<f64>) {
        nominal(motion, &DVector::from_column_slice(&x)).unwrap()
    }

    #[test]
    fn a_linear_motion_points_at_its_attractor() {
        let motion = OracleMotion::Linear { attractor: vec![1.0, -1.0], gain: 0.5 };
        let (f, weights) = at(&motion, [3.0, 0.0]);
        assert_eq!(f.as_slice(), &[-1.0, -0.5]);
        assert!(weights.is_empty());
    }

    #[test]
    fn the_weights_by_hand() {
        // Same place, variances 1 and 4 in the plane: densities as 1 to 1/4, priors as 1 to 2, so 2/3 and 1/3.
        let motion = lpv(vec![component(1.0, [0.5, 0.5], 1.0, 1.0), component(2.0, [0.5, 0.5], 4.0, 4.0)]);
        let (f, weights) = at(&motion, [0.5, 0.5]);
        assert!((weights[0] - 2.0 / 3.0).abs() < 1e-15 && (weights[1] - 1.0 / 3.0).abs() < 1e-15);
        assert!((f[0] + 0.5 * (2.0 / 3.0 + 4.0 / 3.0)).abs() < 1e-15);
        // At one standard deviation the first falls by exp(-1/2), the second by exp(-1/8).
        let (_, weights) = at(&motion, [1.5, 0.5]);
        let ratio = 2.0 * (-0.5_f64 + 0.125).exp();
        assert!((weights[0] / weights[1] - ratio).abs() < 1e-14);
    }

    #[test]
    fn the_weights_sum_to_one_far_from_the_data() {
        let motion = lpv(vec![
            component(0.3, [0.0, 0.0], 0.01, 1.0),
            component(0.3, [0.1, 0.0], 0.01, 2.0),
            component(0.4, [0.0, 0.1], 0.02, 3.0),
        ]);
        for x in [[0.0, 0.0], [0.05, 0.05], [30.0, -20.0], [-1000.0, 1000.0]] {
            let (f, weights) = at(&motion, x);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{weights:?}");
            assert!(f.iter().all(|c| c.is_finite()));
        }
        // The widest one wins far away.
        assert!((at(&motion, [30.0, -20.0]).1[2] - 1.0).abs() < 1e-15);
    }

    /// Two components of variance 1, at 0 and at (9, 0): at (a, 0) their logarithms are 81/2 - 9a apart.
    #[test]
    fn forty_below_the_largest_nothing_counts() {
        let motion = lpv(vec![component(0.5, [0.0, 0.0], 1.0, 1.0), component(0.5, [9.0, 0.0], 1.0, 1e18)]);
        let (f, weights) = at(&motion, [0.05, 0.0]);
        assert_eq!((weights.as_slice(), f.as_slice()), (&[1.0, 0.0][..], &[-0.05, 0.0][..]));
        let (f, weights) = at(&motion, [0.06, 0.0]);
        let tiny = (-40.5_f64 + 0.54).exp();
        assert!((weights[1] / tiny - 1.0).abs() < 1e-12 && (f[0] / (-0.06 * (1.0 + 1e18 * tiny)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_correlated_covariance_by_hand() {
        // Sigma = [[2, 1], [1, 2]]: inverse [[2, -1], [-1, 2]] / 3, determinant 3.
        let tilted = OracleComponent {
            covariance: vec![vec![2.0, 1.0], vec![1.0, 2.0]],
            ..component(0.5, [0.0, 0.0], 1.0, 1.0)
        };
        let log = log_density(&tilted, &DVector::from_column_slice(&[1.0, 2.0])).unwrap();
        // (2 - 2 * 2 + 2 * 4) / 3 = 2
        assert!((log - (0.5_f64.ln() - 0.5 * 3.0_f64.ln() - 1.0)).abs() < 1e-14);
    }

    #[test]
    fn a_flat_covariance_is_refused() {
        let mut flat = component(1.0, [0.0, 0.0], 1.0, 1.0);
        flat.covariance = vec![vec![1.0, 1.0], vec![1.0, 1.0]];
        let refused = nominal(&lpv(vec![flat]), &DVector::from_column_slice(&[1.0, 1.0]));
        assert_eq!(refused.err(), Some(OracleError::Singular("covariance")));
    }

    #[test]
    fn a_moving_attractor_carries_the_motion() {
        let x = DVector::from_column_slice(&[0.4, -0.1]);
        let motion = lpv(vec![component(0.5, [0.1, 0.0], 0.2, 1.0), component(0.5, [0.6, 0.3], 0.1, 2.0)]);
        let drift = OracleDrift { displacement: vec![0.3, 0.2], velocity: vec![-1.0, 0.5] };
        let seen = carried(&motion, Some(&drift), &x).unwrap();
        let there = carried(&motion, None, &DVector::from_column_slice(&[0.4 - 0.3, -0.1 - 0.2])).unwrap();
        assert_eq!(seen.relative, there.velocity);
        assert_eq!(seen.mixture, there.mixture);
        assert!((seen.velocity - there.velocity - DVector::from_column_slice(&[-1.0, 0.5])).amax() < 1e-15);
    }
}
