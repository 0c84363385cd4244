//! A fabric with everything that acts on it: all terms of the energy, summed in parallel.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::block_pattern::BlockPattern;

use super::chunks::Chunks;
use super::terms::{AnyTerm, ChunkOutput, Term, Width};
use super::workspace::Workspace;
use crate::contact::{Compression, Nearby, Strands};
use crate::energy::{
    AnchoredSpring, Bending, Element, Foundation, Gravity, Inertia, LegContact, Load, ObstacleContact, ParallelSpring,
    Rate, SelfContact, Shear, Spacing, StitchLength, StrandContact, Stretch, Thick, Wrapping,
};
use crate::fabric::coordinates::{BLOCK, dof};
use crate::fabric::elements::Elements;
use crate::fabric::{Coordinates, Mechanics};
use crate::model::{FabricCard, Network, NodeId, PassId, SegmentKind, Yarns};

/// A fabric as the solvers see it.
pub struct System {
    /// Where coordinates lie.
    pub coordinates: Coordinates,
    /// The yarns.
    pub yarns: Yarns,
    /// The fabric card.
    pub card: FabricCard,
    /// Radius of the thickest yarn at each node \[m\], and of the thinnest of all, by which tolerances are measured.
    pub(super) radius_at_node: Vec<f64>,
    pub(super) least_radius: f64,
    /// Stiffness damping `β` \[s\], that of the first yarn unless it was set.
    pub(super) stiffness_damping: f64,
    /// Whether each segment is a cast-on or bind-off, a chain of loops.
    pub(super) chained: Vec<bool>,
    pub(super) chunks: Chunks,
    pub(super) pattern: Arc<BlockPattern>,
    /// Segments of yarn.
    pub(super) segments: Term<((Stretch, Gravity), Inertia), 8>,
    pub(super) bends: Term<(Bending, Rate), 12>,
    /// Yarns with a thickness: their segments, bends and legs, in place of the stiffness of those above.
    pub(super) thick_segments: Term<Thick<Stretch, 2>, 26>,
    /// Stretch stiffness of both while they have a share of it; empty otherwise.
    pub(super) full_stiffness: Vec<f64>,
    pub(super) thick_bends: Term<Thick<(Bending, Rate), 3>, 39>,
    pub(super) legs: Term<Thick<LegContact, 4>, 52>,
    pub(super) facing: Term<LegContact, 16>,
    pub(super) wraps: Term<(Wrapping, Rate), 12>,
    pub(super) stitch_length: Term<StitchLength, 2>,
    pub(super) spacing: Term<Spacing, 2>,
    pub(super) shear: Term<Shear, 9>,
    pub(super) friction: Term<AnchoredSpring, 1>,
    /// Friction of parallel yarns in stacks, in the order of [`Compression::parallel`].
    pub(super) parallel: Term<ParallelSpring, 2>,
    pub(super) obstacles: Term<ObstacleContact, 3>,
    pub(super) self_contacts: Term<SelfContact, 6>,
    pub(super) strand_contacts: Term<StrandContact, 12>,
    pub(super) loads: Term<Load, 3>,
    pub(super) bed: Term<Foundation, 1>,
    pub(super) compression: Compression,
    /// Pass, contact and coefficient of friction of each friction element.
    pub(super) rubbing: Vec<(PassId, usize, f64)>,
    /// Coefficient of friction of each pair of parallel yarns.
    pub(super) parallel_friction: Vec<f64>,
    /// Rest length \[m\] and mass \[kg\] of the yarn that belongs to each node in the initial layout.
    pub(super) yarn_at_node: Vec<f64>,
    pub(super) mass_at_node: Vec<f64>,
    /// Where the nodes are held by their neighbours, in the layout \[m\], and who has come near whom since.
    pub(super) layout: Vec<DVec3>,
    pub(super) nearby: Nearby,
    pub(super) strands: Strands,
    /// Planar places of blocks for a coarse space: columns and rows of the chart.
    pub(super) chart_place: Vec<[f64; 2]>,
}

/// Number of terms.
pub(super) const TERMS: usize = 17;

