//! What each part of a yarn's fit is for: the fit is made again without it [Sperl2022, Figs. 11 and 16 to 18].

use super::objective::YarnFitError;
use super::run::{Way, YarnFit};
use super::swarm::SwarmSettings;

/// What of the paper's model is left out, to see what it is for [Sperl2022, Figs. 16 to 18].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ablation {
    /// Yarns of one stiffness.
    pub one_phase: bool,
    /// Yarns at rest as they were registered.
    pub no_rest_shapes: bool,
    /// Bending stiffnesses are fitted too.
    pub with_bending: bool,
    /// Nothing holds the yarns, as in the paper.
    pub nothing_holds: bool,
}

/// A fit that is made to be compared with the whole one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AblationKind {
    /// The paper's swarm and COBYLA, in place of gradients.
    Swarm,
    /// COBYLA alone [Sperl2022, Fig. 11].
    LocalOnly,
    /// Without the soft phase of the yarn's stretch [Sperl2022, Fig. 16].
    OnePhase,
    /// Without rest shapes [Sperl2022, Fig. 17].
    NoRestShapes,
    /// With the bending stiffnesses among the targets [Sperl2022, Fig. 18].
    WithBending,
    /// Without what holds the yarns, which the paper has not.
    NothingHolds,
}

impl AblationKind {
    /// All, in the order in which they are made.
    pub const ALL: [Self; 6] =
        [Self::Swarm, Self::LocalOnly, Self::OnePhase, Self::NoRestShapes, Self::WithBending, Self::NothingHolds];

    /// One word for files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Swarm => "swarm",
            Self::LocalOnly => "local-only",
            Self::OnePhase => "one-phase",
            Self::NoRestShapes => "no-rest-shapes",
            Self::WithBending => "with-bending",
            Self::NothingHolds => "nothing-holds",
        }
    }

    /// What was done, in words.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Swarm => "By a swarm and COBYLA",
            Self::LocalOnly => "By COBYLA alone",
            Self::OnePhase => "Without two phases of stretch",
            Self::NoRestShapes => "Without rest shapes",
            Self::WithBending => "With bending among the targets",
            Self::NothingHolds => "Without what holds the yarns",
        }
    }

    /// The figure of [Sperl2022, section 9] that shows it, if one does.
    #[must_use]
    pub fn figure(self) -> Option<&'static str> {
        match self {
            Self::LocalOnly => Some("Fig. 11"),
            Self::OnePhase => Some("Fig. 16"),
            Self::NoRestShapes => Some("Fig. 17"),
            Self::WithBending => Some("Fig. 18"),
            Self::Swarm | Self::NothingHolds => None,
        }
    }

    /// What is left out of the model.
    #[must_use]
    pub fn ablation(self) -> Ablation {
        Ablation {
            one_phase: self == Self::OnePhase,
            no_rest_shapes: self == Self::NoRestShapes,
            with_bending: self == Self::WithBending,
            nothing_holds: self == Self::NothingHolds,
        }
    }

    /// How it is fitted, where the whole is fitted in a way; `None` if that is the same fit.
    #[must_use]
    pub fn way(self, whole: &Way, swarm: SwarmSettings) -> Option<Way> {
        match (self, whole) {
            (Self::Swarm, Way::Swarm(_)) | (Self::LocalOnly, Way::Local(_)) => None,
            (Self::Swarm, _) => Some(Way::Swarm(swarm)),
            (Self::LocalOnly, _) => Some(Way::Local(swarm)),
            _ => Some(*whole),
        }
    }

    /// Whether all that it can find is within the bounds of the whole fit, which so should never end with a larger sum of squares.
    #[must_use]
    pub fn is_within_the_whole(self) -> bool {
        matches!(self, Self::Swarm | Self::LocalOnly | Self::OnePhase | Self::NothingHolds)
    }
}

/// A fit that was made to be compared.
#[derive(Clone, Debug)]
pub struct Ablated {
    /// Which.
    pub kind: AblationKind,
    /// What was found; none if the tile could be tested nowhere.
    pub fit: Option<YarnFit>,
    /// Mean error of the bending stiffnesses over their targets, of the whole fit and of this one, where they are compared \[–\].
    pub bending: Option<[f64; 2]>,
}

impl Ablated {
    /// Its errors.
    #[must_use]
    pub fn error(&self) -> Option<YarnFitError> {
        self.fit.as_ref().map(|fit| fit.error)
    }
}
