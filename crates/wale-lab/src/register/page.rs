//! The page: program, facts and photographs put together in one file.

use std::io::{self, Write};

use serde_json::json;
use thiserror::Error;

use super::Photograph;

const PAGE: &str = include_str!("page.html");
/// What the page is put together from.
const PARTS: [(&str, &str); 11] = [
    ("register.css", include_str!("register.css")),
    ("curve.js", include_str!("curve.js")),
    ("crossings.js", include_str!("crossings.js")),
    ("solve.js", include_str!("solve.js")),
    ("work.js", include_str!("work.js")),
    ("tile.js", include_str!("tile.js")),
    ("api.js", include_str!("api.js")),
    ("paint.js", include_str!("paint.js")),
    ("panel.js", include_str!("panel.js")),
    ("interface.js", include_str!("interface.js")),
    ("hands.js", include_str!("hands.js")),
];
/// Most yarn radii along a period: a repeat that is laid by hand is far smaller.
const MOST_RADII: f64 = 2000.0;
/// Fewest pixels along a period in which yarns can be seen.
const FEWEST_PIXELS: f64 = 8.0;

/// A swatch to be registered.
#[derive(Clone, Debug, PartialEq)]
pub struct RegisterPage {
    /// What it is called; files that are saved from the page are named after it.
    pub name: String,
    /// Both periods of the repeat \[m\].
    pub periods: [f64; 2],
    /// Radius of the yarns \[m\].
    pub radius: f64,
    /// Scale of the photographs \[m/pixel\]; without it the tile is drawn to its size by hand.
    pub scale: Option<f64>,
    /// The front.
    pub front: Photograph,
    /// The back.
    pub back: Option<Photograph>,
    /// Whether the back photograph is shown mirrored, as one taken after turning the fabric over must be.
    pub mirrored: bool,
}

/// A length that fits neither the others nor the photograph.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SizeFault {
    /// Not a positive number.
    #[error("the {what} is {value}; it must be a positive length")]
    NotPositive {
        /// Which.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// Yarns too thick or too thin for the periods.
    #[error(
        "a yarn radius of {radius:e} m does not fit a period of {period:e} m; give the radius, not the diameter, and the period of a small repeat"
    )]
    Radius {
        /// The radius \[m\].
        radius: f64,
        /// The period \[m\].
        period: f64,
    },
    /// A tile larger than the photograph, or too small to be seen.
    #[error(
        "at {scale:e} m a pixel a period of {period:e} m is {pixels:.1} pixels, and the longer side of the photograph {side}; check --scale and --period"
    )]
    Scale {
        /// The scale \[m/pixel\].
        scale: f64,
        /// The period \[m\].
        period: f64,
        /// The period in the photograph \[pixels\].
        pixels: f64,
        /// Longer side of the photograph \[pixels\].
        side: u32,
    },
}

