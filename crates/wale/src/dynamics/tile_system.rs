//! The energy of a periodic tile by its unknowns, and its second derivatives as a block-sparse matrix with the two numbers of
//! its plane beside it.

use wale_numerics::bordered::Bordered;
use wale_numerics::sparse_cholesky::CholeskyError;
use wale_numerics::trust::Foreseen;

use super::strands::{PART, first_meeting};
use super::tile_conditions::Conditions;
use super::tile_contacts::Contacts;
use super::tile_equilibrium::TileSettings;
use super::tile_places::places_of;
use super::tile_stiffness::bending_and_length;
use crate::energy::Foundation;
use crate::energy::friction::AnchoredSpring;
use crate::fabric::coordinates::{BLOCK, Dof, dof};
use crate::fabric::elements::{ElementSet, Elements};
use crate::fabric::{Mechanics, TileCoordinates};
use crate::model::{FabricCard, Network, PassId, YarnId, Yarns};

/// A tile's elements over its unknowns: own slots, then the two numbers of its plane, the periods where it relaxes.
#[derive(Debug)]
pub(super) struct TileSystem {
    pub coordinates: TileCoordinates,
    mechanics: Mechanics,
    bed: Elements<Foundation, 1>,
    contacts: Contacts,
    rubbing: Elements<AnchoredSpring, 1>,
    /// What pulls at the numbers of the plane \[N\].
    pull: [f64; 2],
    /// Which own slots are unknowns; the others are held.
    free: Vec<bool>,
    second: Bordered,
    /// Where in the matrix the second derivatives of every element go, element by element.
    places: Vec<u32>,
    /// Gradient by the own slots and by the numbers of the plane \[N\], those that are held too.
    pub gradient: Vec<f64>,
    pub period_gradient: [f64; 2],
    /// Which numbers of the plane are held, and their columns, which then are not part of the system.
    held: [bool; 2],
    held_border: [Vec<f64>; 2],
    held_corner: [[f64; 2]; 2],
    world: Vec<f64>,
    /// What a shift counts on a period, for one on a slot: as much as the nodes that move with it.
    period_weight: f64,
}

/// What a system is made of besides the forces of a tile's own yarns.
#[derive(Debug, Default)]
pub(super) struct Around {
    /// Stiffness of the bed under every node \[N/m\].
    pub bed: f64,
    /// Which numbers of the plane are held.
    pub held: [bool; 2],
    /// Segments that hold each other off.
    pub contacts: Contacts,
    /// Friction of every contact.
    pub rubbing: Elements<AnchoredSpring, 1>,
    /// What pulls at the numbers of the plane \[N\].
    pub pull: [f64; 2],
}

impl TileSystem {
    /// The system of a tile as it is brought to rest with these settings: a knit with periods that are unknown, a weave at its sett.
    ///
    /// # Panics
    /// If the tile is too large for memory.
    pub fn of(network: &Network, yarns: &Yarns, card: &FabricCard, settings: &TileSettings) -> Self {
        Self::touching(network, yarns, card, settings, &Conditions::default(), |_| Contacts::default())
    }

    /// The same under other conditions and with contacts of segments, made over its coordinates.
    ///
    /// # Panics
    /// If the tile is too large for memory.
    pub fn touching(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        settings: &TileSettings,
        conditions: &Conditions,
        contacts: impl FnOnce(&mut TileCoordinates) -> Contacts,
    ) -> Self {
        let (bending, length) = bending_and_length(network, yarns, card);
        let bed = settings.bed * (bending / length.powi(3));
        let held = [card.woven().is_some() || conditions.width_held, card.woven().is_some()];
        let mut coordinates = TileCoordinates::new(network);
        let contacts = contacts(&mut coordinates);
        let rubbing = conditions.rubbing(network, &coordinates);
        let around = Around { bed, held, contacts, rubbing, pull: [0.0, conditions.pull] };
        Self::with(network, yarns, card, coordinates, around).expect("a tile fits in memory")
    }

