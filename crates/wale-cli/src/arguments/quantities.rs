//! Quantities with their units, as arguments.

use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as PlainError, StrDeserializer};
use wale::scene::units::{Bounds, Dimension, Positive, Quantity};

/// A quantity with its unit, in SI.
pub(super) fn quantity<D: Dimension, B: Bounds>(text: &str) -> Result<f64, String> {
    let source: StrDeserializer<'_, PlainError> = text.into_deserializer();
    // What scene files add on a line of its own stands after a colon here.
    Quantity::<D, B>::deserialize(source).map(Quantity::si).map_err(|error| error.to_string().replace('\n', ": "))
}

/// One that is more than nothing.
pub(super) fn positive<D: Dimension>(text: &str) -> Result<f64, String> {
    quantity::<D, Positive>(text)
}
