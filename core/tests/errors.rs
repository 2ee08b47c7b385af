//! What the errors say: each variant something, no two the same, with the numbers that are checked.

use std::collections::BTreeSet;
use std::error::Error;

use pliant_core::ds::{CertificateError, MAX_COMPONENTS, ModelError, ModelField};
use pliant_core::obstacle::{MAX_RATIO, MAX_SPEED};
use pliant_core::passive::PassiveError;
use pliant_core::scan::MAX_POINTS;
use pliant_core::shape::MAX_CURVATURE;
use pliant_core::{ObstacleError, RANGE, ScanError, SettingsError, TableFull};

/// Every variant of an enum; the match does not compile where one is missing.
macro_rules! every {
    ($name:ident: $($variant:ident $(($value:expr))?),+) => {{
        let all = vec![$($name::$variant $(($value))?),+];
        for one in &all {
            match one {
                $(every!(@pattern $name $variant $($value)?) => {})+
            }
        }
        all
    }};
    (@pattern $name:ident $variant:ident) => { $name::$variant };
    (@pattern $name:ident $variant:ident $value:expr) => { $name::$variant(_) };
}

/// Their messages, once it is seen that each says something else in one plain sentence.
fn messages<E: Error>(errors: &[E]) -> Vec<String> {
    let messages: Vec<_> = errors.iter().map(|error| error.to_string()).collect();
    let distinct: BTreeSet<_> = messages.iter().collect();
    assert_eq!(distinct.len(), messages.len(), "{messages:#?}");
    for message in &messages {
        assert!(message.len() > 15 && message.len() < 120, "{message}");
        assert!(message.is_ascii() && message == message.trim() && !message.ends_with('.'), "{message}");
    }
    messages
}

fn names(error: impl Error, words: &[&str]) {
    let message = error.to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message}: {words:?}");
}

#[test]
fn every_variant_says_something_of_its_own() {
    messages(
        &every!(ObstacleError: Center, Rotation, Dimension, Axes, Curvature, Rounding, Corners, Vertices, SoftRatio,
        Margin, Reference, Velocity, Spin, Growth),
    );
    messages(&every!(SettingsError: Gain, Steering, Speed, Acceleration, Deceleration, Ageing, Guard));
    messages(&every!(PassiveError: LambdaAlong, LambdaAcross, Blend, Share, Energy, Capacity, RobotVelocity, Wanted,
        TimeStep, Work));
    messages(&every!(ScanError: Points, Point(3), Radius));
    messages(&every!(CertificateError: Lyapunov, Component(3)));
    messages(&[TableFull]);
    let fields = every!(ModelField: Attractor, Gain, Lyapunov, Components, Weight, Mean, Whitening, A);
    let of_model = |component| fields.iter().map(|&field| ModelError { field, component }).collect::<Vec<_>>();
    let (alone, of_component) = (messages(&of_model(None)), messages(&of_model(Some(3))));
    for (alone, of_component) in alone.iter().zip(&of_component) {
        assert_eq!(*of_component, format!("components[3].{alone}"));
    }
}

#[test]
fn bounds_are_those_that_are_checked() {
    let range = format!("{RANGE} m");
    names(ObstacleError::Center, &["center", &range]);
    names(ObstacleError::Axes, &["0.1 mm", &range]);
    names(ObstacleError::Curvature, &["curvature", &format!("to {MAX_CURVATURE}")]);
    names(ObstacleError::SoftRatio, &["soft_ratio", &format!("to {MAX_RATIO}")]);
    names(ObstacleError::Margin, &["margin", &format!("to {MAX_RATIO}")]);
    names(ObstacleError::Velocity, &["velocity", &format!("{MAX_SPEED} m/s")]);
    names(ObstacleError::Spin, &["spin", &format!("{MAX_SPEED} rad/s")]);
    names(ObstacleError::Growth, &["growth", &format!("{MAX_SPEED} m/s")]);
    names(ScanError::Points, &[&MAX_POINTS.to_string()]);
    names(ScanError::Point(7), &["points[7]", &range]);
    names(ModelError { field: ModelField::Components, component: None }, &[&format!("to {MAX_COMPONENTS}")]);
    names(ModelError { field: ModelField::Mean, component: Some(2) }, &["components[2].mean", &range]);
    names(CertificateError::Component(2), &["components[2].a"]);
}
