//! Counts of a network's parts, and the amounts of yarn in it.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use serde::Serialize;

use crate::model::{FabricCard, Float, Network, NodeId, PassId, YarnId, Yarns};

/// What a network consists of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Census {
    /// Rows of the chart.
    pub rows: u32,
    /// Columns of the chart.
    pub columns: u32,
    /// Loops.
    pub loops: usize,
    /// Loops that are knit stitches as seen from the front.
    pub knit_loops: usize,
    /// Loops that nothing holds: row and column of the chart, from 0.
    pub unsupported_loops: Vec<[u32; 2]>,
    /// Floats, the longest first, then by their places.
    pub floats: Vec<Float>,
    /// Stitch contacts.
    pub stitch_contacts: usize,
    /// Yarns.
    pub yarns: usize,
    /// Nodes.
    pub nodes: usize,
    /// Nodes by the number of passes stacked there: the first entry counts those with none.
    pub nodes_by_stack_size: Vec<usize>,
    /// Passes of yarns through nodes.
    pub passes: usize,
    /// Degrees of freedom: three a node, and one for each pass that slides.
    pub degrees_of_freedom: usize,
    /// Length of all real yarn \[m\]: the model's rest length over the card's path ratio. Yarns that run together as one count once.
    pub yarn_length_m: f64,
    /// The same by the fabric's yarns, in their order \[m\].
    pub yarn_lengths_m: Vec<f64>,
    /// Masses of the fabric's yarns, in their order \[kg\].
    pub yarn_masses_kg: Vec<f64>,
    /// Mass of all yarns \[kg\].
    pub mass_kg: f64,
    /// How much there is of each yarn in each colour; of yarns that run together, of each of them.
    pub amounts: Vec<YarnAmount>,
}

/// How much there is of a yarn in a colour.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct YarnAmount {
    /// Its name; "yarn" where the fabric has but one, without a name.
    pub name: String,
    /// Its colour as `#rrggbb`.
    pub color: String,
    /// Its length \[m\], as real yarn.
    pub length_m: f64,
    /// Its mass \[kg\].
    pub mass_kg: f64,
}

impl Census {
    /// Counts a network.
    #[must_use]
    pub fn of(network: &Network, yarns: impl Into<Yarns>, card: impl Into<FabricCard>) -> Self {
        let (yarns, card) = (yarns.into(), card.into());
        let mut nodes_by_stack_size = Vec::new();
        for node in 0..network.node_count() {
            let size = network.stack(NodeId::new(node)).len();
            if nodes_by_stack_size.len() <= size {
                nodes_by_stack_size.resize(size + 1, 0);
            }
            nodes_by_stack_size[size] += 1;
        }
        let sliding = (0..network.pass_count()).filter(|&pass| network.slides(PassId::new(pass))).count();
        let kinds = network.yarn_kind.iter().max().map_or(0, |most| usize::from(*most) + 1);
        let mut yarn_lengths_m = vec![0.0; kinds];
        let mut by_color: BTreeMap<(u8, [u8; 3]), f64> = BTreeMap::new();
        for (y, kind) in network.yarn_kind.iter().enumerate() {
            let length = network.length_of(YarnId::new(y)) / card.path_ratio(network.yarn_role[y]);
            yarn_lengths_m[usize::from(*kind)] += length;
            *by_color.entry((*kind, network.yarn_color[y])).or_default() += length;
        }
        let masses = (0..).zip(&yarn_lengths_m).map(|(kind, length)| length * yarns.of(kind).linear_density);
        let yarn_masses_kg: Vec<f64> = masses.collect();
        let mut floats = network.floats.clone();
        floats.sort_unstable_by_key(|float| (Reverse(float.over), float.row, float.column));
        Self {
            rows: network.chart_size[0],
            columns: network.chart_size[1],
            loops: network.loops.len(),
            knit_loops: network.loops.iter().filter(|info| info.knit).count(),
            unsupported_loops: network
                .loops
                .iter()
                .filter(|info| !info.held)
                .map(|info| [info.row, info.column])
                .collect(),
            floats,
            stitch_contacts: network.stitches.len(),
            yarns: network.yarn_count(),
            nodes: network.node_count(),
            nodes_by_stack_size,
            passes: network.pass_count(),
            degrees_of_freedom: 3 * network.node_count() + sliding,
            yarn_length_m: yarn_lengths_m.iter().sum(),
            mass_kg: yarn_masses_kg.iter().sum(),
            yarn_masses_kg,
            yarn_lengths_m,
            amounts: amounts(&yarns, by_color),
        }
    }
}

