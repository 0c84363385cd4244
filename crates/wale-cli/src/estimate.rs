//! What a scene will take, before anything is built: nodes, memory, files.

use serde::Serialize;
use wale::dynamics::linear::DIRECT_UNKNOWNS;
use wale::model::LinearSolver;
use wale::scene::Scene;

use crate::exit::{Code, Failure};
use crate::output::bytes;

/// Nodes of a loop inside a fabric \[Cirio2017\].
const NODES_A_LOOP: f64 = 4.0;
/// Coordinates of a node that can move, nearly.
const UNKNOWNS_A_NODE: f64 = 5.0;
/// Bytes a node of yarns, stacks, contacts and the initial layout.
const NETWORK_BYTES: f64 = 700.0;
/// Bytes a node of all energies' elements and lists, and of vectors; a run of 200,000 nodes peaks at 6.6 kB a node.
const ENERGY_BYTES: f64 = 3300.0;
/// Numbers of a node's eleven blocks of five by five; those of a factored matrix have 8 bytes, others 4.
const MATRIX_NUMBERS: f64 = 11.0 * 25.0;
/// Bytes of factor a node and doubling of the nodes.
const FACTOR_BYTES: f64 = 120.0;
/// Bytes a node of the incomplete factor and the coarse space.
const PRECONDITIONER_BYTES: f64 = 1000.0;
/// Nodes of a loop at an edge besides those: cast-on, bind-off and turns.
const NODES_AN_EDGE_LOOP: f64 = 2.0;

/// Memory by what it is for \[bytes\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Nodes.
    pub nodes: u64,
    /// What takes memory, and how much.
    pub memory: Vec<(&'static str, u64)>,
}

impl Estimate {
    /// What a run of a scene will take.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let [rows, columns] = scene.structure.size().map(|n| n as u64);
        let solver = scene.plan.simulation.linear_solver;
        match scene.structure.woven() {
            Some(_) => Self::of_draft(rows, columns, solver),
            None => Self::of_chart(rows, columns, solver),
        }
    }

    /// What laying it out alone takes.
    #[must_use]
    pub fn laid_out(mut self) -> Self {
        self.memory.truncate(1);
        self
    }

    /// For a fabric of so many rows and columns.
    #[must_use]
    pub fn of_chart(rows: u64, columns: u64, solver: LinearSolver) -> Self {
        let (rows, columns) = (rows as f64, columns as f64);
        Self::of_nodes(NODES_A_LOOP * rows * columns + NODES_AN_EDGE_LOOP * (rows + columns), solver)
    }

    /// For a weave of so many picks and ends: a node a crossing, and the ends of the yarns.
    #[must_use]
    pub fn of_draft(picks: u64, ends: u64, solver: LinearSolver) -> Self {
        let (picks, ends) = (picks as f64, ends as f64);
        Self::of_nodes(picks * ends + NODES_AN_EDGE_LOOP * (picks + ends), solver)
    }

    fn of_nodes(nodes: f64, solver: LinearSolver) -> Self {
        let linear = |bytes_a_node: f64| (bytes_a_node * nodes) as u64;
        let direct = match solver {
            LinearSolver::Automatic => UNKNOWNS_A_NODE * nodes <= DIRECT_UNKNOWNS as f64,
            LinearSolver::Cholesky => true,
            LinearSolver::ConjugateGradient => false,
        };
        let solver = if direct {
            // Fill on a planar graph grows as n log n.
            ("factor of the matrix", linear(FACTOR_BYTES * nodes.max(2.0).log2()))
        } else {
            ("preconditioner", linear(PRECONDITIONER_BYTES))
        };
        let memory = vec![
            ("yarns and nodes", linear(NETWORK_BYTES)),
            ("energies", linear(ENERGY_BYTES)),
            ("matrix", linear(MATRIX_NUMBERS * if direct { 8.0 } else { 4.0 })),
            solver,
        ];
        Self { nodes: nodes as u64, memory }
    }

    /// All of it \[bytes\].
    #[must_use]
    pub fn total(&self) -> u64 {
        self.memory.iter().fold(0, |sum, (_, bytes)| sum.saturating_add(*bytes))
    }

    /// Wall time of a run \[s\], at least and at most: with steps of the longest and of a twentieth of that.
    #[must_use]
    pub fn seconds(&self, duration: f64, largest_step: f64) -> [f64; 2] {
        let steps = duration / largest_step;
        let seconds = steps * self.nodes as f64 / NODE_STEPS_A_SECOND;
        [seconds, 20.0 * seconds]
    }

    /// Refuses what does not fit.
    ///
    /// # Errors
    /// [`Code::ResourceLimit`], naming the largest item; never without a limit.
    pub fn check(&self, limit: Option<u64>) -> Result<(), Failure> {
        let total = self.total();
        let Some(limit) = limit.filter(|limit| total > *limit) else { return Ok(()) };
        let (name, largest) = self.memory.iter().max_by_key(|item| item.1).copied().unwrap_or(("all", total));
        Err(Failure::new(
            Code::ResourceLimit,
            format_args!(
                "the scene needs about {} of memory for {} nodes and {} are to be had; the largest item is the {name} \
                 with {}: make the chart smaller, or give more with --max-memory",
                bytes(total),
                crate::output::grouped(self.nodes),
                bytes(limit),
                bytes(largest)
            ),
        ))
    }
}

/// Speed that the estimate of time assumes: that of two cores.
const NODE_STEPS_A_SECOND: f64 = 5e4;

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(rows: u64, columns: u64) -> Estimate {
        Estimate::of_chart(rows, columns, LinearSolver::Automatic)
    }

    #[test]
    fn what_does_not_fit_is_refused_by_its_largest_item() {
        let large = Estimate::of_chart(1_000_000, 1_000_000, LinearSolver::Cholesky);
        let failure = large.check(Some(8_000_000_000)).unwrap_err();
        assert_eq!(failure.code, Code::ResourceLimit);
        assert!(failure.message.unwrap().contains("factor of the matrix"));
        assert!(large.check(None).is_ok());
        assert!(estimate(20, 20).check(Some(100_000_000)).is_ok());
        assert!(estimate(200, 200).laid_out().total() < estimate(200, 200).total() / 5);
        assert_eq!(estimate(u64::MAX, u64::MAX).total(), u64::MAX);
    }
}