    /// Over given coordinates.
    ///
    /// # Errors
    /// If the system is too large.
    pub fn with(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        mut coordinates: TileCoordinates,
        around: Around,
    ) -> Result<Self, CholeskyError> {
        let Around { bed, held, contacts, rubbing, pull } = around;
        let mechanics = Mechanics::new(network, yarns, card, &mut coordinates);
        let springs = self::bed(network, bed);
        // One node's place and one sliding coordinate of each yarn are held: the rigid motions, and nothing else. At the crossings of a
        // weave yarns do not slide: where nothing rubs, threads that are sheared gather in groups.
        let mut free = coordinates.own().free().to_vec();
        free[0] = false;
        free[1] = false;
        free[2] = bed > 0.0;
        for y in 0..network.yarn_count() {
            let first = PassId::new(network.yarn_passes(YarnId::new(y)).start);
            free[coordinates.own().slot(first)] = false;
        }
        for pass in network.crossings.iter().flat_map(|crossing| [crossing.warp, crossing.weft]) {
            free[coordinates.own().slot(pass)] = false;
        }
        let own = |dof: Dof| coordinates.source(dof).of as usize;
        let (pattern, places) =
            places_of(&sets(&mechanics, &springs, &contacts, &rubbing), coordinates.own().block_count(), own);
        let second = Bordered::new(pattern, &free)?;
        Ok(Self {
            gradient: vec![0.0; free.len()],
            period_gradient: [0.0; 2],
            held,
            held_border: [0, 1].map(|_| vec![0.0; if held == [false; 2] { 0 } else { free.len() }]),
            held_corner: [[0.0; 2]; 2],
            world: Vec::new(),
            period_weight: network.node_count() as f64 / 3.0,
            coordinates,
            mechanics,
            bed: springs,
            contacts,
            rubbing,
            pull,
            free,
            second,
            places,
        })
    }

    /// Energy \[J\].
    pub fn energy(&mut self, unknowns: &[f64]) -> f64 {
        let mut world = std::mem::take(&mut self.world);
        self.coordinates.place(unknowns, &mut world);
        let all = sets(&self.mechanics, &self.bed, &self.contacts, &self.rubbing);
        let energy = all.iter().map(|set| set.total(&world)).sum::<f64>() - self.work_of_pull(unknowns);
        self.world = world;
        energy
    }

    /// Energy \[J\]; finds the gradient, and second derivatives between the exact (`convexity = 0`) and positive semi-definite
    /// ones (`convexity = 1`).
    pub fn linearise(&mut self, unknowns: &[f64], convexity: f64) -> f64 {
        self.coordinates.place(unknowns, &mut self.world);
        self.gradient.fill(0.0);
        self.period_gradient = [0.0; 2];
        self.second.clear();
        let Self {
            coordinates,
            mechanics,
            bed,
            contacts,
            rubbing,
            free,
            second,
            places,
            gradient,
            period_gradient,
            world,
            ..
        } = self;
        let mut places = places.iter();
        let mut energy = 0.0;
        for set in sets(mechanics, bed, contacts, rubbing) {
            energy += set.visit(world, convexity, &mut |stencil, slope, curvature| {
                if slope.is_empty() {
                    places = places.as_slice()[stencil.len() * stencil.len()..].iter();
                    return;
                }
                for (j, &dof) in stencil.iter().enumerate() {
                    let to = coordinates.source(dof);
                    let mut column = [0.0; 2];
                    for (i, &dof) in stencil.iter().enumerate() {
                        let value = curvature(i, j);
                        let from = coordinates.source(dof);
                        column[0] += from.by[0] * value;
                        column[1] += from.by[1] * value;
                        second.matrix.values[*places.next().expect("a place for every value") as usize] += value;
                    }
                    if free[to.of as usize] {
                        gradient[to.of as usize] += slope[j];
                        second.border[0][to.of as usize] += column[0];
                        second.border[1][to.of as usize] += column[1];
                    }
                    for (axis, by) in to.by.into_iter().enumerate() {
                        period_gradient[axis] += by * slope[j];
                        second.corner[axis][0] += by * column[0];
                        second.corner[axis][1] += by * column[1];
                    }
                }
            });
        }
        self.period_gradient.iter_mut().zip(self.pull).for_each(|(gradient, pull)| *gradient -= pull);
        self.hold();
        energy - self.work_of_pull(unknowns)
    }

