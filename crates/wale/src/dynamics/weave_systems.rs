//! The two systems of threads of a weave, and of which yarns they are.

use crate::model::{Network, YarnRole};

/// Which yarns a weave's warp and weft are of.
pub(super) struct Systems {
    /// Role and yarn of every thread.
    threads: Vec<(YarnRole, u8)>,
    /// The yarn of the first end.
    pub warp: Option<u8>,
    /// That of the first pick whose yarn is not in the warp.
    pub weft: Option<u8>,
}

impl Systems {
    pub fn of(network: &Network) -> Self {
        let threads = network.yarn_role.iter().copied().zip(network.yarn_kind.iter().copied()).collect();
        let mut systems = Self { threads, warp: None, weft: None };
        systems.warp = systems.threads.iter().find(|thread| thread.0 == YarnRole::Warp).map(|thread| thread.1);
        systems.weft = systems.threads.iter().map(|thread| thread.1).find(|&kind| systems.in_weft(kind));
        systems
    }

    pub fn in_warp(&self, kind: u8) -> bool {
        self.threads.contains(&(YarnRole::Warp, kind))
    }

    /// In the weft, and not in the warp.
    pub fn in_weft(&self, kind: u8) -> bool {
        self.threads.contains(&(YarnRole::Weft, kind)) && !self.in_warp(kind)
    }

    pub fn kinds(&self) -> usize {
        self.threads.iter().map(|&(_, kind)| usize::from(kind) + 1).max().unwrap_or(1)
    }
}
