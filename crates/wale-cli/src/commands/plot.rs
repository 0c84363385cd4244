//! `wale plot`: forces, sizes and energies of a run as a line plot.

use std::io;
use std::path::PathBuf;

use wale::picture::{Panel, Plot, Series};
use wale::record::atomic_file::write_atomically;

use crate::arguments::{FrameChoice, Plot as Arguments};
use crate::exit::{Code, Failure};
use crate::opened::OpenedRun;
use crate::say;

/// Draws it.
pub fn plot(arguments: &Arguments) -> Result<(), Failure> {
    let Some(path) = write_plot(arguments)? else {
        let what = format_args!("{}: fewer than two rows of metrics", arguments.run.display());
        return Err(Failure::new(Code::BadInput, what));
    };
    say!("{}", path.display())
}

/// Draws it, and says which file it is; `None` if the run is so short that there is no line to draw.
///
/// # Errors
/// When the metrics cannot be read, or the file cannot be written.
pub fn write_plot(arguments: &Arguments) -> Result<Option<PathBuf>, Failure> {
    let run = OpenedRun::open(&arguments.run, FrameChoice::Last)?;
    let path = run.results(arguments.out.as_ref(), "plot.png")?;
    let metrics = run.reader.path().join("metrics.csv");
    let text = std::fs::read_to_string(&metrics).map_err(|error| Failure::io(&metrics, "read", error))?;
    let table = Table::read(&text).ok_or_else(|| {
        Failure::new(Code::BadInput, format_args!("{}: it is no table of numbers", metrics.display()))
    })?;
    if table.rows.len() < 2 {
        return Ok(None);
    }
    let plot = table.plot(&run.scene.title);
    let svg = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    let bytes = if svg { plot.to_svg().map(String::into_bytes) } else { plot.to_png() }
        .map_err(|error| Failure::new(Code::BadInput, error))?;
    write_atomically(&path, |out| io::Write::write_all(out, &bytes))?;
    Ok(Some(path))
}

/// The metrics of a run: names with units, and numbers.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let names: Vec<String> = lines.next()?.split(',').map(str::to_owned).collect();
        let rows = lines
            .map(|line| line.split(',').map(|field| field.trim().parse().ok()).collect::<Option<Vec<f64>>>())
            .map(|row| row.filter(|row| row.len() == names.len()))
            .collect::<Option<_>>()?;
        Some(Self { names, rows })
    }

    fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.names.iter().position(|other| other == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// Names of the columns that end alike, without the ending.
    fn ending<'a>(&'a self, ending: &'a str) -> impl Iterator<Item = &'a str> {
        self.names.iter().filter_map(move |name| name.strip_suffix(ending))
    }

    /// The grip and axis that move the farthest, if any moves, and how far \[mm\].
    fn pull(&self) -> Option<(String, Vec<f64>)> {
        let mut best: Option<(f64, String, Vec<f64>)> = None;
        for axis in ["x", "y", "z"] {
            for grip in self.ending(&format!(" displacement {axis} [m]")) {
                let way = self.column(&format!("{grip} displacement {axis} [m]"))?;
                let range = way.iter().fold(0.0f64, |m, d| m.max(d.abs()));
                if range > best.as_ref().map_or(1e-9, |best| best.0) {
                    best = Some((range, format!("{grip} force {axis} [N]"), scaled(&way, 1e3)));
                }
            }
        }
        best.map(|(_, force, way)| (force, way))
    }

    /// Force against distance where a grip moves, else sizes against time; below it the energies by kind.
    fn plot(&self, title: &str) -> Plot {
        let time = self.column("time [s]").unwrap_or_default();
        let (x_label, xs, top) = match self.pull() {
            Some((force, way)) => {
                let series =
                    Series { name: String::new(), xs: way.clone(), ys: self.column(&force).unwrap_or_default() };
                ("distance [mm]", way, Panel { y_label: "force [N]".to_owned(), series: vec![series] })
            }
            None => {
                let series = ["x", "y", "z"].iter().filter_map(|axis| {
                    let ys = self.column(&format!("extent {axis} [m]"))?;
                    Some(Series { name: (*axis).to_owned(), xs: time.clone(), ys: scaled(&ys, 1e3) })
                });
                ("time [s]", time.clone(), Panel { y_label: "extent [mm]".to_owned(), series: series.collect() })
            }
        };
        let energies = self.ending(" energy [J]").filter_map(|kind| {
            let ys = scaled(&self.column(&format!("{kind} energy [J]"))?, 1e3);
            let moved = ys.iter().any(|y| (y - ys[0]).abs() > 1e-9);
            moved.then(|| Series { name: kind.to_owned(), xs: xs.clone(), ys })
        });
        let energies = Panel { y_label: "energy [mJ]".to_owned(), series: energies.collect() };
        let panels = [top, energies].into_iter().filter(|panel| !panel.series.is_empty()).collect();
        Plot { title: title.to_owned(), x_label: x_label.to_owned(), panels }
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grip_that_moves_is_plotted_against_its_way() {
        let text = "time [s],bending energy [J],edge force x [N],edge displacement x [m]\n0,0.1,0,0\n1,0.3,2,0.04\n";
        let plot = Table::read(text).unwrap().plot("pull");
        assert_eq!(plot.x_label, "distance [mm]");
        assert_eq!(plot.panels[0].series[0].xs, [0.0, 40.0]);
        assert_eq!(plot.panels[0].series[0].ys, [0.0, 2.0]);
        assert_eq!(plot.panels[1].series[0].name, "bending");
        let still = Table::read("time [s],extent x [m]\n0,0.1\n1,0.2\n").unwrap().plot("still");
        assert_eq!((still.x_label.as_str(), still.panels.len()), ("time [s]", 1));
        assert!(Table::read("a,b\n1\n").is_none() && Table::read("a\nx\n").is_none());
    }
}
