//! The patches of a rank and the exchanges between them: interface between physics and `decomp`.
//!
//! An exchange and the phase after it are one call: while messages to and from other ranks are in
//! transit, the phase runs on inner patches, which receive nothing from other ranks.

use std::time::Instant;

use decomp::{Comm, GhostExchange, Layout, NodeExchange, Parity, ParticleError, fold_mirrors};
use rayon::prelude::*;

use crate::scene::FilterHalo;
use crate::solver::clock::{self, Activity, Clock, Watcher};
use crate::solver::patch::Patch;

/// The patches of this rank and their exchanges, for one step.
pub struct World<'a, const D: usize> {
    /// Communicator.
    pub comm: &'a dyn Comm,
    /// Patches of all ranks.
    pub layout: &'a Layout<D>,
    /// Patches of this rank.
    pub patches: &'a mut [Patch<D>],
    /// Exchange of ghosts and migrating particles.
    pub particles: &'a mut GhostExchange<D>,
    /// Exchange of final nodal values.
    pub nodes: &'a mut NodeExchange<D>,
    /// Patches that receive nothing from other ranks in an exchange of particles.
    pub inner_particles: &'a [bool],
    /// Patches that receive nothing from other ranks in an exchange of nodal values.
    pub inner_nodes: &'a [bool],
    /// How filters obtain values beyond a patch.
    pub filter: FilterHalo,
    /// Whether inner patches are computed while messages are in transit.
    pub overlap: bool,
    /// Conditions for quiescent patches; taken by the first exchange of particles of the step.
    pub sleep: Option<Sleep>,
    /// Threads over patches; `None`: this thread only.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Clock of the rank.
    pub clock: &'a mut Clock,
}

/// Conditions under which a patch at rest becomes quiescent.
#[derive(Clone, Copy, Debug)]
pub struct Sleep {
    /// Steps without motion nearby after which a step computes nothing new.
    pub needed: u32,
    /// Nodal fields that are not zero at rest.
    pub kept: [usize; 7],
}

/// Patches on which a phase runs.
#[derive(Clone, Copy)]
enum Which<'a> {
    All,
    /// Inner patches, or all others.
    Inner(&'a [bool], bool),
}

/// Phase on one patch. One call per patch through a pointer, so that exchanges and threading are
/// compiled once and not for each phase.
type PatchPhase<'a, const D: usize> = &'a (dyn Fn(&mut Patch<D>) + Send + Sync);

/// Runs a phase on every patch of `which` that is not quiescent.
fn for_each<const D: usize>(
    pool: Option<&rayon::ThreadPool>,
    patches: &mut [Patch<D>],
    which: Which<'_>,
    phase: PatchPhase<'_, D>,
) {
    let wanted = |k: usize, patch: &Patch<D>| {
        !patch.quiescence.is_quiescent()
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
    /// Runs a phase on every patch that is not quiescent.
    pub fn each(&mut self, name: &'static str, phase: impl Fn(&mut Patch<D>) + Send + Sync) {
        self.clock.operations.plain_phases += 1;
        let start = self.clock.now();
        let watcher = self.clock.watcher();
        for_each(self.pool, self.patches, Which::All, &|p| watcher.time(name, p, &phase));
        self.clock.add_since(Activity::Compute, start, 0.0);
    }

    /// Exchanges particles (migration and ghosts) and runs the phases up to the next exchange,
    /// which read nodal values beyond their patch: once for all patches, with messages, or for each
    /// patch separately if its ghost layer is deep enough. The first exchange of a step decides
    /// which patches are quiescent. Collective between neighbours.
    ///
    /// # Errors
    ///
    /// If a particle has moved past the neighbours of its patch.
    pub fn exchange_particles(
        &mut self,
        phases: impl Fn(&mut Nodal<'_, D>) + Send + Sync,
    ) -> Result<(), ParticleError> {
        self.run_phases(&phases)
    }

    fn run_phases(
        &mut self,
        phases: &(dyn Fn(&mut Nodal<'_, D>) + Send + Sync),
    ) -> Result<(), ParticleError> {
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
                        inner_particles: self.inner_particles,
                        inner_nodes: self.inner_nodes,
                        particles: Some((self.particles, &settle)),
                        plan: self.nodes,
                        failed: None,
                    },
                    pending: None,
                    part: None,
                };
                phases(&mut nodal);
                match nodal.halo {
                    Halo::Exchange { failed: Some(error), .. } => Err(error),
                    _ => Ok(()),
                }
            }
            FilterHalo::Redundant => {
                let (layout, watcher) = (self.layout, self.clock.watcher());
                let alone = |patch: &mut Patch<D>| {
                    let patches = std::slice::from_mut(patch);
                    let halo = Halo::Deep(layout);
                    let (pending, part) = (None, None);
                    phases(&mut Nodal { patches, pool: None, watcher, halo, pending, part });
                };
                let mut ranks = Ranks { comm: self.comm, overlap: self.overlap, clock: self.clock };
                let inner = self.inner_particles;
                ranks.exchange_particles(
                    self.patches,
                    self.particles,
                    inner,
                    self.pool,
                    &settle,
                    &alone,
                )
            }
        }
    }
}

