//! Skills.

use super::{finite, flat, framed, padded, round, vector, zero_in_the_plane};
use crate::message::{DeviceError, Field};
use crate::model::{self, Model};
use heapless::Vec;
use pliant_core::ds::{CertificateError, ModelError, ModelField};
use pliant_core::{Component, LpvDs, Matrix, Motion, Scalar};

/// A motion that was checked and, where it is learnt, certified, from an uploaded [`Model`].
///
/// ```
/// use pliant_protocol::convert::motion;
/// use pliant_protocol::message::{DeviceError, Field};
/// use pliant_protocol::model::{Model, Motion};
///
/// let linear = |gain| Model { dimension: 2, motion: Motion::Linear { attractor: [0.0; 3], gain } };
/// assert!(motion::<2>(&linear(1.0)).is_ok());
/// assert_eq!(motion::<3>(&linear(1.0)), Err(DeviceError::Dimension));
/// assert_eq!(motion::<2>(&linear(-1.0)), Err(DeviceError::OutOfRange(Field::LinearGain)));
/// ```
///
/// # Errors
///
/// A model of another dimension, a number that is not finite or out of the range that [`ModelField`] states, or a
/// certificate that does not hold.
pub fn motion<const D: usize>(model: &Model) -> Result<Motion<f32, D>, DeviceError> {
    if usize::from(model.dimension) != D {
        return Err(DeviceError::Dimension);
    }
    match &model.motion {
        model::Motion::Linear { attractor, gain } => {
            finite(attractor, Field::Attractor)?;
            finite(&[*gain], Field::LinearGain)?;
            flat::<D>(attractor)?;
            Ok(Motion::linear(vector(attractor), *gain)?)
        }
        model::Motion::Lpv { attractor, lyapunov, components } => {
            finite(attractor, Field::Attractor)?;
            finite(lyapunov, Field::Lyapunov)?;
            flat::<D>(attractor)?;
            let [p11, p12, p13, p22, p23, p33] = *lyapunov;
            zero_in_the_plane::<D>([p13, p23, p33])?;
            let p = square([p11, p12, p13, p12, p22, p23, p13, p23, p33]);
            let mut checked: Vec<_, { model::COMPONENTS_MAX }> = Vec::new();
            for wire in components {
                // As many as there can be come in, so there is room for each.
                let _ = checked.push(component(wire)?);
            }
            let lpv = LpvDs::new(vector(attractor), p, &checked)?;
            Ok(Motion::Lpv(lpv.certify()?))
        }
    }
}

fn component<const D: usize>(wire: &model::Component) -> Result<Component<f32, D>, DeviceError> {
    finite(&[wire.log_weight], Field::Prior)?;
    finite(&wire.mean, Field::Mean)?;
    finite(&wire.whitening, Field::Whitening)?;
    finite(&wire.a, Field::Matrix)?;
    flat::<D>(&wire.mean)?;
    let [w11, w21, w22, w31, w32, w33] = wire.whitening;
    let [_, _, a13, _, _, a23, a31, a32, a33] = wire.a;
    zero_in_the_plane::<D>([w31, w32, w33, a13, a23, a31, a32, a33])?;
    Ok(Component {
        log_weight: wire.log_weight,
        mean: vector(&wire.mean),
        whitening: square([w11, 0.0, 0.0, w21, w22, 0.0, w31, w32, w33]),
        a: square(wire.a),
    })
}

/// The upper left D x D part of a 3 x 3 matrix that is given row by row.
fn square<const D: usize>(rows: [f32; 9]) -> Matrix<f32, D> {
    super::corner(&Matrix::<f32, 3>::from_row_slice(&rows))
}

impl From<ModelError> for DeviceError {
    fn from(error: ModelError) -> Self {
        Self::OutOfRange(match error.field {
            ModelField::Attractor => Field::Attractor,
            ModelField::Gain => Field::LinearGain,
            ModelField::Lyapunov => Field::Lyapunov,
            ModelField::Components => Field::Components,
            ModelField::Weight => Field::Prior,
            ModelField::Mean => Field::Mean,
            ModelField::Whitening => Field::Whitening,
            ModelField::A => Field::Matrix,
        })
    }
}

impl From<CertificateError> for DeviceError {
    fn from(error: CertificateError) -> Self {
        let component = match error {
            CertificateError::Lyapunov => None,
            // Far fewer than 255 fit a model.
            CertificateError::Component(k) => Some(u8::try_from(k).unwrap_or(u8::MAX)),
        };
        Self::Certificate { component }
    }
}

/// A skill of two or three dimensions, ready to upload.
impl<S: Scalar, const D: usize> From<&LpvDs<S, D>> for Model {
    fn from(core: &LpvDs<S, D>) -> Self {
        let p = framed(core.lyapunov());
        let motion = model::Motion::Lpv {
            attractor: padded(core.attractor()),
            lyapunov: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| round(p[at])),
            components: core.components().iter().map(model::Component::from).collect(),
        };
        Self { dimension: D as u8, motion }
    }
}

impl<S: Scalar, const D: usize> From<&Component<S, D>> for model::Component {
    fn from(core: &Component<S, D>) -> Self {
        let w = framed(&core.whitening);
        let a = framed(&core.a);
        Self {
            log_weight: round(core.log_weight),
            mean: padded(&core.mean),
            whitening: [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)].map(|at| round(w[at])),
            a: [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1), (2, 2)].map(|at| round(a[at])),
        }
    }
}
