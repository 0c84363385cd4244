//! The colours of yarns: their own, or those of a quantity along them, with a legend.

use glam::Vec3;

use super::{
    ColorMode, Settings, Subject,
    color_map::{ColorMap, to_linear},
    scale_bar::Legend,
};
use crate::geometry::{Curve, Quantity};

/// Values at both ends of the colours for a quantity: all but the most extreme hundredth, about zero if signed.
#[must_use]
pub fn color_range(quantity: Quantity, values: &[Vec<f64>]) -> [f64; 2] {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let last = sorted.len().saturating_sub(1) as f64;
        sorted.get((part * last).round() as usize).copied().unwrap_or(0.0)
    };
    let (low, high) = (at(0.01), at(0.99));
    let smallest = 1e-3 / quantity.legend_unit().1;
    if quantity.is_signed() {
        let reach = low.abs().max(high.abs()).max(smallest);
        [-reach, reach]
    } else {
        [0.0, high.max(smallest)]
    }
}

/// The colour map that suits a quantity.
#[must_use]
pub fn color_map(quantity: Quantity) -> ColorMap {
    if quantity.is_signed() { ColorMap::Diverging } else { ColorMap::Sequential }
}

/// Linear colour of each point of each curve.
pub(super) fn point_colors(subject: &Subject, settings: &Settings) -> (Vec<Vec<Vec3>>, Option<Legend>) {
    let scalars = match (settings.color_mode, subject.scalars) {
        (ColorMode::By(quantity), Some(scalars)) => Some((quantity, scalars.of(quantity))),
        _ => None,
    };
    let Some((quantity, values)) = scalars else {
        let plain = |c: &Curve| vec![to_linear(c.color); c.points.len()];
        return (subject.curves.iter().map(plain).collect(), None);
    };
    let range = settings.color_range.unwrap_or_else(|| color_range(quantity, values));
    let map = color_map(quantity);
    let colors = subject
        .curves
        .iter()
        .enumerate()
        .map(|(c, curve)| {
            (0..curve.points.len())
                .map(|i| {
                    let value = values.get(c).and_then(|v| v.get(i)).copied().unwrap_or(f64::NAN);
                    map.light((value - range[0]) / (range[1] - range[0]))
                })
                .collect()
        })
        .collect();
    let (unit, scale) = quantity.legend_unit();
    let legend = Legend { title: format!("{} [{unit}]", quantity.name()), range: range.map(|v| v * scale), map };
    (colors, Some(legend))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PointScalars;
    use glam::DVec3;

    fn yarns() -> Vec<Curve> {
        vec![Curve {
            points: (0..21).map(|i| DVec3::X * f64::from(i) * 1e-3).collect(),
            arc_length: (0..21).map(|i| f64::from(i) * 1e-3).collect(),
            pass: vec![0; 21],
            radius: 1e-3,
            color: [200, 30, 30],
        }]
    }

    #[test]
    fn colours_follow_the_numbers() {
        let curves = yarns();
        let rising = |c: &Curve| c.points.iter().map(|p| p.x * 1e3).collect::<Vec<f64>>();
        let scalars = PointScalars { curvature: curves.iter().map(rising).collect(), ..PointScalars::default() };
        let subject = Subject { curves: &curves, scalars: Some(&scalars), solids: &[] };
        let settings = Settings { color_mode: ColorMode::By(Quantity::Curvature), ..Settings::default() };
        let (colors, legend) = point_colors(&subject, &settings);
        let brightness = |v: Vec3| v.x + v.y + v.z;
        assert!(brightness(colors[0][20]) > 5.0 * brightness(colors[0][0]));
        let legend = legend.unwrap();
        assert_eq!(legend.title, "curvature [1/mm]");
        assert!((legend.range[1] - 0.02).abs() < 1e-3, "{legend:?}");
        // Without numbers the yarn keeps its own colour.
        let (colors, legend) = point_colors(&Subject { scalars: None, ..subject }, &settings);
        assert!(legend.is_none() && colors[0][0].x > colors[0][0].z);
    }

    #[test]
    fn ranges_are_even_about_zero_where_sign_matters() {
        let values = vec![vec![-0.02, 0.0, 0.05, f64::NAN]];
        assert_eq!(color_range(Quantity::Stretch, &values), [-0.05, 0.05]);
        assert_eq!(color_range(Quantity::Curvature, &[vec![200.0, 3.0]]), [0.0, 200.0]);
        assert!(color_range(Quantity::Sliding, &[])[1] > 0.0);
    }
}
