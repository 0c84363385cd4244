//! The command line of `wale register`, and lengths with their units on it.

use std::path::PathBuf;

use clap::Args;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};
use wale::scene::dimensions::Length;
use wale::scene::units::{Positive, Quantity};

/// `wale register`
#[derive(Debug, Args)]
pub struct Register {
    /// Photograph of the front, PNG or JPEG
    pub front: PathBuf,
    /// Photograph of the back, PNG or JPEG
    pub back: Option<PathBuf>,
    /// Periods of the repeat, along the courses and along the wales, such as "2.1 mm x 1.6 mm"
    #[arg(long, value_name = "PERIOD x PERIOD", value_parser = parse_periods)]
    pub period: [f64; 2],
    /// Radius of the yarn, such as "0.2 mm"
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    pub radius: f64,
    /// Length of a pixel of the photographs, such as "1.8 um"; left out, the tile is drawn to its size on the page
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    pub scale: Option<f64>,
    /// Show the back photograph as it is: it was mirrored already. Else the page mirrors it, so that it shows the place in front
    #[arg(long)]
    pub back_as_it_is: bool,
    /// Page to write; left out, beside the front photograph and named after it
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

/// A positive length with its unit \[m\].
fn parse_length(text: &str) -> Result<f64, String> {
    let deserializer: StrDeserializer<'_, Error> = text.into_deserializer();
    let length = Quantity::<Length, Positive>::deserialize(deserializer);
    length.map(Quantity::si).map_err(|error| {
        // Scene files take bare numbers too; on a command line they would be mistaken for millimetres.
        let error = error.to_string().replace('\n', "; ");
        error.split(", or a bare number").next().unwrap_or_default().to_owned()
    })
}

/// Two positive lengths with an `x` between them \[m\].
fn parse_periods(text: &str) -> Result<[f64; 2], String> {
    let (first, second) = text
        .split_once(['x', '×'])
        .ok_or_else(|| format!("`{text}` is not two periods such as \"2.1 mm x 1.6 mm\""))?;
    Ok([parse_length(first)?, parse_length(second)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_units() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(parse_length("1.8 um").is_ok_and(|length| near(length, 1.8e-6)));
        assert!(parse_periods("2.1 mm x 0.16cm").is_ok_and(|[a, b]| near(a, 2.1e-3) && near(b, 1.6e-3)));
        for (bad, says) in [("2", "has no unit"), ("-2 mm", "positive"), ("0 mm", "positive"), ("2 kg", "no unit of")] {
            let error = parse_length(bad).unwrap_err();
            assert!(error.contains(says) && !error.contains('\n'), "{error}");
        }
        assert!(!parse_length("2").unwrap_err().contains("bare number"));
        assert!(parse_periods("2.1 mm").unwrap_err().contains("two periods"));
        assert!(parse_periods("2.1 x 1.6 mm").unwrap_err().contains("has no unit"));
    }
}