/// Amounts by name and colour, from lengths by number and colour.
fn amounts(yarns: &Yarns, by_color: BTreeMap<(u8, [u8; 3]), f64>) -> Vec<YarnAmount> {
    let mut amounts: Vec<YarnAmount> = Vec::new();
    let mut known: BTreeMap<(&str, [u8; 3]), usize> = BTreeMap::new();
    for ((kind, color), length) in by_color {
        let mut add = |name, [r, g, b]: [u8; 3], mass: f64| {
            let at = *known.entry((name, [r, g, b])).or_insert(amounts.len());
            if at == amounts.len() {
                let (name, color) = (str::to_owned(name), format!("#{r:02x}{g:02x}{b:02x}"));
                amounts.push(YarnAmount { name, color, length_m: 0.0, mass_kg: 0.0 });
            }
            amounts[at].length_m += length;
            amounts[at].mass_kg += mass;
        };
        let mass = length * yarns.of(kind).linear_density;
        let members = yarns.members(kind);
        // A density of the whole that is said of its own is shared as those of the members are.
        let sum: f64 = members.iter().map(|member| member.card.linear_density).sum();
        for member in members {
            add(&member.name, member.color, mass * member.card.linear_density / sum);
        }
        if members.is_empty() {
            add(yarns.name(kind).unwrap_or("yarn"), color, mass);
        }
    }
    amounts
}

