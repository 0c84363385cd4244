//! Quantities with units in text: `"0.5 mm"`, `"Nm 2/28"`, or a bare number in SI units.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, Visitor};
use serde::ser::{Serialize, Serializer};

/// A physical dimension and the units that it may be written in.
pub trait Dimension: Copy + PartialEq + fmt::Debug + 'static {
    /// What it is called in messages, as in "a length".
    const NAME: &'static str;
    /// The SI unit, first of [`Dimension::UNITS`]; empty for a pure number.
    const SI: &'static str;
    /// Units and their size in SI units; spaces and dots in them do not matter, squares are `^2`.
    const UNITS: &'static [(&'static str, f64)];
    /// How a value is written, for messages.
    const EXAMPLE: &'static str;
    /// Largest magnitude that makes sense in a scene, in SI units.
    const LARGEST: f64;

    /// Notations that are not a number with a unit, as yarn counts are. `None` if this is none of them.
    fn other_notation(_text: &str) -> Option<Result<f64, String>> {
        None
    }
}

/// Which values of a dimension a key takes.
pub trait Bounds: Copy + PartialEq + fmt::Debug + 'static {
    /// As in "must be positive"; empty if all are allowed.
    const RULE: &'static str;
    /// Whether a value in SI units is allowed.
    fn allow(value: f64) -> bool;
}

macro_rules! bounds {
    ($(#[$doc:meta])* $name:ident, $rule:literal, $allow:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Debug)]
        pub struct $name;

        impl Bounds for $name {
            const RULE: &'static str = $rule;
            fn allow(value: f64) -> bool {
                let allow: fn(f64) -> bool = $allow;
                allow(value)
            }
        }
    };
}

bounds!(
    /// Every finite value.
    Any, "", |_| true
);
bounds!(
    /// Values above zero.
    Positive, "positive", |value| value > 0.0
);
bounds!(
    /// Zero and above.
    NotNegative, "zero or positive", |value| value >= 0.0
);
bounds!(
    /// Above zero, up to one.
    Fraction, "above 0 and at most 1", |value| value > 0.0 && value <= 1.0
);

/// A value of a dimension, in SI units; always finite and within its bounds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Quantity<D: Dimension, B: Bounds = Any> {
    value: f64,
    kind: PhantomData<(D, B)>,
}

impl<D: Dimension, B: Bounds> Quantity<D, B> {
    /// A value in SI units.
    ///
    /// # Errors
    /// If it is not finite, out of bounds or absurdly large: a sentence that says so and, after a line break, the mend.
    pub fn new(value: f64) -> Result<Self, String> {
        Self::check(value, &with_unit::<D>(value))
    }

    /// The value in SI units.
    #[must_use]
    pub fn si(self) -> f64 {
        self.value
    }

    fn check(value: f64, written: &str) -> Result<Self, String> {
        if value.is_nan() || value.is_infinite() {
            return Err(format!("{} must be a finite number, not {written}\n{}", D::NAME, example::<D>()));
        }
        if !B::allow(value) {
            return Err(format!("{} must be {} here, not {written}", D::NAME, B::RULE));
        }
        if value.abs() > D::LARGEST {
            let largest = with_unit::<D>(D::LARGEST);
            return Err(format!("{written} is absurd: {} in a scene is at most {largest}", D::NAME));
        }
        Ok(Self { value, kind: PhantomData })
    }

    fn from_text(text: &str) -> Result<Self, String> {
        Self::check(parse::<D>(text)?, &shown(text))
    }
}

fn example<D: Dimension>() -> String {
    format!("write for instance {}", D::EXAMPLE)
}

fn with_unit<D: Dimension>(value: f64) -> String {
    if D::SI.is_empty() { format!("{value:?}") } else { format!("{value:?} {}", D::SI) }
}

fn shown(text: &str) -> String {
    format!("\"{}\"", super::error::shortened(text))
}

