//! The patches of a rank and the exchanges between them: where physics and `decomp` meet.
//!
//! An exchange and the phase after it are one call: the phase runs on inner patches, which hear
//! of no other rank, while messages to and from the others are on their way.

use std::time::Instant;

use decomp::{Comm, Layout, NodeExchange, Parity, RowError, RowExchange, fold_mirrors};
use rayon::prelude::*;

use crate::scene::FilterHalo;
use crate::solver::clock::{Activity, Clock, Watcher};
use crate::solver::patch::Patch;

/// The patches of this rank and the way to the others, for one step.
pub struct World<'a, const D: usize> {
    /// The ranks.
    pub comm: &'a dyn Comm,
    /// The patches of all ranks.
    pub layout: &'a Layout<D>,
    /// This rank's patches.
    pub patches: &'a mut [Patch<D>],
    /// Ghosts and migration.
    pub rows: &'a mut RowExchange<D>,
    /// Finished nodal values.
    pub nodes: &'a mut NodeExchange<D>,
    /// Which patches hear of no other rank as rows are exchanged.
    pub inner_rows: &'a [bool],
    /// Which patches hear of no other rank as nodal values are.
    pub inner_nodes: &'a [bool],
    /// How filters get what lies beyond a patch.
    pub filter: FilterHalo,
    /// Whether inner patches are computed while messages fly.
    pub overlap: bool,
    /// When patches sleep, until the step's first exchange of rows has seen to it.
    pub sleep: Option<Sleep>,
    /// Threads over patches; `None`: this thread alone.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Where the time goes.
    pub clock: &'a mut Clock,
}

/// When a patch at rest may sleep.
#[derive(Clone, Copy, Debug)]
pub struct Sleep {
    /// Steps without anything near that moves after which a step computes nothing new.
    pub needed: u32,
    /// Nodal fields that are not zero at rest.
    pub kept: [usize; 5],
}

/// Which patches a phase runs on.
#[derive(Clone, Copy)]
enum Which<'a> {
    All,
    /// Those that are inner, or those that are not.
    Inner(&'a [bool], bool),
}

/// A phase on one patch. A call through a pointer, one a patch, so that the exchanges and the threads
/// about it are compiled once and not for each phase.
type Phase<'a, const D: usize> = &'a (dyn Fn(&mut Patch<D>) + Send + Sync);

/// Runs a phase on every patch of `which` that is awake.
fn for_each<const D: usize>(
    pool: Option<&rayon::ThreadPool>,
    patches: &mut [Patch<D>],
    which: Which<'_>,
    phase: Phase<'_, D>,
) {
    let wanted = |k: usize, patch: &Patch<D>| {
        !patch.rest.asleep()
            && match which {
                Which::All => true,
                Which::Inner(inner, is) => inner[k] == is,
            }
    };
    let run = |(k, patch): (usize, &mut Patch<D>)| {
        if wanted(k, patch) {
            phase(patch);
        }
    };
    match pool {
        Some(pool) => pool.install(|| patches.par_iter_mut().enumerate().for_each(run)),
        None => patches.iter_mut().enumerate().for_each(run),
    }
}

