//! The patches of a rank and the exchanges between them: where physics and `decomp` meet.

use std::collections::BTreeMap;
use std::time::Instant;

use decomp::{Comm, NodeExchange, Parity, RowError, RowExchange};
use rayon::prelude::*;

use crate::patch::Patch;

/// Seconds spent in each phase.
#[derive(Clone, Debug, Default)]
pub struct PhaseTimes(pub BTreeMap<&'static str, f64>);

impl PhaseTimes {
    fn add(&mut self, phase: &'static str, start: Instant) {
        *self.0.entry(phase).or_default() += start.elapsed().as_secs_f64();
    }
}

/// The patches of this rank and the way to the others.
pub struct World<'a, C: Comm + ?Sized> {
    /// The ranks.
    pub comm: &'a C,
    /// This rank's patches.
    pub patches: &'a mut [Patch<1>],
    /// Ghosts and migration.
    pub rows: &'a mut RowExchange<1>,
    /// Finished nodal values.
    pub nodes: &'a mut NodeExchange<1>,
    /// Threads over patches; `None`: this thread alone.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Where the time went.
    pub times: &'a mut PhaseTimes,
}

impl<C: Comm + ?Sized> World<'_, C> {
    /// Runs a phase on every patch.
    pub fn each(&mut self, phase: impl Fn(&mut Patch<1>) + Send + Sync) {
        let start = Instant::now();
        match self.pool {
            Some(pool) => pool.install(|| self.patches.par_iter_mut().for_each(phase)),
            None => self.patches.iter_mut().for_each(phase),
        }
        self.times.add("compute", start);
    }

    /// The step's exchange of rows: migration and ghosts. Collective between neighbours.
    pub fn exchange_rows(&mut self) -> Result<(), RowError> {
        let start = Instant::now();
        let result = self.rows.run(self.comm, self.patches);
        self.times.add("rows", start);
        result
    }

    /// Fetches finished nodal values into the halos. Collective between neighbours.
    pub fn refresh(&mut self, fields: &[(usize, Parity)]) {
        let start = Instant::now();
        self.nodes.refresh(self.comm, self.patches, fields);
        self.times.add("nodes", start);
    }
}