/// Reads a number and its unit, to SI units.
fn parse<D: Dimension>(text: &str) -> Result<f64, String> {
    if let Some(result) = D::other_notation(text.trim()) {
        return result;
    }
    let text = text.trim();
    let (number, unit) = text.split_at(number_end(text));
    let unit = plain_unit(unit);
    let value: f64 = number
        .replace('−', "-")
        .parse()
        .map_err(|_| format!("{} does not start with a number\n{}", shown(text), example::<D>()))?;
    if unit.is_empty() && !D::SI.is_empty() {
        return Err(format!(
            "{} has no unit\n{}, or a bare number (without quotes) in {}",
            shown(text),
            example::<D>(),
            D::SI
        ));
    }
    match D::UNITS.iter().find(|(name, _)| plain_unit(name) == unit) {
        Some((_, size)) => Ok(value * size),
        None => {
            let units = D::UNITS.iter().map(|(name, _)| *name).filter(|name| !name.is_empty());
            let units = units.collect::<Vec<_>>().join(", ");
            let known = if units.is_empty() { "it has none".to_owned() } else { format!("units are {units}") };
            let unit = super::error::shortened(&unit);
            Err(format!("`{unit}` is no unit of {}; {known}\n{}", D::NAME, example::<D>()))
        }
    }
}

/// Where the number at the start of a text ends.
fn number_end(text: &str) -> usize {
    let mut end = 0;
    let mut rest = text.char_indices().peekable();
    let mut previous = ' ';
    while let Some((at, c)) = rest.next() {
        let next_is = |test: fn(char) -> bool| rest.clone().next().is_some_and(|(_, next)| test(next));
        let number = match c {
            '0'..='9' | '.' => true,
            '+' | '-' | '−' => at == 0 || matches!(previous, 'e' | 'E'),
            // An exponent only where digits follow, or "2 eV" would be one.
            'e' | 'E' => {
                at > 0
                    && (next_is(|n| n.is_ascii_digit())
                        || next_is(|n| n == '+' || n == '-')
                            && text[at + 2..].starts_with(|n: char| n.is_ascii_digit()))
            }
            _ => false,
        };
        if !number {
            break;
        }
        previous = c;
        end = at + c.len_utf8();
    }
    end
}

/// Units without spaces and dots, with `^2` for squares and `u` for micro.
fn plain_unit(unit: &str) -> String {
    let mut plain = String::new();
    for c in unit.chars() {
        match c {
            ' ' | '\t' | '·' | '*' | '⋅' | '.' => {}
            '²' => plain.push_str("^2"),
            '³' => plain.push_str("^3"),
            'µ' | 'μ' => plain.push('u'),
            '°' => plain.push_str("deg"),
            c => plain.push(c),
        }
    }
    plain
}

struct QuantityVisitor<D, B>(PhantomData<(D, B)>);

impl<D: Dimension, B: Bounds> Visitor<'_> for QuantityVisitor<D, B> {
    type Value = Quantity<D, B>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, for instance {}", D::NAME, D::EXAMPLE)
    }
    fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
        Quantity::from_text(text).map_err(E::custom)
    }
    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Quantity::new(value).map_err(E::custom)
    }
    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        Quantity::new(value as f64).map_err(E::custom)
    }
    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
        Quantity::new(value as f64).map_err(E::custom)
    }
}

impl<'de, D: Dimension, B: Bounds> Deserialize<'de> for Quantity<D, B> {
    fn deserialize<T: Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        deserializer.deserialize_any(QuantityVisitor(PhantomData))
    }
}

impl<D: Dimension, B: Bounds> Serialize for Quantity<D, B> {
    /// Writes the shortest decimal that reads back to the same bits, with its unit.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if D::SI.is_empty() {
            serializer.serialize_f64(self.value)
        } else {
            serializer.serialize_str(&with_unit::<D>(self.value))
        }
    }
}

