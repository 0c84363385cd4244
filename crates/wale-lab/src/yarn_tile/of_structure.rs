//! Tiles of what a designer has: the chart of a knit, the draft of a weave.

use glam::DVec3;
use thiserror::Error;
use wale::dynamics::tile_equilibrium::{TileSettings, relax_from_starts};
use wale::fabric::Coordinates;
use wale::geometry::{CurveSettings, curves};
use wale::model::{FabricCard, KnitCard, YarnId, Yarns};
use wale::pattern::weave::Draft;
use wale::pattern::{Chart, ChartError, knit};

use super::tile::{Edge, TileFault, YarnTile};

/// Why a chart or a draft gives no tile.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StructureError {
    /// The chart does not repeat.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The repeat is too large.
    #[error(
        "the repeat has {loops} loops, and a tile has at most {most}; give the tile of a smaller part as a .pyp file"
    )]
    TooLarge {
        /// Loops, or crossings, of the repeat.
        loops: usize,
        /// Most of them.
        most: usize,
    },
    /// The repeat does not come to rest.
    #[error("the repeat did not come to rest: a residual of {residual:.1e} is left")]
    NotAtRest {
        /// What is left, as `TileEquilibrium` says it.
        residual: f64,
    },
    /// The curves are no tile.
    #[error("the drawn yarns are no tile: {0}")]
    Fault(#[from] TileFault),
}

/// Most loops or crossings of a repeat: a tile of so many has some thousand vertices.
const MOST_LOOPS: usize = 64;
/// Starts from which the repeat of a chart is brought to rest.
const STARTS: usize = 2;
/// Length of an edge, in radii of the yarn \[–\].
const EDGE: f64 = 0.8;
/// Pieces of a drawn curve between two knots, before it is divided evenly.
const SAMPLES: usize = 24;

/// The smallest repeat of a chart as a tile: brought to rest as a network, and drawn.
///
/// # Errors
/// [`StructureError`].
pub fn tile_of_chart(chart: &Chart, yarns: &Yarns, card: &KnitCard) -> Result<YarnTile, StructureError> {
    let repeat = chart.smallest_repeat();
    let loops = repeat.loop_count();
    if loops > MOST_LOOPS {
        return Err(StructureError::TooLarge { loops, most: MOST_LOOPS });
    }
    let network = knit::tile(&repeat, card)?;
    let found = relax_from_starts(&network, yarns, card, &TileSettings::of(card), STARTS).swap_remove(0);
    if !found.converged {
        return Err(StructureError::NotAtRest { residual: found.residual });
    }
    let frame = Coordinates::new(&network).frame(0.0, &found.coordinates);
    let [rows, columns] = network.chart_size.map(f64::from);
    let periods = [columns * found.wale_spacing, rows * found.course_spacing];
    let settings = CurveSettings {
        samples_per_segment: SAMPLES,
        periods: Some([DVec3::X * periods[0], DVec3::Y * periods[1]]),
        ..CurveSettings::of(yarns, &FabricCard::from(card))
    };
    let radius = yarns.first().radius;
    let closed = curves(&network, &frame, &settings).into_iter().enumerate().map(|(yarn, curve)| {
        let shift = network.yarn_closure[YarnId::new(yarn).index()].map_or([0, 0], |(image, _)| image.map(i32::from));
        (curve.points, shift)
    });
    of_closed_curves(periods, radius, closed)
}

/// The repeat of a draft as a tile: yarns of a radius at a distance \[m\] of ends and picks, which change sides between
/// crossings. The heights \[m\] say how far warp and weft go from the back to the front.
///
/// # Errors
/// [`StructureError`].
pub fn tile_of_draft(
    draft: &Draft,
    radius: f64,
    spacing: [f64; 2],
    height: [f64; 2],
) -> Result<YarnTile, StructureError> {
    let draft = draft.smallest_repeat();
    let (ends, picks) = (draft.ends(), draft.picks());
    if ends * picks > MOST_LOOPS {
        return Err(StructureError::TooLarge { loops: ends * picks, most: MOST_LOOPS });
    }
    let periods = [ends as f64 * spacing[0], picks as f64 * spacing[1]];
    // Half a period of a cosine between two crossings on different sides, level under a float.
    let climb = |from: f64, to: f64, part: f64| {
        let smooth = 0.5 - 0.5 * (std::f64::consts::PI * part).cos();
        from + (to - from) * smooth
    };
    let place = |index: f64, spacing: f64| (index + 0.5) * spacing;
    let mut closed = Vec::new();
    for end in 0..ends {
        let side = |pick: usize| if draft.warp_up(end, pick % picks) { 0.5 * height[0] } else { -0.5 * height[0] };
        let points = (0..=picks * SAMPLES).map(|k| {
            let (pick, part) = (k / SAMPLES, (k % SAMPLES) as f64 / SAMPLES as f64);
            let z = climb(side(pick), side(pick + 1), part);
            DVec3::new(place(end as f64, spacing[0]), place(pick as f64 + part, spacing[1]), z)
        });
        closed.push((points.collect(), [0, 1]));
    }
    for pick in 0..picks {
        let side = |end: usize| if draft.warp_up(end % ends, pick) { -0.5 * height[1] } else { 0.5 * height[1] };
        let points = (0..=ends * SAMPLES).map(|k| {
            let (end, part) = (k / SAMPLES, (k % SAMPLES) as f64 / SAMPLES as f64);
            let z = climb(side(end), side(end + 1), part);
            DVec3::new(place(end as f64 + part, spacing[0]), place(pick as f64, spacing[1]), z)
        });
        closed.push((points.collect(), [1, 0]));
    }
    of_closed_curves(periods, radius, closed.into_iter())
}

