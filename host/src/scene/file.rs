//! The scene file as it is written: TOML tables with the place of every value, nothing checked yet.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, SeqAccess, Visitor};
use toml::Spanned;

/// A number and where it stands.
pub(super) type Number = Spanned<f64>;
/// An array of numbers and where it and each of them stand.
pub(super) type Numbers = Spanned<Vec<Number>>;
/// An array of such arrays.
pub(super) type Rows = Spanned<Vec<Numbers>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "the tables of a scene")]
pub(super) struct SceneFile {
    pub ds: Spanned<DsFile>,
    #[serde(default)]
    pub modulation: ModulationFile,
    #[serde(default)]
    pub limits: LimitsFile,
    #[serde(default)]
    pub ageing: AgeingFile,
    #[serde(default)]
    pub guard: GuardFile,
    #[serde(default)]
    pub goal: GoalFile,
    pub attractor: Option<Spanned<AttractorFile>>,
    pub scan: Option<ScanFile>,
    #[serde(default)]
    pub start: Vec<Spanned<StartFile>>,
    #[serde(default)]
    pub obstacle: Vec<Spanned<ObstacleFile>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct DsFile {
    pub model: Option<Spanned<String>>,
    pub linear: Option<Spanned<LinearFile>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct LinearFile {
    pub attractor: Numbers,
    pub gain: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ModulationFile {
    pub method: Option<MethodFile>,
    pub c: Option<Number>,
    pub steering: Option<SteeringFile>,
    pub beta: Option<Number>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case", expecting = "a method's name")]
pub(super) enum MethodFile {
    Deformable,
    Original,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", expecting = "a steering's name or { fixed = rad }")]
pub(super) enum SteeringFile {
    WithFlow,
    Fixed(Number),
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct LimitsFile {
    pub speed: Option<Number>,
    pub acceleration: Option<Number>,
    pub deceleration: Option<Number>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct AgeingFile {
    pub time_to_live: Option<Number>,
    pub growth: Option<Number>,
    pub hold: Option<Number>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct GuardFile {
    pub enabled: Option<Spanned<bool>>,
    pub approach: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct AttractorFile {
    pub velocity: Option<Numbers>,
    pub path: Option<Rows>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ScanFile {
    pub points: Rows,
    pub radius: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct GoalFile {
    pub tolerance: Option<Number>,
    pub timeout: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct StartFile {
    pub position: Numbers,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ObstacleFile {
    pub name: Spanned<String>,
    pub shape: Spanned<ShapeFile>,
    pub wall: Option<bool>,
    pub center: Option<Numbers>,
    pub angle: Option<Number>,
    pub rotation: Option<Numbers>,
    pub stiffness: Option<Number>,
    pub soft: Option<Numbers>,
    pub layer: Option<Number>,
    pub curvature: Option<Spanned<i64>>,
    pub margin: Option<Numbers>,
    pub velocity: Option<Numbers>,
    pub angular_velocity: Option<Spanned<Turning>>,
    pub growth: Option<Number>,
    pub reference: Option<Numbers>,
    pub path: Option<Rows>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a shape, such as { ellipsoid = [0.04, 0.04] }")]
pub(super) struct ShapeFile {
    pub ellipsoid: Option<Numbers>,
    #[serde(rename = "box")]
    pub cuboid: Option<Numbers>,
    pub cylinder: Option<Numbers>,
    pub capsule: Option<Numbers>,
    pub polygon: Option<Rows>,
    pub rounding: Option<Number>,
}

/// An angular velocity: one number in the plane, three in space.
pub(super) enum Turning {
    Planar(f64),
    Spatial(Vec<f64>),
}

impl<'de> Deserialize<'de> for Turning {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Turning;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number (2-D) or an array of three numbers (3-D)")
            }
            fn visit_f64<E>(self, rate: f64) -> Result<Turning, E> {
                Ok(Turning::Planar(rate))
            }
            fn visit_i64<E>(self, rate: i64) -> Result<Turning, E> {
                Ok(Turning::Planar(rate as f64))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Turning, A::Error> {
                let mut rates = Vec::new();
                while let Some(rate) = seq.next_element()? {
                    rates.push(rate);
                }
                Ok(Turning::Spatial(rates))
            }
        }
        deserializer.deserialize_any(Either)
    }
}
