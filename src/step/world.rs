//! The patches of a rank and the exchanges between them: where physics and `decomp` meet.

use std::collections::BTreeMap;
use std::time::Instant;

use decomp::{Comm, Layout, NodeExchange, Parity, RowError, RowExchange, fold_mirrors};
use rayon::prelude::*;

use crate::patch::Patch;
use crate::scene::FilterHalo;

/// Seconds spent in each phase.
#[derive(Clone, Debug, Default)]
pub struct PhaseTimes(pub BTreeMap<&'static str, f64>);

impl PhaseTimes {
    /// Adds what has passed since `start` to a phase.
    pub fn add(&mut self, phase: &'static str, start: Instant) {
        *self.0.entry(phase).or_default() += start.elapsed().as_secs_f64();
    }
}

/// The patches of this rank and the way to the others.
pub struct World<'a> {
    /// The ranks.
    pub comm: &'a dyn Comm,
    /// The patches of all ranks.
    pub layout: &'a Layout<1>,
    /// This rank's patches.
    pub patches: &'a mut [Patch<1>],
    /// Ghosts and migration.
    pub rows: &'a mut RowExchange<1>,
    /// Finished nodal values.
    pub nodes: &'a mut NodeExchange<1>,
    /// How filters get what lies beyond a patch.
    pub filter: FilterHalo,
    /// Threads over patches; `None`: this thread alone.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Where the time went.
    pub times: &'a mut PhaseTimes,
}

/// Runs a phase on every patch.
fn for_each(
    pool: Option<&rayon::ThreadPool>,
    patches: &mut [Patch<1>],
    phase: impl Fn(&mut Patch<1>) + Send + Sync,
) {
    match pool {
        Some(pool) => pool.install(|| patches.par_iter_mut().for_each(phase)),
        None => patches.iter_mut().for_each(phase),
    }
}

impl World<'_> {
    /// Runs a phase on every patch.
    pub fn each(&mut self, phase: impl Fn(&mut Patch<1>) + Send + Sync) {
        let start = Instant::now();
        for_each(self.pool, self.patches, phase);
        self.times.add("compute", start);
    }

    /// The step's exchange of rows: migration and ghosts. Collective between neighbours.
    pub fn exchange_rows(&mut self) -> Result<(), RowError> {
        let start = Instant::now();
        let result = self.rows.run(self.comm, self.patches);
        self.times.add("rows", start);
        result
    }

    /// Runs the phases between two exchanges of rows, which see nodal values beyond their patch:
    /// once for all patches, with messages, or for each patch by itself where its ghosts are deep
    /// enough. Collective between neighbours.
    pub fn nodal(&mut self, phases: impl Fn(&mut Nodal<'_>) + Send + Sync) {
        match self.filter {
            FilterHalo::Exchange => phases(&mut Nodal {
                patches: self.patches,
                halo: Halo::Exchange { comm: self.comm, plan: self.nodes, times: self.times },
                pool: self.pool,
            }),
            FilterHalo::Deep => {
                let layout = self.layout;
                self.each(|patch| {
                    let patches = std::slice::from_mut(patch);
                    phases(&mut Nodal { patches, halo: Halo::Deep(layout), pool: None });
                });
            }
        }
    }
}

/// Patches whose phases follow each other with nodal values in between.
pub struct Nodal<'a> {
    patches: &'a mut [Patch<1>],
    halo: Halo<'a>,
    pool: Option<&'a rayon::ThreadPool>,
}

enum Halo<'a> {
    Exchange { comm: &'a dyn Comm, plan: &'a mut NodeExchange<1>, times: &'a mut PhaseTimes },
    Deep(&'a Layout<1>),
}

impl Nodal<'_> {
    /// Runs a phase on every patch.
    pub fn each(&mut self, phase: impl Fn(&mut Patch<1>) + Send + Sync) {
        let start = Instant::now();
        for_each(self.pool, self.patches, phase);
        if let Halo::Exchange { times, .. } = &mut self.halo {
            times.add("compute", start);
        }
    }

    /// Makes nodal values whole beyond the patches. Collective between neighbours.
    pub fn refresh(&mut self, fields: &[(usize, Parity)]) {
        match &mut self.halo {
            Halo::Exchange { comm, plan, times } => {
                let start = Instant::now();
                plan.refresh(*comm, self.patches, fields);
                times.add("nodes", start);
            }
            Halo::Deep(layout) => {
                for patch in self.patches.iter_mut() {
                    fold_mirrors(layout, &mut patch.nodes, fields);
                }
            }
        }
    }
}