/// Exchanges with other ranks, and their overlap with computing.
struct Ranks<'a> {
    comm: &'a dyn Comm,
    overlap: bool,
    clock: &'a mut Clock,
}

impl Ranks<'_> {
    /// Exchanges particles and runs a phase on every patch.
    fn exchange_particles<const D: usize>(
        &mut self,
        patches: &mut [Patch<D>],
        particles: &mut GhostExchange<D>,
        inner: &[bool],
        pool: Option<&rayon::ThreadPool>,
        settle: Settle<'_, D>,
        phase: PatchPhase<'_, D>,
    ) -> Result<(), ParticleError> {
        self.clock.operations.particle_exchanges += 1;
        let mut result = Ok(());
        self.around(
            "exchange particles",
            patches,
            pool,
            inner,
            |comm, patches, meanwhile| result = particles.run(comm, patches, pool, meanwhile),
            &|patch| settle(patch),
            phase,
        );
        result
    }

    /// Runs `exchange`, and `phase` on every patch, on inner patches during the exchange; `ready`
    /// is called on each patch before its phase, also on quiescent ones.
    // one function keeps the order of exchange and phase; a struct for its arguments would be used
    // only once
    #[expect(clippy::too_many_arguments)]
    fn around<const D: usize>(
        &mut self,
        name: &'static str,
        patches: &mut [Patch<D>],
        pool: Option<&rayon::ThreadPool>,
        inner: &[bool],
        exchange: impl FnOnce(&dyn Comm, &mut [Patch<D>], &mut dyn FnMut(&mut [Patch<D>])),
        ready: &dyn Fn(&mut Patch<D>),
        phase: PatchPhase<'_, D>,
    ) {
        let mut computed = 0.0;
        let clock_runs = !self.clock.is_stopped();
        let mut compute = |patches: &mut [Patch<D>], is: bool| {
            let start = clock_runs.then(Instant::now);
            for (patch, _) in patches.iter_mut().zip(inner).filter(|(_, i)| **i == is) {
                ready(patch);
            }
            for_each(pool, patches, Which::Inner(inner, is), phase);
            computed += start.map_or(0.0, |start| start.elapsed().as_secs_f64());
        };
        let start = self.clock.now();
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

/// Patches in a sequence of phases with exchanges of nodal values between them.
pub struct Nodal<'a, const D: usize> {
    patches: &'a mut [Patch<D>],
    pool: Option<&'a rayon::ThreadPool>,
    watcher: Watcher,
    halo: Halo<'a, D>,
    /// Fields to exchange before the next phase.
    pending: Option<smallvec::SmallVec<[(usize, Parity); 8]>>,
    /// Part of the step that these phases belong to.
    part: Option<usize>,
}

/// Makes a patch quiescent or active, once its particles are known.
type Settle<'a, const D: usize> = &'a (dyn Fn(&mut Patch<D>) + Sync);

enum Halo<'a, const D: usize> {
    Exchange {
        ranks: Ranks<'a>,
        inner_particles: &'a [bool],
        inner_nodes: &'a [bool],
        /// Particles to exchange before the first phase.
        particles: Option<(&'a mut GhostExchange<D>, Settle<'a, D>)>,
        plan: &'a mut NodeExchange<D>,
        failed: Option<ParticleError>,
    },
    Deep(&'a Layout<D>),
}

impl<const D: usize> Nodal<'_, D> {
    /// Accounts the time of the following phases to a [part](super::parts) of the step.
    pub fn count_as(&mut self, part: Option<usize>) {
        self.part = part;
    }

    /// Runs a phase on every patch that is not quiescent, after the exchange that it needs.
    pub fn each(&mut self, name: &'static str, phase: impl Fn(&mut Patch<D>) + Send + Sync) {
        self.run(name, &phase);
    }

    fn run(&mut self, name: &'static str, phase: PatchPhase<'_, D>) {
        let watcher = self.watcher;
        let part = self.part;
        let timed = |patch: &mut Patch<D>| {
            watcher.time(name, patch, |patch| match part {
                Some(part) => clock::timed(part, patch, phase),
                None => phase(patch),
            });
        };
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
            // such a failure ends the run
            Halo::Exchange { failed: Some(_), .. } => {}
            Halo::Exchange { ranks, inner_particles, inner_nodes, particles, plan, failed } => {
                ranks.clock.operations.nodal_phases += 1;
                if let Some((particles, settle)) = particles.take() {
                    let (patches, pool) = (&mut *self.patches, self.pool);
                    *failed = ranks
                        .exchange_particles(
                            patches,
                            particles,
                            inner_particles,
                            pool,
                            settle,
                            &timed,
                        )
                        .err();
                } else if let Some(fields) = &fields {
                    ranks.clock.operations.node_exchanges += 1;
                    ranks.clock.operations.node_fields += fields.len() as u64;
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
                    let start = ranks.clock.now();
                    for_each(self.pool, self.patches, Which::All, &timed);
                    ranks.clock.add_since(Activity::Compute, start, 0.0);
                }
            }
        }
    }

    /// Requests that nodal values beyond the patches are exchanged before the next phase, together
    /// with those that are already requested.
    pub fn refresh(&mut self, fields: &[(usize, Parity)]) {
        self.pending.get_or_insert_default().extend_from_slice(fields);
    }
}