impl RegisterPage {
    /// Whether its lengths make sense together.
    ///
    /// # Errors
    /// The first [`SizeFault`].
    pub fn check(&self) -> Result<(), SizeFault> {
        let lengths =
            [("first period", self.periods[0]), ("second period", self.periods[1]), ("yarn radius", self.radius)];
        for (what, value) in lengths.into_iter().chain(self.scale.map(|scale| ("scale", scale))) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SizeFault::NotPositive { what, value });
            }
        }
        let radius = self.radius;
        let odd = |period: f64| radius > 0.5 * period || period > MOST_RADII * radius;
        if let Some(period) = self.periods.into_iter().find(|&period| odd(period)) {
            return Err(SizeFault::Radius { radius, period });
        }
        let side = self.front.size().into_iter().max().unwrap_or_default();
        if let Some(scale) = self.scale {
            for period in self.periods {
                let pixels = period / scale;
                if !(FEWEST_PIXELS..=f64::from(side)).contains(&pixels) {
                    return Err(SizeFault::Scale { scale, period, pixels, side });
                }
            }
        }
        Ok(())
    }

    /// Writes the page, one file that needs nothing else. Lengths are written as they are; [`RegisterPage::check`] them first.
    ///
    /// # Errors
    /// If the target cannot be written.
    pub fn write_html(&self, mut target: impl Write) -> io::Result<()> {
        let title = format!("Register {}", self.name);
        let facts = json!({
            "title": title,
            "name": self.name,
            "periods_m": self.periods,
            "radius_m": self.radius,
            "scale_m": self.scale,
            "mirrored": self.mirrored,
        });
        // Within a script a closing tag would end it, even in a string.
        let facts = facts.to_string().replace('<', "\\u003c");
        let mut rest = PAGE;
        while let Some((before, after)) = rest.split_once("{{") {
            let (name, after) = after.split_once("}}").unwrap_or((after, ""));
            target.write_all(before.as_bytes())?;
            match name {
                "title" => target.write_all(escaped(&title).as_bytes())?,
                "facts" => target.write_all(facts.as_bytes())?,
                "front" => self.front.write_uri(&mut target)?,
                "back" => self.back.as_ref().map_or(Ok(()), |back| back.write_uri(&mut target))?,
                name => {
                    let part = PARTS.iter().find(|(known, _)| *known == name);
                    target.write_all(part.map_or("", |(_, text)| text).as_bytes())?;
                }
            }
            rest = after;
        }
        target.write_all(rest.as_bytes())?;
        target.flush()
    }
}

/// Text as it may stand in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::super::photograph::tests::png;
    use super::*;

    fn page() -> RegisterPage {
        let photograph = |name| Photograph::new(name, png(400, 300)).expect("a photograph");
        RegisterPage {
            name: "swatch".into(),
            periods: [2.1e-3, 1.6e-3],
            radius: 0.2e-3,
            scale: Some(10e-6),
            front: photograph("front.png"),
            back: Some(photograph("back.png")),
            mirrored: true,
        }
    }

    fn text(page: &RegisterPage) -> String {
        let mut bytes = Vec::new();
        page.write_html(&mut bytes).expect("memory");
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn the_page_is_whole_and_asks_nothing_of_the_net() {
        let text = text(&page());
        assert!(text.starts_with("<!DOCTYPE html>") && text.trim_end().ends_with("</html>"));
        for left in ["{{", "src=", "href=", "http://", "https://", "@import", "import "] {
            assert!(!text.contains(left), "{left}");
        }
        PARTS.iter().for_each(|(name, part)| assert!(text.contains(part), "{name}"));
        assert_eq!(text.matches("data:image/png;base64,").count(), 2);
        assert_eq!(text.matches("</script>").count(), 4);
        for (name, part) in PARTS {
            assert!(part.lines().count() < 400, "{name}");
        }
    }

    #[test]
    fn a_name_cannot_become_markup() {
        let page = RegisterPage { name: "</script><script>alert(1)</script> & {{facts}}".into(), back: None, ..page() };
        let text = text(&page);
        assert!(!text.contains("<script>alert") && text.contains("&lt;/script&gt;"));
        assert_eq!(text.matches("</script>").count(), 4);
    }

    #[test]
    fn absurd_sizes_are_refused() {
        assert_eq!(page().check(), Ok(()));
        assert_eq!(RegisterPage { scale: None, ..page() }.check(), Ok(()));
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let faults = [
                RegisterPage { periods: [1e-3, value], ..page() },
                RegisterPage { radius: value, ..page() },
                RegisterPage { scale: Some(value), ..page() },
            ];
            faults.iter().for_each(|page| assert!(matches!(page.check(), Err(SizeFault::NotPositive { .. }))));
        }
        assert!(matches!(RegisterPage { radius: 1e-3, ..page() }.check(), Err(SizeFault::Radius { .. })));
        assert!(matches!(RegisterPage { radius: 1e-7, ..page() }.check(), Err(SizeFault::Radius { .. })));
        for scale in [1e-6, 1e-3] {
            let error = RegisterPage { scale: Some(scale), ..page() }.check().expect_err("absurd");
            assert!(matches!(error, SizeFault::Scale { .. }) && error.to_string().contains("--scale"));
        }
    }
}