impl<const D: usize> World<'_, D> {
    /// Runs a phase on every patch that is awake.
    pub fn each(&mut self, name: &'static str, phase: impl Fn(&mut Patch<D>) + Send + Sync) {
        let start = Instant::now();
        let watcher = self.clock.watcher();
        for_each(self.pool, self.patches, Which::All, &|p| watcher.time(name, p, &phase));
        self.clock.add_since(Activity::Compute, start, 0.0);
    }

    /// The step's exchange of rows, migration and ghosts, and the phases after it up to the next,
    /// which see nodal values beyond their patch: once for all patches, with messages, or for
    /// each patch by itself where its ghosts are deep enough. Patches fall asleep and wake by the
    /// first exchange of a step. Collective between neighbours.
    pub fn exchange_rows(
        &mut self,
        phases: impl Fn(&mut Nodal<'_, D>) + Send + Sync,
    ) -> Result<(), RowError> {
        self.run_phases(&phases)
    }

    fn run_phases(
        &mut self,
        phases: &(dyn Fn(&mut Nodal<'_, D>) + Send + Sync),
    ) -> Result<(), RowError> {
        let sleep = self.sleep.take();
        let settle = move |patch: &mut Patch<D>| {
            if let Some(sleep) = &sleep {
                patch.settle(sleep.needed, &sleep.kept);
            }
        };
        match self.filter {
            FilterHalo::Exchange => {
                let mut nodal = Nodal {
                    patches: self.patches,
                    pool: self.pool,
                    watcher: self.clock.watcher(),
                    halo: Halo::Exchange {
                        ranks: Ranks { comm: self.comm, overlap: self.overlap, clock: self.clock },
                        inner_rows: self.inner_rows,
                        inner_nodes: self.inner_nodes,
                        rows: Some((self.rows, &settle)),
                        plan: self.nodes,
                        failed: None,
                    },
                    pending: None,
                };
                phases(&mut nodal);
                match nodal.halo {
                    Halo::Exchange { failed: Some(error), .. } => Err(error),
                    _ => Ok(()),
                }
            }
            FilterHalo::Deep => {
                let (layout, watcher) = (self.layout, self.clock.watcher());
                let alone = |patch: &mut Patch<D>| {
                    let patches = std::slice::from_mut(patch);
                    let halo = Halo::Deep(layout);
                    phases(&mut Nodal { patches, pool: None, watcher, halo, pending: None });
                };
                let mut ranks = Ranks { comm: self.comm, overlap: self.overlap, clock: self.clock };
                let inner = self.inner_rows;
                ranks.exchange_rows(self.patches, self.rows, inner, self.pool, &settle, &alone)
            }
        }
    }
}

/// The other ranks, and what computing overlaps with their messages.
struct Ranks<'a> {
    comm: &'a dyn Comm,
    overlap: bool,
    clock: &'a mut Clock,
}

impl Ranks<'_> {
    /// Exchanges rows and runs a phase on every patch.
    fn exchange_rows<const D: usize>(
        &mut self,
        patches: &mut [Patch<D>],
        rows: &mut RowExchange<D>,
        inner: &[bool],
        pool: Option<&rayon::ThreadPool>,
        settle: Settle<'_, D>,
        phase: Phase<'_, D>,
    ) -> Result<(), RowError> {
        let mut result = Ok(());
        self.around(
            "exchange rows",
            patches,
            pool,
            inner,
            |comm, patches, meanwhile| result = rows.run(comm, patches, meanwhile),
            &|patch| settle(patch),
            phase,
        );
        result
    }

    /// Runs `exchange` and `phase` on every patch, on the inner ones within the exchange; `ready`
    /// is called on each patch before its phase, asleep or not.
    // one place for the order of exchange and phase; a struct of its arguments would be used once
    #[allow(clippy::too_many_arguments)]
    fn around<const D: usize>(
        &mut self,
        name: &'static str,
        patches: &mut [Patch<D>],
        pool: Option<&rayon::ThreadPool>,
        inner: &[bool],
        exchange: impl FnOnce(&dyn Comm, &mut [Patch<D>], &mut dyn FnMut(&mut [Patch<D>])),
        ready: &dyn Fn(&mut Patch<D>),
        phase: Phase<'_, D>,
    ) {
        let mut computed = 0.0;
        let mut compute = |patches: &mut [Patch<D>], is: bool| {
            let start = Instant::now();
            for (patch, _) in patches.iter_mut().zip(inner).filter(|(_, i)| **i == is) {
                ready(patch);
            }
            for_each(pool, patches, Which::Inner(inner, is), phase);
            computed += start.elapsed().as_secs_f64();
        };
        let start = Instant::now();
        let waited = self.comm.traffic().waited;
        let overlap = self.overlap;
        exchange(self.comm, patches, &mut |patches| {
            if overlap {
                compute(patches, true);
            }
        });
        self.clock.event(name, start);
        if !overlap {
            compute(patches, true);
        }
        compute(patches, false);
        let waited = self.comm.traffic().waited - waited;
        self.clock.add(Activity::Compute, computed);
        self.clock.add(Activity::Wait, waited);
        self.clock.add_since(Activity::Exchange, start, computed + waited);
        self.comm.heartbeat();
    }
}

/// Patches whose phases follow each other with nodal values in between.
pub struct Nodal<'a, const D: usize> {
    patches: &'a mut [Patch<D>],
    pool: Option<&'a rayon::ThreadPool>,
    watcher: Watcher,
    halo: Halo<'a, D>,
    /// Fields to be made whole before the next phase.
    pending: Option<smallvec::SmallVec<[(usize, Parity); 8]>>,
}

/// Lets a patch sleep or wakes it, once its rows are there.
type Settle<'a, const D: usize> = &'a (dyn Fn(&mut Patch<D>) + Sync);

enum Halo<'a, const D: usize> {
    Exchange {
        ranks: Ranks<'a>,
        inner_rows: &'a [bool],
        inner_nodes: &'a [bool],
        /// The rows to be exchanged before the first phase.
        rows: Option<(&'a mut RowExchange<D>, Settle<'a, D>)>,
        plan: &'a mut NodeExchange<D>,
        failed: Option<RowError>,
    },
    Deep(&'a Layout<D>),
}

impl<const D: usize> Nodal<'_, D> {
    /// Runs a phase on every patch that is awake, once the values it needs are there.
    pub fn each(&mut self, name: &'static str, phase: impl Fn(&mut Patch<D>) + Send + Sync) {
        self.run(name, &phase);
    }

    fn run(&mut self, name: &'static str, phase: Phase<'_, D>) {
        let watcher = self.watcher;
        let timed = |patch: &mut Patch<D>| watcher.time(name, patch, phase);
        let fields = self.pending.take();
        match &mut self.halo {
            Halo::Deep(layout) => {
                for patch in self.patches.iter_mut() {
                    if let Some(fields) = &fields {
                        fold_mirrors(layout, &mut patch.nodes, fields);
                    }
                    timed(patch);
                }
            }
            // the run ends on such a failure
            Halo::Exchange { failed: Some(_), .. } => {}
            Halo::Exchange { ranks, inner_rows, inner_nodes, rows, plan, failed } => {
                if let Some((rows, settle)) = rows.take() {
                    let (patches, pool) = (&mut *self.patches, self.pool);
                    *failed =
                        ranks.exchange_rows(patches, rows, inner_rows, pool, settle, &timed).err();
                } else if let Some(fields) = &fields {
                    ranks.around(
                        "exchange nodes",
                        self.patches,
                        self.pool,
                        inner_nodes,
                        |comm, patches, then| plan.refresh(comm, patches, fields, then),
                        &|_| {},
                        &timed,
                    );
                } else {
                    let start = Instant::now();
                    for_each(self.pool, self.patches, Which::All, &timed);
                    ranks.clock.add_since(Activity::Compute, start, 0.0);
                }
            }
        }
    }

    /// Makes nodal values whole beyond the patches before the next phase.
    pub fn refresh(&mut self, fields: &[(usize, Parity)]) {
        debug_assert!(self.pending.is_none(), "a phase comes between two exchanges");
        self.pending = Some(fields.into());
    }
}