impl<D: Dimension, B: Bounds> JsonSchema for Quantity<D, B> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        D::NAME.into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let units: Vec<&str> = D::UNITS.iter().map(|(unit, _)| *unit).filter(|unit| !unit.is_empty()).collect();
        let unit = if D::SI.is_empty() { "a pure number" } else { D::SI };
        let rule = if B::RULE.is_empty() { String::new() } else { format!(", {}", B::RULE) };
        json_schema!({
            "anyOf": [{ "type": "number" }, { "type": "string" }],
            "description": format!(
                "{}{rule}. A bare number is in SI units ({unit}); with a unit as text: {}, units {}",
                D::NAME, D::EXAMPLE, units.join(", ")
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::dimensions::*;
    use super::*;
    use proptest::prelude::*;

    fn read<D: Dimension>(text: &str) -> Result<f64, String> {
        Quantity::<D>::from_text(text).map(Quantity::si)
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-14 * b.abs(), "{a} is not {b}");
    }

    #[test]
    fn people_write_units_in_many_ways() {
        close(read::<Length>("0.5 mm").unwrap(), 0.5e-3);
        close(read::<Length>("-3e-2cm").unwrap(), -3e-4);
        close(read::<Length>("12 µm").unwrap(), 12e-6);
        close(read::<Force>("5 cN").unwrap(), 0.05);
        close(read::<Acceleration>("9.81 m/s²").unwrap(), 9.81);
        close(read::<Acceleration>("1 g").unwrap(), 9.80665);
        close(read::<Angle>("90°").unwrap(), std::f64::consts::FRAC_PI_2);
        close(read::<Time>("1 h").unwrap(), 3600.0);
        close(read::<Speed>("20 mm/s").unwrap(), 0.02);
        close(read::<BendingStiffness>("45 mN·mm²").unwrap(), 45e-9);
        close(read::<Density>("1.52 g/cm^3").unwrap(), 1520.0);
        close(read::<Ratio>("30 %").unwrap(), 0.3);
    }

    #[test]
    fn yarn_counts_are_linear_densities() {
        close(read::<LinearDensity>("30 tex").unwrap(), 30e-6);
        close(read::<LinearDensity>("150 denier").unwrap(), 150e-6 / 9.0);
        close(read::<LinearDensity>("Nm 28").unwrap(), 1e-3 / 28.0);
        close(read::<LinearDensity>("Nm 2/28").unwrap(), 2e-3 / 28.0);
        close(read::<LinearDensity>("nm 28/2").unwrap(), 2e-3 / 28.0);
        // 840 yards a pound.
        close(read::<LinearDensity>("Ne 30").unwrap(), 0.453_592_37 / (30.0 * 840.0 * 0.9144));
        for bad in ["Ne 0", "Ne -3", "Nm 2/", "Nm", "Ne x", "Nm 0/28", "Nm 1.5/2.5"] {
            assert!(read::<LinearDensity>(bad).unwrap_err().contains("count"), "{bad}");
        }
    }

    #[test]
    fn bad_quantities_say_what_is_wrong() {
        let wrong = |text| read::<Length>(text).unwrap_err();
        assert!(wrong("0.5").starts_with("\"0.5\" has no unit\nwrite for instance \"0.5 mm\", or a bare"));
        assert!(wrong("0.5 N").starts_with("`N` is no unit of a length; units are m, "));
        assert!(wrong("1e30 mm").contains("absurd"));
        assert!(wrong("mm").contains("does not start with a number"));
        assert!(wrong("").contains("does not start with a number"));
        assert!(wrong("1e999 mm").contains("finite"));
        assert!(Quantity::<Length>::new(f64::NAN).unwrap_err().contains("finite"));
        let negative = Quantity::<Length, Positive>::from_text("-1 mm").unwrap_err();
        assert_eq!(negative, "a length must be positive here, not \"-1 mm\"");
        assert!(Quantity::<Ratio, Fraction>::from_text("130 %").is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn what_is_written_reads_back_to_the_same_bits(value in prop::num::f64::NORMAL | prop::num::f64::ZERO) {
            if let Ok(length) = Quantity::<Length>::new(value) {
                let again = read::<Length>(&with_unit::<Length>(length.si())).unwrap();
                prop_assert_eq!(again.to_bits(), value.to_bits());
            }
        }

        #[test]
        fn any_text_is_read_or_refused(text in ".{0,20}", number in "[-+0-9.eE_−]{0,8}[a-zN² ]{0,3}") {
            let _ = (read::<Length>(&text), read::<LinearDensity>(&text));
            let _ = (read::<Length>(&number), read::<LinearDensity>(&number));
        }
    }
}