    /// What the pull has done since the periods were nothing \[J\].
    fn work_of_pull(&self, unknowns: &[f64]) -> f64 {
        let n = self.coordinates.own().len();
        self.pull[0] * unknowns[n] + self.pull[1] * unknowns[n + 1]
    }

    /// Whether the second number of the plane is held, of a system whose first is.
    pub fn hold_second(&mut self, hold: bool) {
        debug_assert!(self.held[0]);
        self.held[1] = hold;
    }

    /// Takes the columns of the numbers that are held out of the system, and puts a one in their place.
    fn hold(&mut self) {
        self.held_corner = self.second.corner;
        for axis in (0..2).filter(|&axis| self.held[axis]) {
            std::mem::swap(&mut self.second.border[axis], &mut self.held_border[axis]);
            self.second.border[axis].fill(0.0);
            for other in 0..2 {
                self.second.corner[axis][other] = 0.0;
                self.second.corner[other][axis] = 0.0;
            }
            self.second.corner[axis][axis] = 1.0;
        }
    }

    /// Second derivatives by a number of the plane that is held and by the own slots, where it was linearised last; those by both
    /// numbers.
    pub fn held_border(&self, axis: usize) -> (&[f64], [[f64; 2]; 2]) {
        (&self.held_border[axis], self.held_corner)
    }

    /// The gradient of the numbers of the plane that are not held.
    fn period_force(&self) -> [f64; 2] {
        std::array::from_fn(|axis| if self.held[axis] { 0.0 } else { self.period_gradient[axis] })
    }

    /// Largest component of the gradient \[N\], by the own slots and by the numbers of the plane.
    pub fn largest_force(&self) -> f64 {
        let own = self.gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        let [w, h] = self.period_force();
        own.max(w.abs()).max(h.abs())
    }

    /// Solves with the second derivatives and a multiple of the identity \[N/m\]; the right side is replaced by the solution. Whether
    /// they are positive definite.
    ///
    /// # Errors
    /// If something is not finite.
    pub fn solve(&mut self, shift: f64, own: &mut [f64], plane: &mut [f64; 2]) -> Result<bool, CholeskyError> {
        self.second.solve(shift, self.period_weight, own, plane)
    }

