//! A fabric with everything that acts on it: all terms of the energy, summed in parallel.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::block_pattern::BlockPattern;

use super::terms::{AnyTerm, ChunkOutput, Chunks, Term};
use crate::contact::Compression;
use crate::energy::{
    AnchoredSpring, BendRate, Bending, Foundation, Gravity, Inertia, Load, ObstacleContact, Spacing, StitchLength,
    Stretch, StretchRate, WrapRate, Wrapping,
};
use crate::fabric::coordinates::{BLOCK, dof};
use crate::fabric::elements::{Elements, Linearisation};
use crate::fabric::{Coordinates, Mechanics};
use crate::model::{FabricCard, Network, NodeId, PassId, YarnCard};

/// Which terms take part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Terms {
    /// All: a time step.
    Dynamic,
    /// Elastic energies, gravity, loads and the bed: equilibrium without friction.
    Elastic,
}

/// A fabric as the solvers see it.
pub struct System {
    /// Where coordinates lie.
    pub coordinates: Coordinates,
    /// The yarn, its linear density that of the model's yarn.
    pub yarn: YarnCard,
    /// The fabric card.
    pub card: FabricCard,
    pub(super) chunks: Chunks,
    pattern: Arc<BlockPattern>,
    pub(super) stretch: Term<Stretch, 8>,
    pub(super) bending: Term<Bending, 12>,
    pub(super) wrapping: Term<Wrapping, 12>,
    pub(super) stitch_length: Term<StitchLength, 2>,
    pub(super) spacing: Term<Spacing, 2>,
    pub(super) gravity: Term<Gravity, 8>,
    pub(super) inertia: Term<Inertia, 8>,
    pub(super) friction: Term<AnchoredSpring, 1>,
    pub(super) stretch_rate: Term<StretchRate, 8>,
    pub(super) bend_rate: Term<BendRate, 12>,
    pub(super) wrap_rate: Term<WrapRate, 12>,
    pub(super) obstacles: Term<ObstacleContact, 3>,
    pub(super) loads: Term<Load, 3>,
    pub(super) bed: Term<Foundation, 1>,
    pub(super) compression: Compression,
    /// Pass and contact of each friction element.
    pub(super) rubbing: Vec<(PassId, usize)>,
    /// Rest length of yarn that belongs to each node in the initial layout \[m\].
    pub(super) yarn_at_node: Vec<f64>,
    /// Planar places of blocks for a coarse space: columns and rows of the chart.
    pub(super) chart_place: Vec<[f64; 2]>,
}

/// Scratch memory of sums.
#[derive(Default)]
pub struct Workspace {
    chunks: Vec<ChunkWork>,
}

#[derive(Default)]
struct ChunkWork {
    chunk: usize,
    gradient: Vec<f64>,
    energy: f64,
    by_term: [f64; MOST_TERMS],
}

/// Most kinds of terms.
const MOST_TERMS: usize = 16;

impl System {
    /// Sets up a fabric without gravity, obstacles or loads.
    #[must_use]
    pub fn new(network: &Network, yarn: &YarnCard, card: &FabricCard) -> Self {
        let mut coordinates = Coordinates::new(network);
        let mechanics = Mechanics::new(network, yarn, card, &mut coordinates);
        let chunks = Chunks::new(coordinates.block_count());
        let segments = &mechanics.stretch.stencils;
        let same = |count: usize| vec![(); count];
        let gravity = Elements {
            elements: same(segments.len()).iter().map(|()| Gravity { weight: [0.0; 3] }).collect(),
            stencils: segments.clone(),
        };
        let still = Inertia { factor: 0.0, direction: [0.0; 3], target: [0.0; 8] };
        let inertia = Elements { elements: vec![still; segments.len()], stencils: segments.clone() };
        let compression = Compression::new(network, &coordinates);
        let mut friction = Elements::default();
        let mut rubbing = Vec::new();
        for p in 0..network.pass_count() {
            let pass = PassId::new(p);
            if let (true, Some(contact)) = (network.pass_slides[p], compression.contact_of(pass)) {
                let slot = dof(coordinates.slot(pass));
                friction.push(AnchoredSpring { stiffness: card.anchor_stiffness, limit: 0.0, anchor: 0.0 }, [slot]);
                rubbing.push((pass, contact));
            }
        }
        let mut yarn_at_node = vec![0.0; network.node_count()];
        let initial = coordinates.initial(network);
        for stencil in segments {
            let rest = initial[stencil[7] as usize] - initial[stencil[3] as usize];
            for end in [0, 4] {
                yarn_at_node[stencil[end] as usize / BLOCK] += 0.5 * rest;
            }
        }
        let mut chart_place = network.chart_place.clone();
        chart_place.resize(coordinates.block_count(), [0.0; 2]);
        let mut system = Self {
            // The model's yarn is shorter than the real one, so that a metre of it weighs more.
            yarn: YarnCard { linear_density: yarn.linear_density / card.path_ratio, ..yarn.clone() },
            card: card.clone(),
            pattern: Arc::new(BlockPattern::from_pairs(0, [])),
            stretch: Term::new(mechanics.stretch, &chunks),
            bending: Term::new(mechanics.bending, &chunks),
            wrapping: Term::new(mechanics.wrapping, &chunks),
            stitch_length: Term::new(mechanics.stitch_length, &chunks),
            spacing: Term::new(mechanics.spacing, &chunks),
            gravity: Term::new(gravity, &chunks),
            inertia: Term::new(inertia, &chunks),
            friction: Term::new(friction, &chunks),
            stretch_rate: Term::new(Elements::default(), &chunks),
            bend_rate: Term::new(Elements::default(), &chunks),
            wrap_rate: Term::new(Elements::default(), &chunks),
            obstacles: Term::new(Elements::default(), &chunks),
            loads: Term::new(Elements::default(), &chunks),
            bed: Term::new(Elements::default(), &chunks),
            compression,
            rubbing,
            yarn_at_node,
            chart_place,
            chunks,
            coordinates,
        };
        system.set_stiffness_damping(yarn.stiffness_damping);
        let mut pairs = Vec::new();
        for term in system.terms(Terms::Dynamic) {
            term.pairs(&mut |a, b| pairs.push((a, b)));
        }
        system.pattern = Arc::new(BlockPattern::from_pairs(system.coordinates.block_count(), pairs));
        system
    }