/// A tile of curves whose last points are images of their first, divided into edges of one length each.
fn of_closed_curves(
    periods: [f64; 2],
    radius: f64,
    curves: impl Iterator<Item = (Vec<DVec3>, [i32; 2])>,
) -> Result<YarnTile, StructureError> {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    for (points, shift) in curves {
        let row = divide(&points, EDGE * radius);
        let (first, n) = (vertices.len() as u32, row.len() as u32);
        vertices.extend(row);
        edges.extend(
            (0..n).map(|k| Edge {
                ends: [first + k, first + (k + 1) % n],
                shift: if k + 1 == n { shift } else { [0, 0] },
            }),
        );
    }
    Ok(YarnTile::new(periods, radius, vertices, edges)?)
}

/// Points evenly along a polyline, the last of which is left out; at most so far apart \[m\].
fn divide(points: &[DVec3], most: f64) -> Vec<[f64; 3]> {
    let mut along = vec![0.0];
    for pair in points.windows(2) {
        along.push(along[along.len() - 1] + pair[0].distance(pair[1]));
    }
    let length = along[along.len() - 1];
    let n = (length / most).ceil().max(3.0) as usize;
    (0..n)
        .map(|k| {
            let at = length * k as f64 / n as f64;
            let upper = along.partition_point(|&l| l <= at).clamp(1, points.len() - 1);
            let (a, b) = (along[upper - 1], along[upper]);
            let part = if b > a { (at - a) / (b - a) } else { 0.0 };
            points[upper - 1].lerp(points[upper], part).to_array()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::closest::segment_distance;
    use super::super::{CoarseDeformation, contact_radius};
    use super::*;
    use wale::scene::{Scene, text_of_preset};

    /// The nearest that two edges of a tile come which are no neighbours, in diameters.
    fn clearance(tile: &YarnTile) -> f64 {
        let mut nearest = f64::INFINITY;
        let segment = |edge: usize, shift: [i32; 2]| {
            let e = tile.edges()[edge];
            [tile.image(e.ends[0], shift), tile.image(e.ends[1], [shift[0] + e.shift[0], shift[1] + e.shift[1]])]
        };
        let followers = super::super::neighbours::Followers::new(tile, std::f64::consts::PI * tile.radius());
        let rest = CoarseDeformation::REST;
        for pair in super::super::neighbours::near_pairs(tile, &rest, tile.vertices(), &followers, 2.0 * tile.radius())
        {
            let distance =
                segment_distance(segment(pair.first as usize, [0, 0]), segment(pair.second as usize, pair.shift));
            nearest = f64::min(nearest, distance / (2.0 * tile.radius()));
        }
        nearest
    }

    #[test]
    fn charts_become_tiles_whose_yarns_touch_and_do_not_cross() {
        let scene = Scene::from_text(&text_of_preset(wale::scene::schema::PresetName::WorstedWool), "preset.toml")
            .expect("a preset");
        let card = scene.fabric.knit().expect("a knit");
        for (chart, yarns) in [(Chart::stockinette(), 1), (Chart::garter(), 2), (Chart::rib(1, 1).unwrap(), 1)] {
            let tile = tile_of_chart(&chart, &scene.yarns, card).unwrap();
            assert_eq!(tile.yarn_count(), yarns);
            let longest = tile.lengths().into_iter().fold(0.0, f64::max);
            assert!(longest <= EDGE * tile.radius() * 1.0001);
            let near = clearance(&tile);
            assert!(near > 0.5, "{near}");
            let touching = contact_radius(&tile) / tile.radius();
            assert!((0.8..3.0).contains(&touching), "{touching}");
        }
    }

    #[test]
    fn drafts_become_tiles_that_lie_on_each_other() {
        let radius = 0.2e-3;
        for draft in [Draft::plain(), Draft::twill(2, 2).unwrap()] {
            let tile = tile_of_draft(&draft, radius, [0.8e-3, 0.9e-3], [2.0 * radius; 2]).unwrap();
            let small = draft.smallest_repeat();
            assert_eq!(tile.yarn_count(), small.ends() + small.picks());
            let near = clearance(&tile);
            assert!((0.8..1.01).contains(&near), "{near}");
        }
        let large = Draft::plain().repeat(1, 1).unwrap();
        assert!(tile_of_draft(&large, radius, [1e-3; 2], [2.0 * radius; 2]).is_ok());
        let satin = Draft::satin(9, 2).unwrap();
        let error = tile_of_draft(&satin, radius, [1e-3; 2], [2.0 * radius; 2]).unwrap_err();
        assert_eq!(error, StructureError::TooLarge { loops: 81, most: MOST_LOOPS });
    }
}
