//! Snapshot: the complete state of a run, from which another run continues bit for bit, whatever
//! its ranks, threads and patches.
//!
//! Particles carry every column that is declared as state; other memory of a step is recomputed in
//! each step, as it is for a patch that has moved to another rank. The sums over removed particles
//! and over the work of sides are exact, so that one rank can continue with the sums of all ranks.

use decomp::{Census, ExactSum, StoredParticles, distribute_particles};

use super::accounts::Counters;
use super::accounts::left_sums;
use super::error::RunError;
use super::run::Simulation;
use super::state_digest::StateDigest;
use crate::scene::CheckedScene;
use crate::simulation::monitor::{Peaks, SelfContactEvent};
use crate::solver::clock::Clock;
use crate::solver::patch::Patch;

/// State from which a run continues: of the particles a share of all, everything else is the same on
/// all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Saved {
    /// Time [s].
    pub time: f64,
    /// Steps made.
    pub step: u64,
    /// Longest stable next step at a Courant number of 1 [s].
    pub stable: f64,
    /// Greatest extent of a particle along a direction [cells].
    pub longest: f64,
    /// Steps repeated with half the length.
    pub redone_steps: u64,
    /// Census of removed particles: their number and checksums.
    pub left: Census,
    /// Totals of the sums over removed particles and over the work and impulse of sides.
    pub sums: Vec<i128>,
    /// Greatest values so far.
    pub peaks: Peaks,
    /// First contact of a body with itself.
    pub self_contact: Option<SelfContactEvent>,
    /// [Digest](Simulation::digest) of the particles of all ranks; empty if they were changed on
    /// purpose.
    pub digest: String,
    /// This rank's share of the particles.
    pub particles: StoredParticles,
}

impl Saved {
    /// The same without particles, for a rank whose share is empty.
    pub fn without_particles(&self) -> Saved {
        let (digest, sums) = (self.digest.clone(), self.sums.clone());
        Saved { digest, sums, particles: StoredParticles::default(), ..*self }
    }

    /// The state of the shares of all ranks, as one share; `None` without shares.
    pub fn joined(shares: Vec<Saved>) -> Option<Saved> {
        let head = shares.first()?.without_particles();
        let particles = StoredParticles::joined(shares.into_iter().map(|share| share.particles));
        Some(Saved { particles, ..head })
    }
}

/// Number of [`Saved::sums`] of a run of `scene`.
pub fn saved_sums(scene: &CheckedScene) -> usize {
    let dimension = scene.dimension;
    // the sums over eroded particles, and their number
    let eroded = if scene.erodes() { left_sums(dimension) + 1 } else { 0 };
    // the sums over removed particles; work and impulse of the sides
    left_sums(dimension) + eroded + 1 + dimension
}

impl<const D: usize> Simulation<'_, D> {
    /// The state for the next step, with the particles of this rank. Collective.
    pub fn save(&self) -> Saved {
        let blocks = self.patches.iter().map(|p| &p.block);
        let particles = StoredParticles::of(&self.stepper.columns.specs, blocks);
        let sums = self.outflow.sums.iter().chain(&self.side_books.sums).cloned().collect();
        let moment = Moment { time: self.time, step: self.step, stable: self.stable };
        self.saved(moment, self.longest, self.outflow.census, sums, particles)
    }

    /// The state at a moment from the parts that this rank holds. Collective.
    pub(super) fn saved(
        &self,
        Moment { time, step, stable }: Moment,
        longest: f64,
        left: Census,
        mut sums: Vec<ExactSum>,
        particles: StoredParticles,
    ) -> Saved {
        ExactSum::over_ranks(self.comm, &mut sums);
        let mut digest = StateDigest::default();
        let columns = particles.columns.iter().map(|c| &c[..]).collect();
        digest.add(&particles.ids, &self.by_name(columns));
        Saved {
            time,
            step,
            stable,
            longest,
            redone_steps: self.tally.redone_steps,
            left: left.over_ranks(self.comm),
            sums: sums.iter().map(ExactSum::total).collect(),
            peaks: self.peaks,
            self_contact: self.self_contact,
            digest: digest.over_ranks(self.comm).to_hexadecimal(),
            particles,
        }
    }

    /// Continues from a state, of which each rank gives any share of the particles. This run must be
    /// of the same scene and at its start. Collective.
    ///
    /// # Errors
    ///
    /// If the particles are not those of the scene, or not those that were saved.
    ///
    /// # Panics
    /// If the number of columns or sums differs, or a cell is outside the domain.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), RunError> {
        (self.time, self.stable, self.longest, self.step) =
            (saved.time, saved.stable, saved.longest, saved.step);
        (self.peaks, self.self_contact) = (saved.peaks, saved.self_contact);
        self.dt = self.scene.scene.time.courant * self.stable;
        self.first_step = self.step;
        if self.comm.rank() == 0 {
            // one rank continues with the sums of all
            let books = self.outflow.sums.iter_mut().chain(&mut self.side_books.sums);
            books.zip(&saved.sums).for_each(|(sum, total)| sum.carry_on(*total));
            self.outflow.census = saved.left;
        }
        let specs = &self.stepper.columns.specs;
        let (layout, blocks) =
            distribute_particles(self.comm, self.layout.clone(), specs, &saved.particles);
        let mine = layout.patches_of(self.comm.rank()).into_iter().zip(blocks);
        self.patches = mine.map(|(p, block)| Patch::new(&layout, p, block)).collect();
        self.layout = layout;
        self.reach = None;
        self.follow_reach(self.longest);
        self.plan.particles.take_migrated();
        self.tally = Counters { redone_steps: saved.redone_steps, ..Counters::default() };
        self.clock = Clock::new();
        self.keep_good_state();
        let same = saved.digest.is_empty() || self.digest() == saved.digest;
        match self.count() == self.census && same {
            true => Ok(()),
            false => Err(RunError::Foreign),
        }
    }
}

/// A moment of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Time [s].
    pub time: f64,
    /// Number of steps.
    pub step: u64,
    /// Longest stable next step at a Courant number of 1 [s].
    pub stable: f64,
}