    /// Sets gravity \[m/s²\].
    pub fn set_gravity(&mut self, gravity: DVec3) {
        let weight = (gravity * self.yarn.linear_density).to_array();
        for element in &mut self.gravity.set.elements {
            element.weight = weight;
        }
    }

    /// Sets the stiffness damping `β` \[s\].
    pub fn set_stiffness_damping(&mut self, beta: f64) {
        self.yarn.stiffness_damping = beta;
        let wanted = beta > 0.0;
        if wanted == self.stretch_rate.set.is_empty() {
            let count = |n: usize| if wanted { n } else { 0 };
            let (segments, bends) = (&self.stretch.set.stencils, &self.bending.set.stencils);
            let rate = StretchRate { stiffness: 0.0, previous: 1.0 };
            let elements = vec![rate; count(segments.len())];
            self.stretch_rate.set = Elements { elements, stencils: segments[..count(segments.len())].to_vec() };
            let rate = BendRate { stiffness: 0.0, previous: 1.0 };
            let elements = vec![rate; count(bends.len())];
            self.bend_rate.set = Elements { elements, stencils: bends[..count(bends.len())].to_vec() };
            let wraps = &self.wrapping.set;
            self.wrap_rate.set = Elements {
                elements: wraps.elements[..count(wraps.len())].iter().map(|&wrap| WrapRate { wrap }).collect(),
                stencils: wraps.stencils[..count(wraps.len())].to_vec(),
            };
            self.stretch_rate.plan(&self.chunks);
            self.bend_rate.plan(&self.chunks);
            self.wrap_rate.plan(&self.chunks);
        }
    }

    /// Lays the fabric on an elastic bed at a height \[m\] of stiffness \[N/m\] a node; zero takes it away.
    pub fn set_bed(&mut self, stiffness: f64, height: f64) {
        self.bed.set = Elements::default();
        if stiffness > 0.0 {
            for node in 0..self.coordinates.node_count() {
                self.bed.set.push(Foundation { stiffness, place: height }, [dof(BLOCK * node + 2)]);
            }
        }
        self.bed.plan(&self.chunks);
    }

    /// Adds a load; [`System::plan_loads`] must follow the last.
    pub fn push_load(&mut self, load: Load, stencil: [u32; 3]) {
        self.loads.set.push(load, stencil);
    }

    /// Plans the loads that were added.
    pub fn plan_loads(&mut self) {
        self.loads.plan(&self.chunks);
    }

    /// Number of loads.
    #[must_use]
    pub fn load_count(&self) -> usize {
        self.loads.set.len()
    }

