//! Line plots of measured numbers, one panel or several above each other, as SVG and PNG.

use kuva::{
    backend::{raster::RasterBackend, svg::SvgBackend},
    plot::{LegendPosition, LinePlot, LineStyle, ScatterPlot},
    render::{
        figure::Figure,
        layout::{AxisLine, Layout},
        plots::Plot as KuvaPlot,
        render::Scene,
    },
};
use serde::{Deserialize, Serialize};

/// Line colours, told apart also by those who see red and green alike (lightness differs).
const COLORS: [&str; 7] = ["#20638f", "#cf5c36", "#6a994e", "#7b4b94", "#d9a426", "#3b3f4a", "#4fb0ae"];

/// One line of a plot; a dot where it has one point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Name in the legend; an empty one is left out.
    pub name: String,
    /// Places along the x axis.
    pub xs: Vec<f64>,
    /// Values, as many as `xs`.
    pub ys: Vec<f64>,
}

/// A pair of axes with its lines.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Label of the y axis, with its unit in brackets.
    pub y_label: String,
    /// The lines.
    pub series: Vec<Series>,
}

/// Panels above each other that share their x axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// Title above all.
    pub title: String,
    /// Label of the x axis, with its unit in brackets.
    pub x_label: String,
    /// Panels from the top.
    pub panels: Vec<Panel>,
}

/// A plot could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A panel without a single point.
    #[error("panel {0} of the plot has no finite points")]
    Empty(usize),
    /// The lists of a line differ in length.
    #[error("line `{name}` has {xs} places and {ys} values")]
    Lengths {
        /// Name of the line.
        name: String,
        /// Number of places.
        xs: usize,
        /// Number of values.
        ys: usize,
    },
    /// The drawing library refused.
    #[error("the plot could not be drawn: {0}")]
    Draw(String),
}

impl Plot {
    /// A plot of one panel.
    #[must_use]
    pub fn lines(title: &str, x_label: &str, y_label: &str, series: &[Series]) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            panels: vec![Panel { y_label: y_label.to_owned(), series: series.to_vec() }],
        }
    }

    /// The plot as SVG, its font embedded.
    ///
    /// # Errors
    /// If there is nothing to draw or a line's lists differ in length.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let scene = self.scene()?;
        Ok(renumbered(&SvgBackend::new().with_embedded_font(true).render_scene(&scene)))
    }

    /// The plot as a PNG file's bytes, two pixels to each SVG unit.
    ///
    /// # Errors
    /// As [`Plot::to_svg`], and if the picture is too large to draw.
    pub fn to_png(&self) -> Result<Vec<u8>, PlotError> {
        RasterBackend { scale: 2.0 }.render_scene(&self.scene()?).map_err(PlotError::Draw)
    }

    fn scene(&self) -> Result<Scene, PlotError> {
        let mut plots = Vec::new();
        let mut layouts = Vec::new();
        let range = self.x_range();
        for (i, panel) in self.panels.iter().enumerate() {
            let lines = panel.lines()?;
            if lines.is_empty() {
                return Err(PlotError::Empty(i));
            }
            let mut layout = Layout::auto_from_plots(&lines)
                .with_y_label(panel.y_label.clone())
                .with_axis_line(AxisLine::Open)
                .with_legend_box(false)
                .with_legend_position(LegendPosition::OutsideRightTop)
                .with_label_size(14)
                .with_tick_size(12)
                .with_body_size(12);
            if let Some((low, high)) = range {
                layout = layout.with_x_axis_min(low).with_x_axis_max(high);
            }
            if i + 1 == self.panels.len() {
                layout = layout.with_x_label(self.x_label.clone());
            }
            if i == 0 {
                layout = layout.with_title(self.title.clone()).with_title_size(16);
            }
            plots.push(lines);
            layouts.push(layout);
        }
        if plots.is_empty() {
            return Err(PlotError::Empty(0));
        }
        let rows = plots.len();
        let figure = Figure::new(rows, 1)
            .with_plots(plots)
            .with_layouts(layouts)
            .with_cell_size(820.0, if rows == 1 { 480.0 } else { 340.0 })
            .with_spacing(6.0);
        Ok(figure.render())
    }

    fn x_range(&self) -> Option<(f64, f64)> {
        let all = self.panels.iter().flat_map(|p| &p.series);
        let finite = all.flat_map(|s| &s.xs).copied().filter(|x| x.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        (low < high).then_some((low, high))
    }
}

