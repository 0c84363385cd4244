//! What a fabric is made by: a chart that hands work, a program that a machine works, or a draft on a loom.

use super::chart::Chart;
use super::knit;
use super::knitout::{KnitoutError, Knitted, read_knitout};
use super::weave::Woven;
use super::working::Working;
use crate::model::{FabricCard, Network};

/// The making of a fabric.
#[derive(Clone, PartialEq, Debug)]
pub enum Structure {
    /// Rows of stitches, flat or in the round.
    Chart {
        /// The stitches.
        chart: Chart,
        /// How they are worked.
        working: Working,
    },
    /// A program in knitout.
    Machine(Box<Program>),
    /// A draft on a loom.
    Woven(Box<Woven>),
}

/// A program in knitout and what it becomes.
#[derive(Clone, PartialEq, Debug)]
pub struct Program {
    /// Its text.
    pub text: String,
    /// Its loops.
    pub knitted: Knitted,
}

impl Program {
    /// Works a program.
    ///
    /// # Errors
    /// Where it is no knitout or cannot be knitted.
    pub fn new(text: String) -> Result<Self, KnitoutError> {
        Ok(Self { knitted: read_knitout(&text)?, text })
    }
}

impl Structure {
    /// A chart worked flat, its right side first.
    #[must_use]
    pub fn flat(chart: Chart) -> Self {
        Self::Chart { chart, working: Working::default() }
    }

    /// The chart, if there is one.
    #[must_use]
    pub fn chart(&self) -> Option<&Chart> {
        match self {
            Self::Chart { chart, .. } => Some(chart),
            Self::Machine(_) | Self::Woven(_) => None,
        }
    }

    /// Whether the fabric is laid out as a tube.
    #[must_use]
    pub fn is_round(&self) -> bool {
        matches!(self, Self::Chart { working: Working::Round, .. })
    }

    /// Rows and columns.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        match self {
            Self::Chart { chart, .. } => [chart.row_count(), chart.column_count()],
            Self::Machine(program) => program.knitted.graph.size.map(|n| n as usize),
            Self::Woven(woven) => [woven.draft.picks(), woven.draft.ends()],
        }
    }

    /// Number of different yarns.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        match self {
            Self::Chart { chart, .. } => chart.yarn_count(),
            Self::Machine(program) => program.knitted.carriers.len(),
            Self::Woven(woven) => woven.draft.yarn_count(),
        }
    }

    /// What is unusual in the program or the file of a draft, but can be made, with its line.
    pub fn remarks(&self) -> impl Iterator<Item = (usize, &str)> {
        let remarks = match self {
            Self::Chart { .. } => &[][..],
            Self::Machine(program) => &program.knitted.remarks,
            Self::Woven(woven) => &woven.remarks,
        };
        remarks.iter().map(|remark| (remark.line, remark.what.as_str()))
    }

    /// The draft, if it is woven.
    #[must_use]
    pub fn woven(&self) -> Option<&Woven> {
        match self {
            Self::Woven(woven) => Some(woven),
            _ => None,
        }
    }

    /// The network of its plain layout.
    ///
    /// # Panics
    /// If the card is that of a knit and the structure woven, or the other way round.
    #[must_use]
    pub fn network(&self, card: &FabricCard) -> Network {
        match (self, card) {
            (Self::Chart { chart, working }, FabricCard::Knit(card)) => knit::fabric(chart, *working, card),
            (Self::Machine(program), FabricCard::Knit(card)) => knit::network(&program.knitted.graph, card),
            (Self::Woven(woven), FabricCard::Woven(card)) => woven.network(card.spacing),
            _ => panic!("a knit has the card of a knit, and a weave that of a weave"),
        }
    }
}