    /// Sets every load from its node and the length of yarn there \[m\].
    pub fn renew_loads(&mut self, load: impl Fn(usize, f64) -> Load) {
        for (element, stencil) in self.loads.set.elements.iter_mut().zip(&self.loads.set.stencils) {
            let node = stencil[0] as usize / BLOCK;
            *element = load(node, self.yarn_at_node[node]);
        }
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

    fn terms(&self, terms: Terms) -> impl Iterator<Item = &dyn AnyTerm> {
        let elastic: [&dyn AnyTerm; 8] = [
            &self.stretch,
            &self.bending,
            &self.wrapping,
            &self.stitch_length,
            &self.spacing,
            &self.gravity,
            &self.loads,
            &self.bed,
        ];
        let dynamic: [&dyn AnyTerm; 6] =
            [&self.inertia, &self.friction, &self.stretch_rate, &self.bend_rate, &self.wrap_rate, &self.obstacles];
        let count = if terms == Terms::Dynamic { dynamic.len() } else { 0 };
        elastic.into_iter().chain(dynamic.into_iter().take(count))
    }

    /// Total energy \[J\].
    pub fn energy(&self, terms: Terms, q: &[f64], work: &mut Workspace) -> f64 {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            work.energy = self.terms(terms).map(|term| term.chunk_energy(work.chunk, q)).sum();
        });
        work.chunks.iter().map(|work| work.energy).sum()
    }

    /// Energy by kind \[J\], in a fixed order.
    pub fn energies(&self, q: &[f64], work: &mut Workspace) -> Vec<(&'static str, f64)> {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            for (k, term) in self.terms(Terms::Dynamic).enumerate() {
                work.by_term[k] = term.chunk_energy(work.chunk, q);
            }
        });
        let sum = |k: usize| work.chunks.iter().map(|work| work.by_term[k]).sum();
        self.terms(Terms::Dynamic).enumerate().map(|(k, term)| (term.name(), sum(k))).collect()
    }

    /// Energy \[J\] and gradient.
    pub fn gradient(&self, terms: Terms, q: &[f64], gradient: &mut [f64], work: &mut Workspace) -> f64 {
        work.prepare(&self.chunks);
        work.chunks.par_iter_mut().for_each(|work| {
            let rows = self.chunks.rows(work.chunk);
            work.gradient.fill(0.0);
            let mut out = ChunkOutput { rows, gradient: &mut work.gradient, matrix: None };
            work.energy =
                self.terms(terms).map(|term| term.accumulate(work.chunk, q, Linearisation::CONVEX, &mut out)).sum();
        });
        work.collect(&self.chunks, gradient)
    }

    /// Energy \[J\], gradient, and matrix of second derivatives.
    pub fn linearise(
        &self,
        terms: Terms,
        linearisation: Linearisation,
        q: &[f64],
        gradient: &mut [f64],
        matrix: &mut BlockMatrix,
        work: &mut Workspace,
    ) -> f64 {
        work.prepare(&self.chunks);
        matrix.for_each_row_chunk(self.chunks.bounds(), &mut work.chunks, |work, mut rows| {
            rows.clear();
            work.gradient.fill(0.0);
            let mut out = ChunkOutput {
                rows: self.chunks.rows(work.chunk),
                gradient: &mut work.gradient,
                matrix: Some(&mut rows),
            };
            work.energy = self.terms(terms).map(|term| term.accumulate(work.chunk, q, linearisation, &mut out)).sum();
        });
        work.collect(&self.chunks, gradient)
    }

    /// The longest part of a step along which no segment's rest length falls below a tenth of what it is.
    #[must_use]
    pub fn longest_step(&self, q: &[f64], direction: &[f64]) -> f64 {
        self.stretch
            .set
            .stencils
            .par_iter()
            .with_min_len(4096)
            .map(|stencil| {
                let (a, b) = (stencil[3] as usize, stencil[7] as usize);
                let rate = direction[b] - direction[a];
                if rate < 0.0 { 0.9 * (q[b] - q[a]) / -rate } else { f64::INFINITY }
            })
            .reduce(|| f64::INFINITY, f64::min)
            .min(1.0)
    }

    /// Largest ratio of a segment's length to its rest length, and smallest rest length \[m\].
    #[must_use]
    pub fn extremes(&self, q: &[f64]) -> (f64, f64) {
        self.stretch
            .set
            .stencils
            .par_iter()
            .with_min_len(4096)
            .map(|stencil| {
                let at = |k: usize| q[stencil[k] as usize];
                let rest = at(7) - at(3);
                let length = ((at(4) - at(0)).powi(2) + (at(5) - at(1)).powi(2) + (at(6) - at(2)).powi(2)).sqrt();
                (length / rest, rest)
            })
            .reduce(|| (0.0, f64::INFINITY), |a, b| (a.0.max(b.0), a.1.min(b.1)))
    }

    /// Bytes held by terms and pattern.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let terms: usize = self.terms(Terms::Dynamic).map(AnyTerm::bytes).sum();
        terms + self.pattern.block_count() * 4 + self.compression.len() * 64
    }

    /// Rest length of yarn at a node in the initial layout \[m\].
    #[must_use]
    pub fn yarn_at(&self, node: NodeId) -> f64 {
        self.yarn_at_node[node.index()]
    }
}

impl Workspace {
    fn prepare(&mut self, chunks: &Chunks) {
        if self.chunks.len() != chunks.count() {
            self.chunks = (0..chunks.count())
                .map(|chunk| ChunkWork {
                    chunk,
                    gradient: vec![0.0; BLOCK * chunks.rows(chunk).len()],
                    energy: 0.0,
                    by_term: [0.0; MOST_TERMS],
                })
                .collect();
        }
    }

    /// Copies the rows' gradients together; the energies are added in the order of chunks.
    fn collect(&self, chunks: &Chunks, gradient: &mut [f64]) -> f64 {
        for work in &self.chunks {
            let rows = chunks.rows(work.chunk);
            gradient[BLOCK * rows.start..BLOCK * rows.end].copy_from_slice(&work.gradient);
        }
        self.chunks.iter().map(|work| work.energy).sum()
    }
}
