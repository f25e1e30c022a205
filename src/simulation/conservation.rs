//! Counters and balances of a run: particle steps computed and skipped, particles moved and
//! removed, and the census that detects lost or duplicated particles.

use decomp::{Census, ExactSum};

use super::accounts::{Counters, Removed, RemovedByKind, left_sums};
use super::error::RunError;
use super::run::Simulation;
use crate::solver::clock::Event;
use crate::solver::patch::BoundaryWork;

impl<const D: usize> Simulation<'_, D> {
    /// Accumulated work and impulse of transmitting sides, pressures, wall friction and the
    /// acceleration of the grid, in the frame of the grid. Collective.
    pub fn given(&self) -> BoundaryWork<D> {
        let mut sums = self.side_books.sums.clone();
        ExactSum::over_ranks(self.comm, &mut sums);
        let impulse = std::array::from_fn(|a| sums[1 + a].value());
        BoundaryWork { work: sums[0].value(), impulse }
    }

    /// Counts the particles that the step computed and skipped; returns the number computed.
    pub(super) fn count_step(&mut self) -> u64 {
        let (mut computed, mut skipped) = (0, 0);
        for patch in &self.patches {
            let particles = patch.block.own() as u64;
            if patch.quiescence.is_quiescent() {
                skipped += particles
            } else {
                computed += particles
            }
        }
        if self.step == 0 {
            return 0;
        }
        self.tally.particle_steps += computed;
        self.tally.skipped_particle_steps += skipped;
        computed
    }

    /// Counters of this rank.
    pub fn tally(&mut self) -> Counters {
        self.tally.migrated += self.plan.particles.take_migrated();
        self.tally
    }

    /// Timeline events of patches, with patch numbers: of the patches of this rank, and of those
    /// that it handed to other ranks.
    pub fn take_patch_events(&mut self) -> Vec<(usize, Event)> {
        let mine = self.layout.patches_of(self.comm.rank());
        for (patch, index) in self.patches.iter_mut().zip(mine) {
            let events = patch.stopwatch.events.drain(..);
            self.given_events.extend(events.map(|e| (index, e)));
        }
        std::mem::take(&mut self.given_events)
    }

    /// Number of particles of this rank.
    pub fn particles(&self) -> u64 {
        self.patches.iter().map(|p| p.block.own() as u64).sum()
    }

    /// Sums over all removed particles, by outflow and erosion. Collective.
    pub fn left(&self) -> Removed<D> {
        let RemovedByKind { outflow, erosion } = self.ways();
        outflow.and(&erosion)
    }

    /// Removed particles by kind of removal. Collective.
    pub fn ways(&self) -> RemovedByKind<D> {
        let mut sums = self.outflow.sums.clone();
        ExactSum::over_ranks(self.comm, &mut sums);
        let count = self.outflow.census.over_ranks(self.comm).particles;
        let book = |first: usize, count: u64| {
            let value = |k: usize| sums[first + k].value();
            Removed {
                count,
                mass: value(0),
                kinetic: value(1),
                internal: value(2),
                momentum: std::array::from_fn(|a| value(3 + a)),
            }
        };
        let second = left_sums(D);
        // the last sum is the number of eroded particles
        let eroded = (sums.len() > second).then(|| sums[2 * second].value() as u64);
        RemovedByKind {
            outflow: book(0, count - eroded.unwrap_or(0)),
            erosion: eroded.map_or(Removed::NONE, |eroded| book(second, eroded)),
        }
    }

    /// Census of all ranks, with the removed particles: ids and masses never change. Collective.
    pub(super) fn count(&self) -> Census {
        let mass = self.stepper.columns.mass;
        let mut census = self.outflow.census;
        for block in self.patches.iter().map(|p| &p.block) {
            for (id, m) in block.ids[..block.own()].iter().zip(&block.columns[mass]) {
                census.add(*id, *m);
            }
        }
        census.over_ranks(self.comm)
    }

    /// Returns an error if a particle was lost, duplicated or has changed its mass. Collective.
    pub(super) fn check_census(&self) -> Result<(), RunError> {
        let now = self.count();
        if now == self.census {
            return Ok(());
        }
        let (before, now) = (self.census.particles, now.particles);
        Err(RunError::Lost { time: self.time, step: self.step, before, now })
    }
}

#[cfg(test)]
mod tests {
    use decomp::Serial;

    use super::*;
    use crate::input;
    use crate::solver::patch::Patch;

    #[test]
    fn particles_lost_doubled_or_changed_end_the_run() {
        let text = include_bytes!("../../inputs/sod.json");
        let sets = ["domain.patches=[4]".to_string()];
        let scene = input::parse(text, "sod.json", &sets).unwrap();
        let faults: [fn(&mut Patch<1>); 3] = [
            |patch| {
                patch.block.drop_ghosts();
                patch.block.remove(&[3]);
            },
            |patch| {
                let particle: Vec<f64> = patch.block.columns.iter().map(|c| c[0]).collect();
                let (id, cell) = (patch.block.ids[0], patch.block.cells[0]);
                patch.block.drop_ghosts();
                patch.block.push(id, cell, &particle);
            },
            |patch| {
                let specs = patch.block.specs();
                let mass = specs.iter().position(|s| s.name == "mass").unwrap();
                patch.block.columns[mass][0] *= 1.0 + 1e-15;
            },
        ];
        for fault in faults {
            let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
            simulation.advance(scene.scene.time.end).unwrap();
            assert!(simulation.check_census().is_ok());
            fault(&mut simulation.patches[1]);
            let error = simulation.check_census().unwrap_err();
            assert!(matches!(error, RunError::Lost { step: 1, .. }), "{error}");
        }
    }
}
