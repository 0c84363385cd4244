//! The stiffnesses of a fabric, of which its energy is a linear function, and the forces that each of them makes.

use super::tile_system::bed;
use super::weave_systems::Systems;
use crate::energy::Foundation;
use crate::fabric::elements::{ElementSet, Elements};
use crate::fabric::{Mechanics, TileCoordinates};
use crate::model::{FabricCard, KnitCard, Network, Thickness, WovenCard, YarnCard, Yarns};

/// A stiffness of a fabric: of its yarns or of its contacts. Knits have six, and weaves six of theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileStiffness {
    /// Stretch of a knit's first yarn `k_s` \[N\]; others keep their proportion to it.
    Stretch,
    /// Bending of a knit's first yarn `k_b` \[N·m²\]; others keep their proportion to it. The bed under a tile is measured in it.
    Bending,
    /// Wrapping of stitch contacts `k_w` \[N\].
    Wrapping,
    /// Yarn length of stitch contacts `k_l` \[N\].
    Length,
    /// Spacing barrier `k_c` \[N\].
    Spacing,
    /// Push of neighbouring legs \[N\]; none of yarns that meet in one point.
    Legs,
    /// Stretch of the first end `k_s` \[N\]; other yarns of the warp keep their proportion to it.
    WarpStretch,
    /// Stretch of the first pick whose yarn is not in the warp \[N\], and in proportion of the others; none where there is no such.
    WeftStretch,
    /// Bending of the first end `k_b` \[N·m²\], and in proportion of other yarns of the warp. The bed under a tile is measured in it.
    WarpBending,
    /// Bending of the first pick whose yarn is not in the warp \[N·m²\], and in proportion of the others; none where there is no such.
    WeftBending,
    /// Shear of crossings `k_x` \[N\], their jamming included.
    Shear,
}

impl TileStiffness {
    /// Number of those of a fabric.
    pub const COUNT: usize = 6;
    const OF_KNIT: [Self; Self::COUNT] =
        [Self::Stretch, Self::Bending, Self::Wrapping, Self::Length, Self::Spacing, Self::Legs];
    const OF_WEAVE: [Self; Self::COUNT] =
        [Self::WarpStretch, Self::WeftStretch, Self::Shear, Self::WarpBending, Self::WeftBending, Self::Spacing];

    /// Those of a fabric, in the order of arrays.
    #[must_use]
    pub fn all(card: &FabricCard) -> [Self; Self::COUNT] {
        match card {
            FabricCard::Knit(_) => Self::OF_KNIT,
            FabricCard::Woven(_) => Self::OF_WEAVE,
        }
    }

    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch",
            Self::Bending => "bending",
            Self::Wrapping => "wrapping",
            Self::Length => "length",
            Self::Spacing => "spacing",
            Self::Legs => "legs",
            Self::WarpStretch => "warp stretch",
            Self::WeftStretch => "weft stretch",
            Self::WarpBending => "warp bending",
            Self::WeftBending => "weft bending",
            Self::Shear => "shear",
        }
    }

    /// Whether it is a bending stiffness \[N·m²\]; the others are forces \[N\].
    #[must_use]
    pub fn is_bending(self) -> bool {
        matches!(self, Self::Bending | Self::WarpBending | Self::WeftBending)
    }

    /// Whether a fabric has it.
    #[must_use]
    pub fn is_there(self, network: &Network, card: &FabricCard) -> bool {
        match self {
            Self::Legs => card.knit().is_some_and(|card| card.thickness.is_some()),
            Self::WeftStretch | Self::WeftBending => Systems::of(network).weft.is_some(),
            _ => Self::all(card).contains(&self),
        }
    }

    /// The stiffnesses of a fabric in SI units, in the order of [`Self::all`]; zero where it has none.
    #[must_use]
    pub fn of(network: &Network, yarns: &Yarns, card: &FabricCard) -> [f64; Self::COUNT] {
        match card {
            FabricCard::Knit(card) => [
                yarns.first().stretch_stiffness,
                yarns.first().bending_stiffness,
                card.wrapping_stiffness,
                card.length_stiffness,
                card.spacing_stiffness,
                card.thickness.map_or(0.0, |thickness| thickness.leg_stiffness),
            ],
            FabricCard::Woven(card) => {
                let systems = Systems::of(network);
                let [warp, weft] = [systems.warp, systems.weft].map(|kind| kind.map(|kind| yarns.of(kind)));
                let stretch = |yarn: Option<&YarnCard>| yarn.map_or(0.0, |yarn| yarn.stretch_stiffness);
                let bending = |yarn: Option<&YarnCard>| yarn.map_or(0.0, |yarn| yarn.bending_stiffness);
                [
                    stretch(warp),
                    stretch(weft),
                    card.shear_stiffness,
                    bending(warp),
                    bending(weft),
                    card.spacing_stiffness,
                ]
            }
        }
    }

    /// The same fabric with other stiffnesses.
    #[must_use]
    pub fn with(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        stiffness: [f64; Self::COUNT],
    ) -> (Yarns, FabricCard) {
        match card {
            FabricCard::Knit(card) => knit_with(yarns, card, stiffness),
            FabricCard::Woven(card) => weave_with(&Systems::of(network), yarns, card, stiffness),
        }
    }
}

