//! What an export sees: the yarns of one frame as curves, with numbers along them.

use std::error::Error;

use glam::DVec3;

use super::ExportError;
use crate::geometry::{Curve, CurveSettings, curves, segment_stretch};
use crate::model::{Frame, Network};

/// A number for each pass, that holds for the segment from that pass to the next of its yarn.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name, for instance `tension`.
    pub name: String,
    /// Unit, for instance `N`; empty for a pure number.
    pub unit: String,
    /// Values, indexed by pass.
    pub values: Vec<f64>,
}

/// The yarns of a fabric at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Simulated time \[s\].
    pub time: f64,
    /// Centre lines, one per yarn.
    pub curves: Vec<Curve>,
    /// Numbers along the yarns.
    pub fields: Vec<Field>,
}

impl Snapshot {
    /// Draws a frame, with the stretch of its segments as a field.
    ///
    /// # Panics
    /// If the frame does not belong to the network, as [`curves`].
    #[must_use]
    pub fn of(network: &Network, frame: &Frame, settings: &CurveSettings) -> Self {
        Self {
            time: frame.time,
            curves: curves(network, frame, settings),
            fields: vec![Field {
                name: "stretch".into(),
                unit: String::new(),
                values: segment_stretch(network, frame, settings.periods),
            }],
        }
    }

    /// The yarns that can be drawn (two points or more), with their numbers in the fabric.
    pub fn drawn(&self) -> impl Iterator<Item = (u32, &Curve)> {
        (0..).zip(&self.curves).filter(|(_, c)| c.points.len() >= 2)
    }

    /// Refuses numbers that are not finite and lists that do not fit together.
    ///
    /// # Errors
    /// [`ExportError::NotFinite`], [`ExportError::Inconsistent`].
    pub fn check(&self) -> Result<(), ExportError> {
        let not_finite = |what: String| Err(ExportError::NotFinite { what });
        if !self.time.is_finite() {
            return not_finite("the time of a frame".into());
        }
        for (yarn, curve) in self.curves.iter().enumerate() {
            let n = curve.points.len();
            if curve.arc_length.len() != n || curve.pass.len() != n {
                return Err(ExportError::Inconsistent(format!(
                    "yarn {yarn} has {n} points, {} arc lengths and {} passes",
                    curve.arc_length.len(),
                    curve.pass.len()
                )));
            }
            // Exports are in single precision: what overflows there is as bad as infinity here.
            let single = |x: f64| (x as f32).is_finite();
            let fits = |p: &DVec3| p.to_array().into_iter().all(single);
            if let Some(i) = curve.points.iter().position(|p| !fits(p)) {
                return not_finite(format!("point {i} of yarn {yarn} at {} s", self.time));
            }
            if let Some(i) = curve.arc_length.iter().position(|u| !single(*u)) {
                return not_finite(format!("arc length {i} of yarn {yarn} at {} s", self.time));
            }
            if !(single(curve.radius) && curve.radius > 0.0) {
                return Err(ExportError::Inconsistent(format!("yarn {yarn} has the radius {} m", curve.radius)));
            }
            let last = curve.pass.iter().max().map_or(0, |p| *p as usize + 1);
            if let Some(field) = self.fields.iter().find(|f| f.values.len() < last) {
                return Err(ExportError::Inconsistent(format!(
                    "field `{}` has {} values, yarn {yarn} needs {last}",
                    field.name,
                    field.values.len()
                )));
            }
        }
        for field in &self.fields {
            if let Some(i) = field.values.iter().position(|v| !(*v as f32).is_finite()) {
                return not_finite(format!("`{}` of pass {i} at {} s", field.name, self.time));
            }
        }
        Ok(())
    }
}

/// Snapshots that can be asked for one at a time, and again: a run too long for memory is written all the same.
pub trait Snapshots {
    /// How many there are.
    fn count(&self) -> usize;
    /// One of them, counted from zero, in order of time.
    ///
    /// # Errors
    /// Whatever keeps the snapshot from being read.
    fn snapshot(&mut self, index: usize) -> Result<Snapshot, Box<dyn Error + Send + Sync>>;
}

impl Snapshots for Vec<Snapshot> {
    fn count(&self) -> usize {
        self.len()
    }
    fn snapshot(&mut self, index: usize) -> Result<Snapshot, Box<dyn Error + Send + Sync>> {
        self.get(index).cloned().ok_or_else(|| format!("there are {} frames", self.len()).into())
    }
}

/// Snapshots drawn from frames that a function reads.
pub struct FrameSnapshots<'a, R> {
    /// The fabric.
    pub network: &'a Network,
    /// How to draw it.
    pub settings: CurveSettings,
    /// Number of frames.
    pub count: usize,
    /// Reads a frame, counted from zero.
    pub read: R,
}

impl<R> Snapshots for FrameSnapshots<'_, R>
where
    R: FnMut(usize) -> Result<Frame, Box<dyn Error + Send + Sync>>,
{
    fn count(&self) -> usize {
        self.count
    }
    fn snapshot(&mut self, index: usize) -> Result<Snapshot, Box<dyn Error + Send + Sync>> {
        let frame = (self.read)(index)?;
        if frame.positions.len() != self.network.node_count() || frame.sliding.len() != self.network.pass_count() {
            return Err("the frame belongs to another fabric".into());
        }
        Ok(Snapshot::of(self.network, &frame, &self.settings))
    }
}

/// A checked snapshot.
pub(super) fn checked(snapshots: &mut dyn Snapshots, index: usize) -> Result<Snapshot, ExportError> {
    let snapshot = snapshots.snapshot(index).map_err(|source| ExportError::Frame { index, source })?;
    snapshot.check()?;
    Ok(snapshot)
}
