//! All that the next step needs, taken out of a run and put into another: whatever its ranks,
//! threads and patches, it goes on to the same bits.
//!
//! Rows carry every column that is declared as state; the rest of a step's memory is computed anew
//! in each step, as it is for a patch that has moved to another rank. Sums over what has left and
//! what sides have given are exact, so that one rank may go on with those of all.

use decomp::{Census, ExactSum, StoredRows, deal_rows, words_of};

use super::conservation::left_sums;
use super::{RunError, Simulation, Tally};
use crate::scene::CheckedScene;
use crate::simulation::monitor::Peaks;
use crate::solver::clock::Clock;
use crate::solver::patch::Patch;

/// What a run needs to go on.
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
    /// Times that a step was redone half as long.
    pub redone_steps: u64,
    /// Particles that have left: their number and marks.
    pub left: Census,
    /// Totals of the sums over what has left and what the sides have given.
    pub sums: Vec<i128>,
    /// Greatest values so far.
    pub peaks: Peaks,
    /// All particles.
    pub rows: StoredRows,
}

/// Number of [`Saved::sums`] of a run of `scene`.
pub fn saved_sums(scene: &CheckedScene) -> usize {
    let dimension = scene.dimension;
    // those of what was eroded, and its number
    let eroded = if scene.erodes() { left_sums(dimension) + 1 } else { 0 };
    // of what has left; work and impulse of the sides
    left_sums(dimension) + eroded + 1 + dimension
}

impl<const D: usize> Simulation<'_, D> {
    /// What the next step needs, at rank 0; nothing elsewhere. Collective.
    pub fn save(&self) -> Option<Saved> {
        let books = self.outflow.sums.iter().chain(&self.side_books.sums);
        let mut sums: Vec<ExactSum> = books.cloned().collect();
        ExactSum::over_ranks(self.comm, &mut sums);
        let left = self.outflow.census.over_ranks(self.comm);
        let blocks = self.patches.iter().map(|p| &p.block);
        let rows = StoredRows::gather(self.comm, &self.stepper.columns.specs, blocks);
        (self.comm.rank() == 0).then(|| Saved {
            time: self.time,
            step: self.step,
            stable: self.stable,
            longest: self.longest,
            redone_steps: self.tally.redone_steps,
            left,
            sums: sums.iter().map(ExactSum::total).collect(),
            peaks: self.peaks,
            rows,
        })
    }

    /// Goes on from what rank 0 gives, and the others do not: this run must be one of the same
    /// scene at its start. Collective.
    ///
    /// # Panics
    /// If the number of columns or sums is another, or a cell is not within the domain.
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
        let rows = saved.map(|s| &s.rows);
        let (layout, blocks) = deal_rows(self.comm, self.layout.clone(), &self.order, specs, rows);
        let mine = layout.patches_of(self.comm.rank()).into_iter().zip(blocks);
        self.patches = mine.map(|(p, block)| Patch::new(&layout, p, block)).collect();
        self.layout = layout;
        self.reach = None;
        self.follow_reach(self.longest);
        self.plan.rows.take_migrated();
        self.tally = Tally { redone_steps: words[4], ..Tally::default() };
        self.clock = Clock::new();
        self.hold();
        match self.count() == self.census {
            true => Ok(()),
            false => Err(RunError::Foreign),
        }
    }
}