impl Census {
    /// Mass an area \[kg/m²\] of a fabric of this stitch density \[1/m²\]; the yarn of its edges counts as loops do.
    #[must_use]
    pub fn areal_mass(&self, stitch_density: f64) -> f64 {
        if self.loops == 0 { 0.0 } else { self.mass_kg * stitch_density / self.loops as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{KnitCard, Member, YarnCard};
    use crate::pattern::{Chart, Side, Working, knit};

    fn cards() -> (YarnCard, KnitCard) {
        let yarn = YarnCard {
            linear_density: 4e-4,
            radius: 8e-4,
            stretch_stiffness: 8.0,
            bending_stiffness: 2e-8,
            friction_coefficient: 0.3,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            loose_ends: false,
            plies: 2,
            twist: 200.0,
        };
        let fabric = KnitCard {
            loop_length: 16e-3,
            path_ratio: 0.8,
            transition_length: 0.0,
            stitch_length: 2e-3,
            wale_spacing: 4.5e-3,
            course_spacing: 3.5e-3,
            wrapping_stiffness: 1e-4,
            wrapping_angle_course: 1.5,
            wrapping_angle_leg: 1.5,
            bend_angle_foot_head: 1.0,
            bend_angle_leg: 0.5,
            length_stiffness: 0.01,
            spacing_stiffness: 0.01,
            spacing_leg: 1e-3,
            spacing_head_sinker: 1e-3,
            thickness: None,
            anchor_stiffness: 10.0,
            residual_compression: 1e-5,
        };
        (yarn, fabric)
    }

    #[test]
    fn every_node_has_a_stack_and_every_pass_is_in_one() {
        let (yarn, fabric) = cards();
        for (chart, knit_share) in [(Chart::stockinette(), 1.0), (Chart::reverse_stockinette(), 0.0)] {
            let chart = chart.repeat(7, 6).unwrap();
            let network = knit::fabric(&chart, Working::Flat { first_row: Side::RightSide }, &fabric);
            let census = Census::of(&network, &yarn, &fabric);
            assert_eq!(census.nodes_by_stack_size.iter().sum::<usize>(), census.nodes);
            let stacked: usize = census.nodes_by_stack_size.iter().enumerate().map(|(size, count)| size * count).sum();
            assert_eq!(stacked, census.passes);
            assert_eq!((census.rows, census.columns, census.loops), (6, 7, 42));
            assert_eq!(census.knit_loops as f64, knit_share * 42.0);
            assert!(census.degrees_of_freedom > 3 * census.nodes && census.degrees_of_freedom < 5 * census.nodes);
            // The loops alone take 42 loop lengths; edges add some.
            let loops = 42.0 * fabric.loop_length / fabric.path_ratio;
            assert!(census.yarn_length_m > loops && census.yarn_length_m < 2.0 * loops, "{census:?}");
            assert!((census.mass_kg - census.yarn_length_m * 4e-4).abs() < 1e-15);
        }
    }

    #[test]
    fn each_of_several_yarns_in_one_pass_has_the_whole_length_and_its_own_mass() {
        let (heavy, fabric) = cards();
        let light = YarnCard { linear_density: 1e-4, ..heavy.clone() };
        let member =
            |name: &str, grey, card: &YarnCard| Member { name: name.to_owned(), color: [grey; 3], card: card.clone() };
        let rows = |yarns: [u8; 4]| yarns.map(|yarn| vec![yarn; 6]).to_vec();
        let chart = Chart::stockinette().repeat(6, 4).unwrap().with_yarns(rows([0, 0, 1, 1])).unwrap();
        let mut network = knit::fabric(&chart, Working::Flat { first_row: Side::RightSide }, &fabric);
        network.yarn_color.fill([0x10; 3]);
        let census = |both: YarnCard, members: [Member; 2]| {
            let yarns = Yarns::new(heavy.clone(), [both]);
            let yarns = yarns.named(vec!["A".to_owned(), "P".to_owned()], vec![Vec::new(), members.to_vec()]);
            Census::of(&network, &yarns, &fabric)
        };
        let plated = [member("A", 0x10, &heavy), member("B", 0xf0, &light)];
        let found = census(YarnCard::together(&heavy, [&light]), plated.clone());
        let [alone, both] = found.yarn_lengths_m[..] else { panic!("{found:?}") };
        let [a, b] = &found.amounts[..] else { panic!("{found:?}") };
        assert_eq!([&a.name, &a.color, &b.name, &b.color], ["A", "#101010", "B", "#f0f0f0"]);
        assert!((a.length_m - alone - both).abs() < 1e-12 && b.length_m == both, "alone and in the pass of both");
        assert!((a.mass_kg - 4e-4 * a.length_m).abs() < 1e-12 && (b.mass_kg - 1e-4 * both).abs() < 1e-12);
        assert!((found.mass_kg - a.mass_kg - b.mass_kg).abs() < 1e-12, "nothing is counted twice");
        // Held double: twice the length of one yarn.
        let twice = [member("B", 0xf0, &light), member("B", 0xf0, &light)];
        let doubled = census(YarnCard::together(&light, [&light]), twice);
        assert!((doubled.amounts[1].length_m - 2.0 * both).abs() < 1e-12);
        // A density that the whole says itself is shared as those of its members are.
        let said = census(YarnCard { linear_density: 1e-3, ..heavy.clone() }, plated);
        assert!((said.amounts[1].mass_kg - 0.2 * 1e-3 * both).abs() < 1e-12);
        // Two colours of one yarn are told apart.
        network.yarn_kind.fill(0);
        network.yarn_color[0] = [0x20; 3];
        let colors = Census::of(&network, &heavy, &fabric).amounts;
        assert_eq!(colors.iter().map(|of| of.color.as_str()).collect::<Vec<_>>(), ["#101010", "#202020"]);
        assert!(colors.iter().all(|of| of.name == "yarn"));
    }
}
