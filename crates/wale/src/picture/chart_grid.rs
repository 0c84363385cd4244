//! Small charts side by side: lines against measured points, with a bar where one range ends and another begins.

use kuva::{
    backend::{raster::RasterBackend, svg::SvgBackend},
    plot::{LegendPosition, LinePlot, LineStyle, ScatterPlot, annotations::ReferenceLine},
    render::{
        figure::Figure,
        layout::{AxisLine, Layout},
        plots::Plot as KuvaPlot,
        render::Scene,
    },
};

use super::plot::{PlotError, Series};

/// Colour of what was measured, and of the bar.
const MEASURED: &str = "#3b3f4a";
/// Colours of lines: told apart also by those who see red and green alike (lightness differs).
const LINES: [&str; 4] = ["#2f7fb8", "#8a3f9c", "#d9a426", "#4fb0ae"];
/// Width and height of a chart in units of SVG.
const CELL: [f64; 2] = [330.0, 235.0];

/// One chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// What it shows, above it.
    pub title: String,
    /// Label of the x axis with its unit; left out if empty.
    pub x_label: String,
    /// Label of the y axis with its unit.
    pub y_label: String,
    /// Measured points.
    pub points: Vec<Series>,
    /// Lines, each in a colour of its own, the same in every chart; the first chart names them.
    pub lines: Vec<Series>,
    /// Where a vertical bar stands, if one does.
    pub bar: Option<f64>,
}

/// Charts in rows, read like a text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartGrid {
    /// Title above all.
    pub title: String,
    /// Charts in a row.
    pub columns: usize,
    /// The charts.
    pub charts: Vec<Chart>,
}

impl ChartGrid {
    /// The grid as SVG, its font embedded.
    ///
    /// # Errors
    /// If a chart has nothing to draw or a series' lists differ in length.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        Ok(SvgBackend::new().with_embedded_font(true).render_scene(&self.scene()?))
    }

    /// The grid as a PNG file's bytes, `scale` pixels to each SVG unit.
    ///
    /// # Errors
    /// As [`ChartGrid::to_svg`], and if the picture is too large to draw.
    pub fn to_png(&self, scale: f32) -> Result<Vec<u8>, PlotError> {
        RasterBackend { scale }.render_scene(&self.scene()?).map_err(PlotError::Draw)
    }

    fn scene(&self) -> Result<Scene, PlotError> {
        let columns = self.columns.max(1);
        if self.charts.is_empty() {
            return Err(PlotError::Empty(0));
        }
        let (mut plots, mut layouts) = (Vec::new(), Vec::new());
        for (index, chart) in self.charts.iter().enumerate() {
            let drawn = chart.plots(index == 0)?;
            if drawn.is_empty() {
                return Err(PlotError::Empty(index));
            }
            layouts.push(chart.layout(&drawn, index == 0));
            plots.push(drawn);
        }
        let figure = Figure::new(self.charts.len().div_ceil(columns), columns)
            .with_plots(plots)
            .with_layouts(layouts)
            .with_title(self.title.clone())
            .with_title_size(16)
            .with_cell_size(CELL[0], CELL[1])
            .with_spacing(4.0);
        Ok(figure.render())
    }
}

impl Chart {
    fn layout(&self, drawn: &[KuvaPlot], with_legend: bool) -> Layout {
        let mut layout = Layout::auto_from_plots(drawn)
            .with_title(self.title.clone())
            .with_title_size(13)
            .with_y_label(self.y_label.clone())
            .with_axis_line(AxisLine::Open)
            .with_legend_box(false)
            .with_label_size(12)
            .with_tick_size(10)
            .with_body_size(11);
        if !self.x_label.is_empty() {
            layout = layout.with_x_label(self.x_label.clone());
        }
        if with_legend {
            layout = layout.with_legend_position(LegendPosition::InsideTopLeft);
        }
        if let Some(bar) = self.bar {
            let line = ReferenceLine::vertical(bar).with_color("black").with_stroke_width(1.5).with_dasharray("none");
            layout = layout.with_reference_line(line);
        }
        layout
    }