    /// Newton's step with a multiple of the identity \[N/m\] added to the second derivatives, and its slope and curvature:
    /// `gᵀd` and `dᵀHd` \[J\]. `None` if they are not positive definite even so.
    ///
    /// # Errors
    /// If something is not finite.
    pub fn step(&mut self, shift: f64) -> Result<Option<Step>, CholeskyError> {
        let mut direction: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        let mut periods = self.period_force().map(|g| -g);
        if !self.solve(shift, &mut direction, &mut periods)? {
            return Ok(None);
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let slope = dot(&direction, &self.gradient) + dot(&periods, &self.period_gradient);
        let square = dot(&direction, &direction) + self.period_weight * dot(&periods, &periods);
        direction.extend(periods);
        Ok(Some(Step { direction, foreseen: Foreseen { slope, curvature: -slope - shift * square } }))
    }

    /// The row of the inverse of the second derivatives that belongs to a period, by own slots and periods \[m/N\]; `None` if they
    /// are not positive definite.
    pub fn inverse_row(&mut self, axis: usize) -> Option<Vec<f64>> {
        let mut row = vec![0.0; self.gradient.len()];
        let mut periods = [0.0; 2];
        periods[axis] = 1.0;
        if !self.solve(0.0, &mut row, &mut periods).ok()? {
            return None;
        }
        row.extend(periods);
        Some(row)
    }

    /// Derivative of the energy along a motion of the world \[J\].
    pub fn first_along(&mut self, unknowns: &[f64], motion: &[f64]) -> f64 {
        self.coordinates.place(unknowns, &mut self.world);
        let mut sum = 0.0;
        for set in sets(&self.mechanics, &self.bed, &self.contacts, &self.rubbing) {
            set.visit_gradient(&self.world, &mut |stencil, gradient| {
                sum += stencil.iter().zip(gradient).map(|(&dof, g)| g * motion[dof as usize]).sum::<f64>();
            });
        }
        sum
    }

    /// Second derivative of the energy along two motions of the world \[J\].
    pub fn second_along(&mut self, unknowns: &[f64], one: &[f64], other: &[f64]) -> f64 {
        self.coordinates.place(unknowns, &mut self.world);
        let mut sum = 0.0;
        for set in sets(&self.mechanics, &self.bed, &self.contacts, &self.rubbing) {
            set.visit(&self.world, 0.0, &mut |stencil, _, curvature| {
                for (j, &b) in stencil.iter().enumerate() {
                    let column: f64 = stencil.iter().enumerate().map(|(i, &a)| one[a as usize] * curvature(i, j)).sum();
                    sum += column * other[b as usize];
                }
            });
        }
        sum
    }

    /// Whether every segment has a rest length.
    pub fn is_sound(&mut self, unknowns: &[f64]) -> bool {
        self.coordinates.place(unknowns, &mut self.world);
        self.mechanics.stretch.stencils.iter().all(|s| self.world[s[7] as usize] - self.world[s[3] as usize] > 0.0)
    }

    /// The longest part of a step that no segment's rest length reaches zero in, and in which no coordinate moves further than
    /// `most` \[m\].
    pub fn longest_step(&mut self, unknowns: &[f64], direction: &[f64], most: f64) -> f64 {
        self.coordinates.place(unknowns, &mut self.world);
        let n = self.coordinates.own().len();
        let change = |dof: Dof| {
            let source = self.coordinates.source(dof);
            direction[source.of as usize] + source.by[0] * direction[n] + source.by[1] * direction[n + 1]
        };
        let mut longest: f64 = 1.0;
        for stencil in &self.mechanics.stretch.stencils {
            let rest = self.world[stencil[7] as usize] - self.world[stencil[3] as usize];
            let rate = change(stencil[7]) - change(stencil[3]);
            if rate < 0.0 {
                longest = longest.min(0.9 * rest / -rate);
            }
        }
        let largest = direction[..n].iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let longest = longest.min(most / largest.max(f64::MIN_POSITIVE));
        self.clear_way(unknowns, direction, longest)
    }

    /// The part of a step along which no two segments that may touch pass through each other, at most `part`.
    fn clear_way(&mut self, unknowns: &[f64], direction: &[f64], part: f64) -> f64 {
        if self.contacts.is_empty() {
            return part;
        }
        let trial: Vec<f64> = unknowns.iter().zip(direction).map(|(u, d)| u + part * d).collect();
        let (mut start, mut end) = (Vec::new(), Vec::new());
        self.coordinates.place(unknowns, &mut start);
        self.coordinates.place(&trial, &mut end);
        let points = |index: usize, world: &[f64]| -> [[f64; 3]; 4] {
            let points: [f64; 16] = self.contacts.elements[index].points(&self.contacts.local(index, world));
            std::array::from_fn(|i| std::array::from_fn(|k| points[4 * i + k]))
        };
        let way = |index: usize| {
            let (from, to) = (points(index, &start), points(index, &end));
            let way = std::array::from_fn(|i| to[i / 3][i % 3] - from[i / 3][i % 3]);
            first_meeting(&from, &way).map_or(1.0, |t| PART * t)
        };
        part * (0..self.contacts.len()).map(way).fold(1.0, f64::min)
    }
}

/// A step by all unknowns.
pub(super) struct Step {
    pub direction: Vec<f64>,
    pub foreseen: Foreseen,
}

/// Springs under every node \[N/m\]; none without stiffness.
pub(super) fn bed(network: &Network, stiffness: f64) -> Elements<Foundation, 1> {
    let mut springs = Elements::default();
    if stiffness > 0.0 {
        for node in 0..network.node_count() {
            springs.push(Foundation { stiffness, place: 0.0 }, [dof(BLOCK * node + 2)]);
        }
    }
    springs
}

fn sets<'a>(
    mechanics: &'a Mechanics,
    bed: &'a Elements<Foundation, 1>,
    contacts: &'a Contacts,
    rubbing: &'a Elements<AnchoredSpring, 1>,
) -> [&'a dyn ElementSet; 13] {
    let [a, b, c, d, e, f, g, h, i, j] = mechanics.sets();
    [a, b, c, d, e, f, g, h, i, j, bed, contacts, rubbing]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabric::PlaneMap;
    use crate::pattern::weave::{self, Draft};
    use crate::scene::Scene;

    #[test]
    fn threads_that_are_sheared_would_gather_in_groups_if_nothing_rubbed() {
        let text = "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.16 mm\"\nstretch_stiffness = \"10 N\"\n\
            bending_stiffness = 1e-9\n[fabric.weave]\npattern = \"plain\"\nends = 2\npicks = 2\nend_spacing = \"0.5 mm\"\n\
            pick_spacing = \"0.5 mm\"\n";
        let scene = Scene::from_text(text, "scene.toml").unwrap();
        let (pitch, period) = (0.5e-3, 1e-3);
        let network = weave::tile(&Draft::plain(), [pitch; 2]).unwrap();
        // Sheared by 0.4 rad, its threads as long as they were: columns are periods.
        let shear = 0.4f64;
        let map =
            PlaneMap { base: [[period, period * shear.sin()], [0.0, period * shear.cos()]], rates: [[[0.0; 2]; 2]; 2] };
        let places: Vec<[f64; 2]> = network.position.iter().map(|x| [x.x / period, x.y / period]).collect();
        let coordinates = TileCoordinates::with_plane(&network, &places, &map);
        let around = Around { held: [true; 2], ..Around::default() };
        let mut system = TileSystem::with(&network, &scene.yarns, &scene.fabric, coordinates, around).unwrap();
        let own = system.coordinates.own().clone();
        // The second pick goes along the warp, which slides through it, and to its side.
        let mut energy = |along: f64, aside: f64| {
            let mut unknowns = vec![0.0; own.len() + 2];
            for pass in 0..network.pass_count() {
                unknowns[own.slot(PassId::new(pass))] = network.arc_length[pass];
            }
            for crossing in network.crossings.iter().filter(|crossing| crossing.node.index() >= 2) {
                let place = BLOCK * crossing.node.index();
                unknowns[place] = pitch * (along * shear.sin() - aside * shear.cos());
                unknowns[place + 1] = pitch * (along * shear.cos() + aside * shear.sin());
                unknowns[own.slot(crossing.warp)] += pitch * along;
            }
            system.energy(&unknowns)
        };
        let even = energy(0.0, 0.0);
        assert!(even > 0.0 && (energy(0.3, 0.0) / even - 1.0).abs() < 1e-9, "a straight thread lies anywhere");
        assert!(energy(0.0, 0.04) > even && energy(0.0, -0.04) > even);
        let grouped = [-0.04, 0.04].map(|aside| energy(0.3, aside) / even - 1.0);
        assert!(grouped.iter().any(|&change| change < -0.01), "{grouped:?}");
    }
}
