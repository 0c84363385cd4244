//! What `wale check` and `wale inspect` say alike of a fabric: its yarns, its density and mass, its flaws, and its reader's remarks.

use serde_json::{Value, json};
use wale::measure::{Census, Shape};
use wale::model::{Float, Frame, Network};
use wale::scene::Scene;

use crate::arguments::Preset;
use crate::exit::Failure;
use crate::say;

/// Places of each kind of flaw that are said.
const SHOWN: usize = 5;

/// The counts and measures of a fabric.
pub struct FabricFacts<'a> {
    /// Its parts and yarns.
    pub census: Census,
    /// Its sizes.
    pub shape: Shape,
    scene: &'a Scene,
    /// The yarn that was assumed for it.
    assumed: Option<Preset>,
}

impl<'a> FabricFacts<'a> {
    /// Counts and measures a frame of a scene's fabric.
    #[must_use]
    pub fn of(scene: &'a Scene, network: &Network, frame: &Frame, assumed: Option<Preset>) -> Self {
        let census = Census::of(network, &scene.yarns, &scene.fabric);
        Self { census, shape: Shape::of(network, frame), scene, assumed }
    }

    fn areal_mass(&self) -> f64 {
        self.census.areal_mass(self.shape.stitch_density_per_m2)
    }

    /// All of them, in SI units.
    #[must_use]
    pub fn json(&self) -> Value {
        let remarks = self.scene.structure.remarks().map(|(line, what)| json!({ "line": line, "what": what }));
        let mut facts = json!({
            "fabric": self.census,
            "shape": self.shape,
            "areal_mass_kg_per_m2": self.areal_mass(),
            "remarks": remarks.collect::<Vec<_>>(),
        });
        if let Some(yarn) = self.assumed {
            facts["assumed_yarn"] = json!(yarn.name());
        }
        facts
    }

    /// Says which yarn was assumed, if one was.
    pub fn say_assumed(&self) -> Result<(), Failure> {
        match self.assumed {
            None => Ok(()),
            Some(yarn) => say!(
                "  assumed  the yarn {}; another by --yarn, your own in a scene that names this file (`wale new`)",
                yarn.name()
            ),
        }
    }

    /// Says how much there is of each yarn, how dense and heavy the fabric is, what a knitter would mend, dropped loops and
    /// floats past more than so many stitches, and what its reader remarked.
    pub fn say(&self, longest_float: u32) -> Result<(), Failure> {
        let Self { census, shape, scene, .. } = self;
        if census.amounts.len() > 1 {
            for amount in &census.amounts {
                let (length, mass) = (amount.length_m, 1e3 * amount.mass_kg);
                // A yarn of an image is called by its colour.
                let color = Some(&amount.color).filter(|color| **color != amount.name);
                let color = color.map(|color| format!(", {color}")).unwrap_or_default();
                say!("             {length:>8.3} m, {mass:.3} g of {}{color}", amount.name)?;
            }
        }
        let [width, height] = [shape.wale_spacing_m, shape.course_spacing_m].map(|spacing| 1e3 * spacing);
        let density = 1e-4 * shape.stitch_density_per_m2;
        let woven = scene.structure.woven().is_some();
        let [cell, cells, threads] =
            if woven { ["crossing", "crossings", "threads"] } else { ["stitch  ", "loops", "stitches"] };
        say!("  {cell} {width:.2} mm wide, {height:.2} mm high, {density:.2} {cells}/cm²")?;
        if woven && width > 0.0 && height > 0.0 {
            say!("  sett     {:.1} ends/cm, {:.1} picks/cm", 10.0 / width, 10.0 / height)?;
        }
        say!("  mass     {:.0} g/m²", 1e3 * self.areal_mass())?;
        let place = |row: u32, column: u32| match woven {
            true => format!("pick {} end {}", row + 1, column + 1),
            false => format!("row {} column {}", row + 1, column + 1),
        };
        let dropped = &census.unsupported_loops;
        if !dropped.is_empty() {
            let places = shown(dropped.iter().map(|[row, column]| place(*row, *column)));
            say!("  dropped  {} loops that nothing holds: {places}", dropped.len())?;
        }
        let long: Vec<&Float> = census.floats.iter().take_while(|float| float.over > longest_float).collect();
        if let Some(longest) = long.first() {
            let places =
                shown(long.iter().map(|float| format!("{} past {}", place(float.row, float.column), float.over)));
            let longest = longest.over;
            say!(
                "  floats   {} pass more than {longest_float} {threads}, the longest {longest}: {places}",
                long.len()
            )?;
        }
        for (line, what) in scene.structure.remarks() {
            say!("  line {line:<4} {what}")?;
        }
        Ok(())
    }
}

/// The first few of some places.
fn shown(places: impl ExactSizeIterator<Item = String>) -> String {
    let more = if places.len() > SHOWN { ", …" } else { "" };
    places.take(SHOWN).collect::<Vec<_>>().join(", ") + more
}

/// The initial layout as a frame.
#[must_use]
pub fn laid_out(network: &Network) -> Frame {
    Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() }
}