impl Panel {
    fn lines(&self) -> Result<Vec<KuvaPlot>, PlotError> {
        let mut lines = Vec::new();
        for (i, series) in self.series.iter().enumerate() {
            if series.xs.len() != series.ys.len() {
                return Err(PlotError::Lengths { name: series.name.clone(), xs: series.xs.len(), ys: series.ys.len() });
            }
            let points: Vec<(f64, f64)> = series
                .xs
                .iter()
                .copied()
                .zip(series.ys.iter().copied())
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .collect();
            if points.is_empty() {
                continue;
            }
            let color = COLORS[i % COLORS.len()];
            if points.len() == 1 {
                // A line through one point is not seen.
                let mut point = ScatterPlot::new().with_data(points).with_color(color).with_size(4.0);
                if !series.name.is_empty() {
                    point = point.with_legend(series.name.clone());
                }
                lines.push(KuvaPlot::Scatter(point));
                continue;
            }
            let style = match i / COLORS.len() {
                0 => LineStyle::Solid,
                1 => LineStyle::Dashed,
                _ => LineStyle::Dotted,
            };
            let mut line =
                LinePlot::new().with_data(points).with_color(color).with_stroke_width(2.0).with_line_style(style);
            if !series.name.is_empty() {
                line = line.with_legend(series.name.clone());
            }
            lines.push(KuvaPlot::Line(line));
        }
        Ok(lines)
    }
}

/// The same picture whatever was drawn before in this process: the drawing library counts its clip paths through all pictures, here
/// they are counted from zero in each.
fn renumbered(svg: &str) -> String {
    const NAME: &str = "kuva-clip-";
    let mut known: Vec<&str> = Vec::new();
    let mut parts = svg.split(NAME);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let number = &part[..end];
        let place = known.iter().position(|other| *other == number).unwrap_or(known.len());
        if place == known.len() {
            known.push(number);
        }
        text.push_str(NAME);
        text.push_str(&place.to_string());
        text.push_str(&part[end..]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, f: impl Fn(f64) -> f64) -> Series {
        let xs: Vec<f64> = (0..60).map(f64::from).collect();
        Series { name: name.to_owned(), ys: xs.iter().map(|x| f(*x)).collect(), xs }
    }

    #[test]
    fn a_plot_is_the_same_when_it_is_drawn_again() {
        let one = Series { name: "one".to_owned(), xs: vec![0.0, 1.0], ys: vec![1.0, 3.0] };
        let panel = Panel { y_label: "force [N]".to_owned(), series: vec![one] };
        let plot = Plot { title: String::new(), x_label: "way [m]".to_owned(), panels: vec![panel.clone(), panel] };
        let [first, second] = [plot.to_svg().unwrap(), plot.to_svg().unwrap()];
        assert!(first.contains("kuva-clip-0") && first == second);
    }

    #[test]
    fn two_panels_draw_their_lines_in_their_colours() {
        let plot = Plot {
            title: "Rib stretched edge to edge".to_owned(),
            x_label: "extension [mm]".to_owned(),
            panels: vec![
                Panel { y_label: "force [N]".to_owned(), series: vec![series("", |x| (0.05 * x).exp())] },
                Panel {
                    y_label: "energy [mJ]".to_owned(),
                    series: vec![series("bending", |x| x), series("wrapping", |x| 0.1 * x * x)],
                },
            ],
        };
        let svg = plot.to_svg().unwrap();
        for text in ["force [N]", "extension [mm]", "wrapping", COLORS[1]] {
            assert!(svg.contains(text), "{text}");
        }
        let image = crate::picture::read_png(&plot.to_png().unwrap()).unwrap();
        let second = [0xcf, 0x5c, 0x36];
        let row = |p: usize| p / image.width;
        let found: Vec<usize> = (0..image.pixels.len()).filter(|p| image.pixels[*p] == second).map(row).collect();
        // The second colour is used in the lower panel only.
        assert!(found.len() > 100);
        assert!(found.iter().all(|y| *y > image.height * 2 / 5));
    }

    #[test]
    fn nothing_to_draw_is_an_error_and_a_gap_is_not() {
        let mut line = series("a", |x| x);
        line.ys[3] = f64::NAN;
        assert!(Plot::lines("t", "x", "y", &[line.clone()]).to_svg().is_ok());
        line.ys.pop();
        let wrong = Plot::lines("t", "x", "y", &[line]).to_svg();
        assert!(matches!(wrong, Err(PlotError::Lengths { xs: 60, ys: 59, .. })));
        assert_eq!(Plot::lines("t", "x", "y", &[]).to_svg(), Err(PlotError::Empty(0)));
        let flat = Series { name: String::new(), xs: vec![1.0], ys: vec![2.0] };
        assert!(Plot::lines("t", "x", "y", &[flat]).to_png().is_ok());
    }

    #[test]
    fn a_single_point_is_drawn() {
        let point = |name: &str, x: f64| Series { name: name.to_owned(), xs: vec![x], ys: vec![2.0] };
        let image = Plot::lines("t", "x", "y", &[point("", 1.0)]).to_png().unwrap();
        let image = crate::picture::read_png(&image).unwrap();
        assert!(image.pixels.iter().filter(|&&pixel| pixel == [0x20, 0x63, 0x8f]).count() > 50);
        let two = Plot::lines("t", "x", "y", &[point("weft", 1.0), point("warp", 3.0)]).to_svg().unwrap();
        assert!(two.contains("weft") && two.contains(COLORS[1]));
    }
}