/// Name and energy \[J\] of every kind, in the order of reports.
pub type Energies = [(&'static str, f64); KINDS.len()];

/// Kinds of energy, in the order of reports.
const KINDS: [&str; 16] = [
    Stretch::NAME,
    Bending::NAME,
    LegContact::NAME,
    Wrapping::NAME,
    StitchLength::NAME,
    Spacing::NAME,
    Shear::NAME,
    Gravity::NAME,
    Load::NAME,
    Foundation::NAME,
    Inertia::NAME,
    AnchoredSpring::NAME,
    Rate::NAME,
    ObstacleContact::NAME,
    SelfContact::NAME,
    StrandContact::NAME,
];

impl System {
    /// Sets up a fabric without gravity, obstacles or loads.
    #[must_use]
    pub fn new(network: &Network, yarns: impl Into<Yarns>, card: impl Into<FabricCard>) -> Self {
        let (yarns, card) = (yarns.into(), card.into());
        let mut coordinates = Coordinates::new(network);
        let mechanics = Mechanics::new(network, &yarns, &card, &mut coordinates);
        let chunks = Chunks::new(coordinates.block_count());
        let yarn_of = network.pass_yarn();
        let material = |pass: PassId| yarns.of(network.yarn_kind[yarn_of[pass.index()].index()]);
        // The model's yarn is shorter than the real one, so that a metre of it weighs more.
        let densities: Vec<f64> = mechanics
            .segment_after
            .iter()
            .map(|&pass| {
                let role = network.yarn_role[yarn_of[pass.index()].index()];
                material(pass).linear_density / card.path_ratio(role)
            })
            .collect();
        let weightless = Gravity { weight: [0.0; 3] };
        let mut density = densities.iter();
        let segments = mechanics.stretch.map(|stretch| {
            let density = density.next().copied().unwrap_or(0.0);
            ((stretch, weightless), Inertia { density, factor: 0.0, direction: [0.0; 3], target: [0.0; 8] })
        });
        let bends = mechanics.bending.map(|bending| (bending, Rate::NONE));
        let thick_bends = mechanics.thick.bending.map(|thick| thick.with((thick.inner, Rate::NONE)));
        let wraps = mechanics.wrapping.map(|wrapping| (wrapping, Rate::NONE));
        let compression = Compression::new(network, &yarns, &card, &coordinates);
        // Two yarns rub with the mean of what each is said to rub with against its like.
        let rubs = |pass: PassId| {
            let stack = network.stack(network.pass_node[pass.index()]);
            let others: Vec<f64> = stack
                .iter()
                .filter(|&&other| other != pass)
                .map(|&other| material(other).friction_coefficient)
                .collect();
            0.5 * (material(pass).friction_coefficient + others.iter().sum::<f64>() / others.len().max(1) as f64)
        };
        let mut friction = Elements::default();
        let mut rubbing = Vec::new();
        let spring = AnchoredSpring { stiffness: card.anchor_stiffness(), limit: 0.0, anchor: 0.0 };
        for p in 0..network.pass_count() {
            let pass = PassId::new(p);
            if let (true, Some(contact)) = (network.slides(pass), compression.contact_of(pass)) {
                friction.push(spring, [dof(coordinates.slot(pass))]);
                rubbing.push((pass, contact, rubs(pass)));
            }
        }
        let mut parallel = Elements::default();
        let mut parallel_friction = Vec::new();
        for (_, pair) in compression.parallel() {
            parallel.push(ParallelSpring(spring), pair.map(|pass| dof(coordinates.slot(pass))));
            parallel_friction.push(0.5 * pair.iter().map(|&pass| material(pass).friction_coefficient).sum::<f64>());
        }
        let mut yarn_at_node = vec![0.0; network.node_count()];
        let mut mass_at_node = vec![0.0; network.node_count()];
        let initial = coordinates.initial(network);
        for (stencil, density) in segments.stencils.iter().zip(&densities) {
            let rest = initial[stencil[7] as usize] - initial[stencil[3] as usize];
            for end in [0, 4] {
                yarn_at_node[stencil[end] as usize / BLOCK] += 0.5 * rest;
                mass_at_node[stencil[end] as usize / BLOCK] += 0.5 * rest * density;
            }
        }
        let radius_at_node = (0..network.node_count())
            .map(|node| network.stack(NodeId::new(node)).iter().map(|&pass| material(pass).radius).fold(0.0, f64::max));
        let radius_at_node = radius_at_node.collect();
        let least_radius = network.yarn_kind.iter().map(|&kind| yarns.of(kind).radius).fold(f64::INFINITY, f64::min);
        let chain = |&pass: &PassId| network.segment_kind[pass.index()] == SegmentKind::Chain;
        let mut chart_place = network.chart_place.clone();
        chart_place.resize(coordinates.block_count(), [0.0; 2]);
        let mut system = Self {
            radius_at_node,
            least_radius,
            stiffness_damping: yarns.first().stiffness_damping,
            chained: mechanics.segment_after.iter().map(chain).collect(),
            parallel_friction,
            mass_at_node,
            shear: Term::new(mechanics.shear, &chunks),
            yarns,
            card,
            pattern: Arc::new(BlockPattern::from_pairs(0, [])),
            segments: Term::new(segments, &chunks),
            bends: Term::new(bends, &chunks),
            thick_segments: Term::new(mechanics.thick.stretch, &chunks),
            full_stiffness: Vec::new(),
            thick_bends: Term::new(thick_bends, &chunks),
            legs: Term::new(mechanics.thick.legs, &chunks),
            facing: Term::new(mechanics.thick.facing, &chunks),
            wraps: Term::new(wraps, &chunks),
            stitch_length: Term::new(mechanics.stitch_length, &chunks),
            spacing: Term::new(mechanics.spacing, &chunks),
            friction: Term::new(friction, &chunks),
            parallel: Term::new(parallel, &chunks),
            obstacles: Term::new(Elements::default(), &chunks),
            self_contacts: Term::new(Elements::default(), &chunks),
            strand_contacts: Term::new(Elements::default(), &chunks),
            nearby: Nearby::default(),
            strands: Strands::default(),
            layout: network.places_held(),
            loads: Term::new(Elements::default(), &chunks),
            bed: Term::new(Elements::default(), &chunks),
            compression,
            rubbing,
            yarn_at_node,
            chart_place,
            chunks,
            coordinates,
        };
        let mut pairs = Vec::new();
        for term in system.terms() {
            term.pairs(&mut |a, b| pairs.push((a, b)));
        }
        system.pattern = Arc::new(BlockPattern::from_pairs(system.coordinates.block_count(), pairs));
        system.segments.locate(&system.pattern);
        system.bends.locate(&system.pattern);
        system.thick_segments.locate(&system.pattern);
        system.thick_bends.locate(&system.pattern);
        system.legs.locate(&system.pattern);
        system.facing.locate(&system.pattern);
        system.wraps.locate(&system.pattern);
        system.stitch_length.locate(&system.pattern);
        system.spacing.locate(&system.pattern);
        system.shear.locate(&system.pattern);
        system.friction.locate(&system.pattern);
        system.parallel.locate(&system.pattern);
        system
    }

    /// Sets gravity \[m/s²\].
    pub fn set_gravity(&mut self, gravity: DVec3) {
        for ((_, weight), inertia) in &mut self.segments.set.elements {
            weight.weight = (gravity * inertia.density).to_array();
        }
    }

    /// Sets the stiffness damping `β` \[s\] of the steps to come.
    pub fn set_stiffness_damping(&mut self, beta: f64) {
        self.stiffness_damping = beta;
    }

    /// The sparsity of the matrix.
    #[must_use]
    pub fn pattern(&self) -> &Arc<BlockPattern> {
        &self.pattern
    }

    /// Node places on the chart, one per block.
    #[must_use]
    pub fn chart_place(&self) -> &[[f64; 2]] {
        &self.chart_place
    }

    pub(super) fn terms(&self) -> [&dyn AnyTerm; TERMS] {
        [
            &self.segments,
            &self.bends,
            &self.thick_segments,
            &self.thick_bends,
            &self.legs,
            &self.facing,
            &self.wraps,
            &self.stitch_length,
            &self.spacing,
            &self.shear,
            &self.friction,
            &self.parallel,
            &self.obstacles,
            &self.self_contacts,
            &self.strand_contacts,
            &self.loads,
            &self.bed,
        ]
    }

    /// Total energy \[J\].
    pub fn energy(&self, q: &[f64], work: &mut Workspace) -> f64 {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            work.energy = self.terms().iter().map(|term| term.chunk_energy(work.chunk, q)).sum();
        });
        work.chunks.iter().map(|work| work.energy).sum()
    }

    /// Energy by kind \[J\], in a fixed order.
    pub fn energies(&self, q: &[f64], work: &mut Workspace) -> Energies {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            work.by_kind.clear();
            for term in self.terms() {
                term.chunk_parts(work.chunk, q, &mut |kind, energy| add_to_kind(&mut work.by_kind, kind, energy));
            }
        });
        KINDS.map(|kind| {
            let of_kind = work.chunks.iter().flat_map(|work| &work.by_kind).filter(|(name, _)| *name == kind);
            (kind, of_kind.map(|(_, energy)| energy).sum())
        })
    }

    /// Energy \[J\] and gradient.
    pub fn gradient(&self, q: &[f64], gradient: &mut [f64], work: &mut Workspace) -> f64 {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            let rows = self.chunks.rows(work.chunk);
            work.gradient.fill(0.0);
            let mut out = ChunkOutput { rows, gradient: &mut work.gradient, matrix: None };
            work.energy = self.terms().iter().map(|term| term.accumulate(work.chunk, q, 1.0, &mut out)).sum();
        });
        work.collect(&self.chunks, gradient)
    }

    /// Energy \[J\], gradient, and a matrix of second derivatives between the exact (`convexity = 0`) and the positive
    /// semi-definite one (`convexity = 1`).
    pub fn linearise<T: Width>(
        &self,
        q: &[f64],
        convexity: f64,
        gradient: &mut [f64],
        matrix: &mut BlockMatrix<T>,
        work: &mut Workspace,
    ) -> f64 {
        work.prepare(&self.chunks);
        matrix.for_each_row_chunk(self.chunks.bounds(), &mut work.chunks, |work, mut rows| {
            rows.clear();
            work.gradient.fill(0.0);
            let mut out = ChunkOutput {
                rows: self.chunks.rows(work.chunk),
                gradient: &mut work.gradient,
                matrix: Some(T::rows(&mut rows)),
            };
            work.energy = self.terms().iter().map(|term| term.accumulate(work.chunk, q, convexity, &mut out)).sum();
        });
        work.collect(&self.chunks, gradient)
    }

    /// The longest part of a step along which no segment's rest length falls below a tenth of what it is.
    #[must_use]
    pub fn longest_step(&self, q: &[f64], direction: &[f64]) -> f64 {
        let segments = self.segments.set.stencils.par_iter().with_min_len(4096);
        let longest = segments.map(|stencil| longest_step(stencil, q, |dof| direction[dof]));
        longest.reduce(|| f64::INFINITY, f64::min).min(self.longest_way(q, direction))
    }

    /// As [`System::longest_step`], for some segments.
    pub(super) fn longest_step_of(&self, segments: &[u32], q: &[f64], direction: impl Fn(usize) -> f64) -> f64 {
        let stencils = segments.iter().map(|&index| &self.segments.set.stencils[index as usize]);
        stencils.map(|stencil| longest_step(stencil, q, &direction)).fold(1.0, f64::min)
    }

    /// Largest ratio of a yarn segment's length to its rest length (a cast-on or bind-off is not one yarn), and smallest
    /// rest length \[m\].
    #[must_use]
    pub fn extremes(&self, q: &[f64]) -> (f64, f64) {
        let thick = &self.thick_segments.set;
        let of = |(index, &chained): (usize, &bool)| {
            let ends = match thick.elements.get(index) {
                Some(element) => element.points(&thick.local(index, q)),
                None => self.segments.set.local(index, q),
            };
            let rest = ends[7] - ends[3];
            let length = (0..3).map(|k| (ends[4 + k] - ends[k]).powi(2)).sum::<f64>().sqrt();
            let ratio = if chained { 1.0 } else { length / rest };
            (ratio, rest)
        };
        let segments = self.chained.par_iter().enumerate().with_min_len(4096);
        segments.map(of).reduce(|| (0.0, f64::INFINITY), |a, b| (a.0.max(b.0), a.1.min(b.1)))
    }

    /// Bytes held by terms and pattern.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let terms: usize = self.terms().iter().map(|term| term.bytes()).sum();
        terms + self.pattern.block_count() * 4 + self.compression.len() * 64
    }

    /// Radius of the thinnest yarn \[m\], by which tolerances are measured.
    #[must_use]
    pub fn least_radius(&self) -> f64 {
        self.least_radius
    }

    /// Stiffness damping `β` \[s\] of the steps to come.
    #[must_use]
    pub fn stiffness_damping(&self) -> f64 {
        self.stiffness_damping
    }

    /// Mass of all yarn \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass_at_node.iter().sum()
    }

    /// Rest length of yarn at a node in the initial layout \[m\].
    #[must_use]
    pub fn yarn_at(&self, node: NodeId) -> f64 {
        self.yarn_at_node[node.index()]
    }
}

/// The longest part of a step along which a segment keeps a tenth of its rest length.
fn longest_step(stencil: &[u32; 8], q: &[f64], direction: impl Fn(usize) -> f64) -> f64 {
    let (a, b) = (stencil[3] as usize, stencil[7] as usize);
    let rate = direction(b) - direction(a);
    if rate < 0.0 { 0.9 * (q[b] - q[a]) / -rate } else { f64::INFINITY }
}

fn add_to_kind(sums: &mut Vec<(&'static str, f64)>, kind: &'static str, energy: f64) {
    match sums.iter_mut().find(|(name, _)| *name == kind) {
        Some((_, sum)) => *sum += energy,
        None => sums.push((kind, energy)),
    }
}