    fn plots(&self, named: bool) -> Result<Vec<KuvaPlot>, PlotError> {
        let mut plots = Vec::new();
        for (index, series) in self.lines.iter().enumerate() {
            let data = finite(series)?;
            if data.is_empty() {
                continue;
            }
            let style = if index < LINES.len() { LineStyle::Solid } else { LineStyle::Dashed };
            let mut line = LinePlot::new()
                .with_data(data)
                .with_color(LINES[index % LINES.len()])
                .with_stroke_width(2.0)
                .with_line_style(style);
            if named && !series.name.is_empty() {
                line = line.with_legend(series.name.clone());
            }
            plots.push(KuvaPlot::Line(line));
        }
        for series in &self.points {
            let data = finite(series)?;
            if data.is_empty() {
                continue;
            }
            let mut points = ScatterPlot::new().with_data(data).with_color(MEASURED).with_size(3.0);
            if named && !series.name.is_empty() {
                points = points.with_legend(series.name.clone());
            }
            plots.push(KuvaPlot::Scatter(points));
        }
        Ok(plots)
    }
}

/// The points that can be drawn.
fn finite(series: &Series) -> Result<Vec<(f64, f64)>, PlotError> {
    let (xs, ys) = (series.xs.len(), series.ys.len());
    if xs != ys {
        return Err(PlotError::Lengths { name: series.name.clone(), xs, ys });
    }
    let pairs = series.xs.iter().copied().zip(series.ys.iter().copied());
    Ok(pairs.filter(|(x, y)| x.is_finite() && y.is_finite()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(title: &str) -> Chart {
        let xs: Vec<f64> = (0..5).map(f64::from).collect();
        let line = |name: &str, k: f64| Series {
            name: name.to_owned(),
            ys: xs.iter().map(|x| k * x).collect(),
            xs: xs.clone(),
        };
        Chart {
            title: title.to_owned(),
            x_label: "stretch [%]".to_owned(),
            y_label: "stress [N/m]".to_owned(),
            points: vec![line("measured", 1.0)],
            lines: vec![line("whole", 1.1), line("less", 2.0)],
            bar: Some(1.5),
        }
    }

    #[test]
    fn charts_stand_in_rows_with_points_lines_and_bars() {
        let charts = ["a", "b", "c"].map(chart).to_vec();
        let grid = ChartGrid { title: "Three".to_owned(), columns: 2, charts };
        let svg = grid.to_svg().unwrap();
        assert!(svg.contains("measured") && svg.contains(LINES[1]) && svg.contains(MEASURED));
        let image = crate::picture::read_png(&grid.to_png(1.0).unwrap()).unwrap();
        assert!(image.width as f64 > 2.0 * CELL[0] && (image.width as f64) < 2.5 * CELL[0]);
        assert!(image.height as f64 > 2.0 * CELL[1]);
        // The second line is purple in the chart of the lower row, too.
        let purple = [0x8a, 0x3f, 0x9c];
        let below = image.pixels.iter().skip(image.width * image.height * 6 / 10).filter(|p| **p == purple).count();
        assert!(below > 50, "{below}");
    }

    #[test]
    fn an_empty_chart_is_an_error() {
        assert_eq!(ChartGrid::default().to_svg(), Err(PlotError::Empty(0)));
        let grid = ChartGrid { charts: vec![chart("a"), Chart::default()], ..ChartGrid::default() };
        assert_eq!(grid.to_svg(), Err(PlotError::Empty(1)));
        let mut short = chart("a");
        short.points[0].ys.pop();
        let grid = ChartGrid { charts: vec![short], ..ChartGrid::default() };
        assert!(matches!(grid.to_svg(), Err(PlotError::Lengths { xs: 5, ys: 4, .. })));
    }
}
