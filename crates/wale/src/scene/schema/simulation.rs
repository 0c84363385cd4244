//! The scene's words for time, forces from outside, the solver, and what is written.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use crate::model::{ExportFormat, LinearSolver, Pictures};
use crate::scene::dimensions::{Acceleration, Drag, Rate, Ratio, Time};
use crate::scene::units::{Any, NotNegative, Positive, Quantity};

/// Time, forces from outside, and the solver.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Simulation")]
pub struct SimulationText {
    /// Simulated time; 1 s if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<Quantity<Time, NotNegative>>,
    /// Frames written per simulated second; 30 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_rate: Option<Quantity<Rate, Positive>>,
    /// Gravity: its size, downwards along −z, or a vector; "9.80665 m/s^2" if left out, 0 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// Drag of still air: force per length of yarn and speed; none if left out. Air gives about 1e-3 Pa s at 1 m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air_drag: Option<Quantity<Drag, NotNegative>>,
    /// Whether the fabric is relaxed before time starts, without friction, gravity, obstacles and grips; false if left
    /// out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relax_first: Option<bool>,
    /// Whether a small patch is relaxed first and its loop shapes become those of the whole fabric's layout;
    /// true if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_shape_compensation: Option<bool>,
    /// Whether yarns rub on each other; true if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<bool>,
    /// Whether parts of the fabric that are not knitted together keep out of each other; true if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_contact: Option<bool>,
    /// Whether neighbouring strands of a knit that share no contact keep out of each other too, as in lace; a step then takes two
    /// to three times as long. false if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strand_contact: Option<bool>,
    /// Time in which yarn comes from a thousandth of its stretch stiffness to all of it, so that a layout in which it is stretched
    /// draws together and does not snap; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub soft_start: Option<Quantity<Time, NotNegative>>,
    /// Seed of the small disturbance of the initial layout; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// Longest time step; 5 ms if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_step: Option<Quantity<Time, Positive>>,
    /// Shortest time step, below which the run ends as not converged; 1 µs if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smallest_step: Option<Quantity<Time, Positive>>,
    /// Most Newton iterations of a step; 15 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton_iterations: Option<u32>,
    /// Newton stops when nodes are expected to move no further, root mean square, as a part of the yarn radius; 0.005 if
    /// left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton_tolerance: Option<Quantity<Ratio, Positive>>,
    /// Linear solver: "automatic", "cholesky" or "conjugate_gradient"; automatic if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear_solver: Option<LinearSolver>,
    /// Relative residual at which conjugate gradients stop; 0.1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear_tolerance: Option<Quantity<Ratio, Positive>>,
    /// Threads; all processors if left out. Results do not depend on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threads: Option<u32>,
}

/// What is written.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Output")]
pub struct OutputText {
    /// Pictures: "none", "last" frame or "all"; last if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pictures: Option<Pictures>,
    /// Whether a page to turn in the hand is written; true if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<bool>,
    /// Formats to export to: "usd", "vtk", "bcc", "obj", "ply", "csv"; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exports: Option<Vec<ExportFormat>>,
    /// Simulated time between checkpoints; 0.1 s if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint_every: Option<Quantity<Time, Positive>>,
}

/// Acceleration of gravity: a size (downwards) or a vector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gravity(pub [Quantity<Acceleration>; 3]);

impl Gravity {
    fn down<E: de::Error>(size: Quantity<Acceleration, NotNegative>) -> Result<Self, E> {
        let along = |value: f64| Quantity::new(value).map_err(E::custom);
        Ok(Self([along(0.0)?, along(0.0)?, along(if size.si() == 0.0 { 0.0 } else { -size.si() })?]))
    }
}

impl<'de> Deserialize<'de> for Gravity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct GravityVisitor;
        impl<'de> Visitor<'de> for GravityVisitor {
            type Value = Gravity;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an acceleration, for instance \"9.81 m/s^2\", or a vector of three")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Gravity, E> {
                Gravity::down(Quantity::deserialize(de::value::StrDeserializer::new(text))?)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Gravity, E> {
                Gravity::down(Quantity::new(value).map_err(E::custom)?)
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Gravity, E> {
                self.visit_f64(value as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Gravity, A::Error> {
                let mut parts = [Quantity::<Acceleration, Any>::new(0.0).map_err(de::Error::custom)?; 3];
                for (i, part) in parts.iter_mut().enumerate() {
                    *part = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(i, &self))?;
                }
                match seq.next_element::<de::IgnoredAny>()? {
                    None => Ok(Gravity(parts)),
                    Some(_) => Err(de::Error::invalid_length(4, &self)),
                }
            }
        }
        deserializer.deserialize_any(GravityVisitor)
    }
}

impl JsonSchema for Gravity {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Gravity".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let size = Quantity::<Acceleration, NotNegative>::json_schema(generator);
        let vector = <[Quantity<Acceleration>; 3]>::json_schema(generator);
        json_schema!({ "anyOf": [size, vector] })
    }
}
