//! The scene's words for a yarn.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::dimensions::{
    BendingStiffness, Density, Force, Length, LinearDensity, Pressure, Rate, Ratio, Time, Twist,
};
use crate::scene::units::{Fraction, NotNegative, Positive, Quantity};

/// Yarns that wale knows, each with a fabric of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PresetName {
    /// Ne 30 cotton, as in T-shirts.
    FineCottonJersey,
    /// Worsted-weight wool, as in hand-knit sweaters.
    WorstedWool,
    /// Thick, soft hand-knit acrylic.
    ThickAcrylic,
}

/// A yarn: a preset, or numbers of your own, or both, yours before the preset's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Yarn")]
pub struct YarnText {
    /// A yarn that wale knows; worsted-wool if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<PresetName>,
    /// The card of a fabric that `wale fit` has fitted, in place of a preset: the numbers of its yarns and contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub card: Option<String>,
    /// What reports call one of the other yarns; the name that the chart or the weave gives it if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Of one of the other yarns: the names of those that run together as this one, as in plating or where two are held
    /// together; the first is the one that is seen. Its numbers follow from theirs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub together: Option<Vec<String>>,
    /// Mass per length of the whole yarn, or its count: tex, denier, Nm, Ne.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear_density: Option<Quantity<LinearDensity, Positive>>,
    /// Diameter in the fabric. In its place: packing and fibre_density.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diameter: Option<Quantity<Length, Positive>>,
    /// Share of the yarn's cross-section that is fibre, from which the diameter follows: 0.5 to 0.6 for fine cotton,
    /// 0.2 to 0.3 for soft wool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packing: Option<Quantity<Ratio, Fraction>>,
    /// Density of the fibre: cotton 1520, wool 1310, acrylic 1180 kg/m^3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibre_density: Option<Quantity<Density, Positive>>,
    /// Stretch stiffness EA. In its place: elastic_modulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch_stiffness: Option<Quantity<Force, Positive>>,
    /// Modulus Y of the yarn taken as solid; the stretch stiffness is Y π R².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic_modulus: Option<Quantity<Pressure, Positive>>,
    /// Bending stiffness EI. In its place: bending_modulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending_stiffness: Option<Quantity<BendingStiffness, Positive>>,
    /// B of the first paper, in N: the bending stiffness is B π R².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending_modulus: Option<Quantity<Force, Positive>>,
    /// Coefficient of friction between yarns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Quantity<Ratio, NotNegative>>,
    /// Damping of all motion, as of thick air.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_damping: Option<Quantity<Rate, NotNegative>>,
    /// Damping of bending and wrapping; rigid motion is free of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_damping: Option<Quantity<Time, NotNegative>>,
    /// Whether the ends of a knitted yarn are loose, so that it can be pulled out; tied to the fabric if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loose_ends: Option<bool>,
    /// Colour as "#rrggbb".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<Color>,
    /// Plies drawn in pictures, 1 to 12.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plies: Option<u32>,
    /// Ply twist drawn in pictures; negative turns the other way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub twist: Option<Quantity<Twist>>,
}

/// An sRGB colour, written `"#rrggbb"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub [u8; 3]);

impl Serialize for Color {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [r, g, b] = self.0;
        serializer.serialize_str(&format!("#{r:02x}{g:02x}{b:02x}"))
    }
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = Color;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a colour such as \"#8a3324\"")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Color, E> {
                let no_color = || E::custom("this is no colour\nwrite six hexadecimal digits, as in \"#8a3324\"");
                crate::pattern::image::color(text).map(Color).ok_or_else(no_color)
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for Color {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Color".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })
    }
}