fn knit_with(yarns: &Yarns, card: &KnitCard, stiffness: [f64; TileStiffness::COUNT]) -> (Yarns, FabricCard) {
    let [stretch, bending, wrapping_stiffness, length_stiffness, spacing_stiffness, leg_stiffness] = stiffness;
    let first = yarns.first();
    let all: Vec<_> = yarns.cards().iter().map(|yarn| in_proportion(yarn, first, stretch, bending)).collect();
    let thickness = card.thickness.map(|thickness| Thickness { leg_stiffness, ..thickness });
    let card = KnitCard { wrapping_stiffness, length_stiffness, spacing_stiffness, thickness, ..card.clone() };
    (Yarns::new(all[0].clone(), all[1..].iter().cloned()), FabricCard::Knit(card))
}

fn weave_with(
    systems: &Systems,
    yarns: &Yarns,
    card: &WovenCard,
    stiffness: [f64; TileStiffness::COUNT],
) -> (Yarns, FabricCard) {
    let [warp_stretch, weft_stretch, shear_stiffness, warp_bending, weft_bending, spacing_stiffness] = stiffness;
    let changed = |kind: usize| {
        let kind = kind as u8;
        let yarn = yarns.of(kind);
        match (systems.warp, systems.weft) {
            (Some(first), _) if systems.in_warp(kind) => {
                in_proportion(yarn, yarns.of(first), warp_stretch, warp_bending)
            }
            (_, Some(first)) if systems.in_weft(kind) => {
                in_proportion(yarn, yarns.of(first), weft_stretch, weft_bending)
            }
            _ => yarn.clone(),
        }
    };
    // A thread of a number that has no card of its own gets one: what is the first yarn's elsewhere need not be so of it.
    let all: Vec<_> = (0..systems.kinds().max(yarns.cards().len())).map(changed).collect();
    let card = WovenCard { shear_stiffness, spacing_stiffness, ..card.clone() };
    (Yarns::new(all[0].clone(), all[1..].iter().cloned()), FabricCard::Woven(card))
}

/// A yarn whose stiffnesses go with those of another, which become these.
fn in_proportion(yarn: &YarnCard, first: &YarnCard, stretch: f64, bending: f64) -> YarnCard {
    YarnCard {
        stretch_stiffness: stretch * share(yarn.stretch_stiffness, first.stretch_stiffness),
        bending_stiffness: bending * share(yarn.bending_stiffness, first.bending_stiffness),
        ..yarn.clone()
    }
}

/// A yarn's stiffness over that of the first.
fn share(own: f64, first: f64) -> f64 {
    if first > 0.0 { own / first } else { 1.0 }
}

/// Bending stiffness `k_b` \[N·m²\] and length `ℓ` \[m\] by which forces in a tile are measured: of its first yarn and of a loop, or of
/// its first end and the mean distance of its threads.
pub(super) fn bending_and_length(network: &Network, yarns: &Yarns, card: &FabricCard) -> (f64, f64) {
    let first = match card {
        FabricCard::Knit(_) => yarns.first(),
        FabricCard::Woven(_) => Systems::of(network).warp.map_or(yarns.first(), |kind| yarns.of(kind)),
    };
    (first.bending_stiffness, card.unit_length())
}

/// The energies of a tile with one stiffness at one and the others at zero, from which the forces of all follow.
#[derive(Debug)]
pub(super) struct UnitEnergies {
    coordinates: TileCoordinates,
    all: [TileStiffness; TileStiffness::COUNT],
    /// All stiffnesses of a knit but that of spacing are one; of a weave those of the warp, and shear.
    first: Mechanics,
    /// The others are.
    second: Mechanics,
    bed: Elements<Foundation, 1>,
}

impl UnitEnergies {
    /// Over given coordinates; `relative_bed` is the bed's stiffness for a bending stiffness of one \[1/m³\].
    pub fn new(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        relative_bed: f64,
        mut coordinates: TileCoordinates,
    ) -> Self {
        let all = TileStiffness::all(card);
        let mut mechanics = |second: bool| {
            let ones = all.map(|stiffness| if stiffness.is_second() == second { 1.0 } else { 0.0 });
            let (yarns, card) = TileStiffness::with(network, yarns, card, ones);
            Mechanics::new(network, &yarns, &card, &mut coordinates)
        };
        let first = mechanics(false);
        let second = mechanics(true);
        Self { coordinates, all, first, second, bed: bed(network, relative_bed) }
    }

