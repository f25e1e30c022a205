//! Snapshot: the complete state of a run, from which another run continues bit for bit, whatever
//! its ranks, threads and patches.
//!
//! Particles carry every column that is declared as state; other memory of a step is recomputed in
//! each step, as it is for a patch that has moved to another rank. The sums over removed particles
//! and over the work of sides are exact, so that one rank can continue with the sums of all ranks.

use decomp::{Census, ExactSum, StoredParticles, deal_particles, words_of};

use super::accounts::Counters;
use super::accounts::left_sums;
use super::error::RunError;
use super::run::Simulation;
use crate::scene::CheckedScene;
use crate::simulation::monitor::Peaks;
use crate::solver::clock::Clock;
use crate::solver::patch::Patch;

/// State from which a run continues.
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
    /// All particles.
    pub particles: StoredParticles,
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
    /// The state for the next step, at rank 0; `None` on other ranks. Collective.
    pub fn save(&self) -> Option<Saved> {
        let books = self.outflow.sums.iter().chain(&self.side_books.sums);
        let mut sums: Vec<ExactSum> = books.cloned().collect();
        ExactSum::over_ranks(self.comm, &mut sums);
        let left = self.outflow.census.over_ranks(self.comm);
        let blocks = self.patches.iter().map(|p| &p.block);
        let particles = StoredParticles::gather(self.comm, &self.stepper.columns.specs, blocks);
        (self.comm.rank() == 0).then(|| Saved {
            time: self.time,
            step: self.step,
            stable: self.stable,
            longest: self.longest,
            redone_steps: self.tally.redone_steps,
            left,
            sums: sums.iter().map(ExactSum::total).collect(),
            peaks: self.peaks,
            particles,
        })
    }

    /// Continues from the state that rank 0 passes; other ranks pass `None`. This run must be of
    /// the same scene and at its start. Collective.
    ///
    /// # Errors
    ///
    /// If the particles are not those of the scene.
    ///
    /// # Panics
    /// If the number of columns or sums differs, or a cell is outside the domain.
    pub fn restore(&mut self, saved: Option<&Saved>) -> Result<(), RunError> {
        let head = saved.map_or(Vec::new(), |s| {
            let floats = [s.time, s.stable, s.longest].map(f64::to_bits);
            let peaks = s.peaks.values().map(f64::to_bits);
            [&floats[..], &[s.step, s.redone_steps], &peaks]
                .concat()
                .iter()
                .flat_map(|w| w.to_le_bytes())
                .collect()
        });
        let head = self.comm.broadcast(head);
        let words = &words_of(&head)[1..];
        let float = |k: usize| f64::from_bits(words[k]);
        (self.time, self.stable, self.longest, self.step) =
            (float(0), float(1), float(2), words[3]);
        self.peaks = Peaks::of(std::array::from_fn(|k| float(5 + k)));
        self.dt = self.scene.scene.time.courant * self.stable;
        self.first_step = self.step;
        let books = self.outflow.sums.iter_mut().chain(&mut self.side_books.sums);
        match saved {
            None => {}
            Some(saved) => {
                self.outflow.census = saved.left;
                let mut totals = saved.sums.iter();
                books.for_each(|sum| sum.carry_on(*totals.next().expect("as many sums")));
            }
        }
        let specs = &self.stepper.columns.specs;
        let particles = saved.map(|s| &s.particles);
        let (layout, blocks) =
            deal_particles(self.comm, self.layout.clone(), &self.order, specs, particles);
        let mine = layout.patches_of(self.comm.rank()).into_iter().zip(blocks);
        self.patches = mine.map(|(p, block)| Patch::new(&layout, p, block)).collect();
        self.layout = layout;
        self.reach = None;
        self.follow_reach(self.longest);
        self.plan.particles.take_migrated();
        self.tally = Counters { redone_steps: words[4], ..Counters::default() };
        self.clock = Clock::new();
        self.keep_good_state();
        match self.count() == self.census {
            true => Ok(()),
            false => Err(RunError::Foreign),
        }
    }
}
