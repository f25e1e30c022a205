//! Numbers of cells of planned runs and of their pilot runs.
//!
//! A body has a whole number of particles. With one particle per cell they can be slightly wider than
//! a cell. They then have weights on one node more, and a step takes up to a quarter longer. The times
//! of pilot runs with narrow and with wide particles do not extrapolate to those of the run.

use crate::scene::CheckedScene;

/// Greatest number of cells of a run over the smallest number that reaches the error \[-\].
const MORE_IN_RUN: f64 = 1.1;
/// Greatest number of cells of a pilot run over the smallest number that gives a reliable time \[-\].
const MORE_IN_PILOT: f64 = 1.5;
/// Relative width by which a particle must exceed a cell to count as wider: a particle that fits
/// exactly does so only up to rounding.
const ROUNDING: f64 = 1e-12;

/// Lengths of a scene on a line \[m\].
pub struct Lengths {
    /// Length of the domain.
    pub domain: f64,
    /// Length of each body.
    bodies: Vec<f64>,
}

impl Lengths {
    /// Lengths of a scene.
    pub fn new(scene: &CheckedScene) -> Lengths {
        Lengths {
            domain: scene.scene.domain.upper[0] - scene.scene.domain.lower[0],
            bodies: scene.bodies.iter().map(|body| body.upper[0] - body.lower[0]).collect(),
        }
    }

    /// Total length of the bodies \[m\].
    pub fn filled(&self) -> f64 {
        self.bodies.iter().sum()
    }

    /// Number of cells of a run: the smallest from `cells` on with which no particle is wider than a
    /// cell, or `cells` if there is none up to 1.1 times `cells` and up to `most`.
    pub fn of_run(&self, cells: usize, per_cell: usize, most: usize) -> usize {
        let last = (MORE_IN_RUN * cells as f64) as usize;
        let is_narrow = |&n: &usize| !self.wide(n, per_cell).any(|wide| wide);
        (cells..=last.min(most)).find(is_narrow).unwrap_or(cells)
    }

    /// Number of cells of a pilot run of a run with `run` cells: the smallest from `cells` on with
    /// which the particles of the same bodies are wider than a cell, or `cells` if there is none up
    /// to 1.5 times `cells`.
    pub fn of_pilot(&self, cells: usize, per_cell: usize, run: usize) -> usize {
        let last = (MORE_IN_PILOT * cells as f64) as usize;
        let is_alike = |&n: &usize| self.wide(n, per_cell).eq(self.wide(run, per_cell));
        (cells..=last).find(is_alike).unwrap_or(cells)
    }

    /// Whether the particles of each body are wider than one of `cells` cells.
    fn wide(&self, cells: usize, per_cell: usize) -> impl Iterator<Item = bool> {
        let size = self.domain / cells as f64;
        self.bodies.iter().map(move |length| {
            let particles = (length / size * per_cell as f64).round();
            length / particles > size * (1.0 + ROUNDING)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies of 1/4 and 1/2 of the domain.
    fn lengths() -> Lengths {
        Lengths { domain: 1.0, bodies: vec![0.25, 0.5] }
    }

    #[test]
    fn runs_avoid_particles_wider_than_a_cell() {
        assert_eq!(lengths().of_run(40, 1, 100), 40);
        // the first body is 10.25 cells long and has 10 particles; with 42 cells it has 11 on 10.5
        assert_eq!(lengths().of_run(41, 1, 100), 42);
        assert_eq!(lengths().of_run(41, 1, 41), 41, "not more than `most`");
        assert_eq!(lengths().of_run(5, 1, 100), 5, "no number up to 1.1 times");
        assert_eq!(lengths().of_run(41, 2, 100), 41, "two per cell are narrow");
        // cells of exactly 1e-5, up to rounding
        let flyer = Lengths { domain: 0.009 - -0.001, bodies: vec![0.0005, 0.008] };
        assert_eq!(flyer.of_run(1000, 1, 2000), 1000);
    }

    #[test]
    fn particles_of_pilots_are_as_wide_as_those_of_the_run() {
        let lengths = lengths();
        for run in [161, 162, 163, 164] {
            let pilot = lengths.of_pilot(41, 1, run);
            assert!((41..=61).contains(&pilot));
            assert!(lengths.wide(pilot, 1).eq(lengths.wide(run, 1)), "{run}: {pilot}");
        }
    }
}