    fn sets(&self, stiffness: TileStiffness) -> Vec<&dyn ElementSet> {
        let (first, second, thick) = (&self.first, &self.second, &self.first.thick);
        match stiffness {
            // Where yarns have a thickness, the core of a segment is as stiff as the yarn.
            TileStiffness::Stretch => vec![&first.stretch, &thick.stretch, &first.spacing],
            TileStiffness::Bending => vec![&first.bending, &thick.bending, &self.bed],
            TileStiffness::Wrapping => vec![&first.wrapping],
            TileStiffness::Length => vec![&first.stitch_length],
            TileStiffness::Spacing => vec![&second.spacing],
            TileStiffness::Legs => vec![&thick.legs, &thick.facing],
            TileStiffness::WarpStretch => vec![&first.stretch],
            TileStiffness::WeftStretch => vec![&second.stretch],
            TileStiffness::WarpBending => vec![&first.bending, &self.bed],
            TileStiffness::WeftBending => vec![&second.bending],
            TileStiffness::Shear => vec![&first.shear],
        }
    }

    /// Work that the forces of each stiffness at one do along directions of the unknowns: `v · ∂²W/∂y∂p`.
    pub fn work<const K: usize>(&self, unknowns: &[f64], directions: [&[f64]; K]) -> [[f64; K]; TileStiffness::COUNT] {
        let mut world = Vec::new();
        self.coordinates.place(unknowns, &mut world);
        let motions = directions.map(|direction| self.coordinates.moved(direction));
        self.all.map(|stiffness| {
            let mut work = [0.0; K];
            for set in self.sets(stiffness) {
                set.visit_gradient(&world, &mut |stencil, gradient| {
                    for (sum, motion) in work.iter_mut().zip(&motions) {
                        *sum += stencil.iter().zip(gradient).map(|(&dof, g)| g * motion[dof as usize]).sum::<f64>();
                    }
                });
            }
            work
        })
    }
}

impl TileStiffness {
    /// Whether it is one in the second of the two mechanics of [`UnitEnergies`].
    fn is_second(self) -> bool {
        matches!(self, Self::Spacing | Self::WeftStretch | Self::WeftBending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tile_system::TileSystem;
    use crate::pattern::weave::{self, Draft};
    use crate::pattern::{Chart, Stitch, knit};
    use crate::scene::Scene;

    const WEAVE: &str = "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.16 mm\"\nstretch_stiffness = \"10 N\"\n\
        bending_stiffness = 1e-9\n[fabric.weave]\npattern = \"twill 2/1\"\nends = 6\npicks = 6\nend_spacing = \"0.5 mm\"\n\
        pick_spacing = \"0.4 mm\"\ninterlacing_spacing = [\"0.35 mm\", \"0.45 mm\"]\n";

    /// Unknowns of a fabric far from rest: displaced in the plane and out of it, and its yarns slid.
    fn displaced(system: &TileSystem, network: &Network, length: f64) -> Vec<f64> {
        let mut random = 7u64;
        let mut next = move || {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            (random >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut world = system.coordinates.initial(network);
        let n = world.len();
        world[..n - 2].iter_mut().for_each(|x| *x += 0.3 * length * next());
        world[n - 2..].iter_mut().for_each(|period| *period *= 1.0 + 0.05 * next());
        system.coordinates.unknowns(world)
    }

    /// At a state far from rest the forces of each stiffness at one are the derivatives of all forces by it.
    fn check(network: &Network, yarns: &Yarns, card: &FabricCard, moved: f64) {
        let (bending, length) = bending_and_length(network, yarns, card);
        let relative_bed = 3.0 / length.powi(3);
        let settings = crate::dynamics::tile_equilibrium::TileSettings { bed: 3.0, ..Default::default() };
        assert!(bending > 0.0);
        let system = TileSystem::of(network, yarns, card, &settings);
        let unknowns = displaced(&system, network, moved);
        let along = displaced(&system, network, length);
        let units = UnitEnergies::new(network, yarns, card, relative_bed, TileCoordinates::new(network));
        let work = units.work(&unknowns, [&along]).map(|[work]| work);
        let stiffness = TileStiffness::of(network, yarns, card);
        let total = |stiffness: [f64; TileStiffness::COUNT]| {
            let (yarns, card) = TileStiffness::with(network, yarns, card, stiffness);
            let mut system = TileSystem::of(network, &yarns, &card, &settings);
            let motion = system.coordinates.moved(&along);
            system.first_along(&unknowns, &motion)
        };
        let whole = total(stiffness);
        let sum: f64 = work.iter().zip(stiffness).map(|(work, p)| work * p).sum();
        assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} {whole}");
        for (k, kind) in TileStiffness::all(card).into_iter().enumerate() {
            let mut more = stiffness;
            more[k] *= 2.0;
            let difference = total(more) - whole;
            let own = work[k] * stiffness[k];
            assert!(kind.is_there(network, card) == (own != 0.0), "{}: {own}", kind.name());
            let largest = work.iter().zip(stiffness).fold(0.0f64, |most, (work, p)| most.max((work * p).abs()));
            assert!((difference - own).abs() < 1e-9 * largest, "{}: {difference} {own}", kind.name());
        }
    }

    #[test]
    fn forces_are_the_sum_of_those_of_all_stiffnesses() {
        for contacts in ["point", "thick"] {
            let text = format!(
                "schema = 1\n[fabric]\nloop_length = \"10 mm\"\ncontacts = \"{contacts}\"\n\
                 [fabric.chart]\npattern = \"stockinette\"\ncolumns = 1\nrows = 1\n"
            );
            let scene = Scene::from_text(&text, "scene.toml").unwrap();
            let chart = Chart::new(vec![vec![Stitch::Knit]]).unwrap();
            let network = knit::tile(&chart, scene.fabric.knit().unwrap()).unwrap();
            check(&network, &scene.yarns, &scene.fabric, 0.02 * scene.fabric.unit_length());
        }
        for threads in ["", "warp = [\"a\", \"b\"]\nweft = [\"c\", \"a\", \"d\"]\n", "warp = [\"a\"]\nweft = [\"a\"]\n"]
        {
            let scene = Scene::from_text(&format!("{WEAVE}{threads}"), "scene.toml").unwrap();
            let woven = scene.structure.woven().unwrap();
            let network = weave::tile(&woven.draft, scene.fabric.woven().unwrap().spacing).unwrap();
            check(&network, &scene.yarns, &scene.fabric, 0.9 * scene.fabric.unit_length());
        }
    }

    #[test]
    fn yarns_keep_their_proportion_within_a_system() {
        let draft = Draft::plain();
        let scene = Scene::from_text(WEAVE, "scene.toml").unwrap();
        let spacing = scene.fabric.woven().unwrap().spacing;
        let soft = scene.yarns.first().clone();
        let scaled = |factor: f64| YarnCard {
            stretch_stiffness: factor * soft.stretch_stiffness,
            bending_stiffness: factor * factor * soft.bending_stiffness,
            ..soft.clone()
        };
        let yarns = Yarns::new(scaled(1.0), [scaled(2.0), scaled(3.0), scaled(4.0)]);
        let network = |warp: [u8; 2], weft: [u8; 2]| {
            let mut draft = draft.clone();
            draft.warp.iter_mut().zip(warp).for_each(|(thread, kind)| thread.yarn = kind);
            draft.weft.iter_mut().zip(weft).for_each(|(thread, kind)| thread.yarn = kind);
            weave::tile(&draft, spacing).unwrap()
        };
        let factors = |yarns: &Yarns| {
            let stretch = yarns.cards().iter().map(|yarn| yarn.stretch_stiffness / soft.stretch_stiffness);
            let bending = yarns.cards().iter().map(|yarn| yarn.bending_stiffness / soft.bending_stiffness);
            [stretch.collect::<Vec<_>>(), bending.collect()]
        };
        // What is in both is of the warp; what is in none stays.
        let both = network([1, 0], [0, 2]);
        let given = TileStiffness::of(&both, &yarns, &scene.fabric);
        assert_eq!(given[0] / soft.stretch_stiffness, 2.0);
        assert_eq!((given[1] / soft.stretch_stiffness, given[4] / soft.bending_stiffness), (3.0, 9.0));
        let changed = [10.0 * given[0], 100.0 * given[1], 7.0, 1000.0 * given[3], given[4], 8.0];
        let (found, card) = TileStiffness::with(&both, &yarns, &scene.fabric, changed);
        for (found, wanted) in factors(&found).iter().zip([[10.0, 20.0, 300.0, 4.0], [1000.0, 4000.0, 9.0, 16.0]]) {
            assert!(found.iter().zip(wanted).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{found:?}");
        }
        assert_eq!(TileStiffness::of(&both, &found, &card)[2..6], changed[2..6]);
        // One yarn for all has no stiffness of the weft; a number without a card gets one where warp and weft differ.
        let one = network([0, 0], [0, 0]);
        assert_eq!(TileStiffness::of(&one, &yarns, &scene.fabric)[1], 0.0);
        assert!(!TileStiffness::WeftStretch.is_there(&one, &scene.fabric));
        let apart = network([0, 0], [1, 1]);
        let (found, _) = TileStiffness::with(&apart, &(&soft).into(), &scene.fabric, changed);
        assert_eq!(found.of(1).stretch_stiffness, changed[1]);
        assert_eq!(found.of(0).stretch_stiffness, changed[0]);
    }
}
