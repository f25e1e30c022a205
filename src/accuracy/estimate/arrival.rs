//! Arrival times of a wave at given positions in a body, recorded after every step.
//!
//! A position lies between two particles. Their arrival times are interpolated to it, so that runs
//! with other cell sizes report the same position.

use serde::{Deserialize, Serialize};

use crate::geometry::Tile;
use crate::scene::CheckedScene;
use crate::simulation::Simulation;

/// A particle near a position, and the times at which its pressure passed the two levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Passing {
    /// Time of the previous check \[s\].
    last_time: f64,
    /// Pressure at the previous check \[Pa\].
    last_pressure: f64,
    /// Time at which the pressure passed the `toe` level \[s\].
    toe: Option<f64>,
    /// Time at which the pressure passed the `half` level \[s\].
    half: Option<f64>,
}

/// A position between two particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// Ids of the particles.
    pub ids: [u64; 2],
    /// Interpolation weights of the particles, with sum 1 \[-\].
    pub weights: [f64; 2],
}

impl Between {
    /// The two particles around the position `at` \[m\] in a body on a line.
    pub fn new(scene: &CheckedScene, body: usize, at: f64) -> Between {
        let first: u64 = scene.bodies[..body].iter().map(|b| b.particles).sum();
        let own = &scene.bodies[body];
        if let Some(tiling) = &own.tiling {
            return Between::of_tiles(&tiling.all(), first, at);
        }
        let length = (own.upper[0] - own.lower[0]) / own.particles as f64;
        // in particles, from the centre of the first one
        let along = (at - own.lower[0]) / length - 0.5;
        let before = along.floor().clamp(0.0, own.particles.saturating_sub(2) as f64);
        let after = (before + 1.0).min(own.particles as f64 - 1.0);
        let share = along - before;
        Between {
            ids: [first + before as u64, first + after as u64],
            weights: [1.0 - share, share],
        }
    }

    /// The same for given particle positions: the nearest particles below and above `at`.
    fn of_tiles(tiles: &[Tile], first: u64, at: f64) -> Between {
        let place = |k: usize| tiles[k].centre[0];
        let by_place = |a: &usize, b: &usize| place(*a).total_cmp(&place(*b));
        let all = || 0..tiles.len();
        let below = all().filter(|&k| place(k) <= at).max_by(by_place);
        let above = all().filter(|&k| place(k) > at).min_by(by_place);
        let [below, above] = [below.or(above), above.or(below)].map(Option::unwrap_or_default);
        let share = match place(above) - place(below) {
            apart if apart > 0.0 => (at - place(below)) / apart,
            _ => 0.0,
        };
        Between { ids: [first + below as u64, first + above as u64], weights: [1.0 - share, share] }
    }
}

/// Pressure levels that mark the arrival of a wave \[Pa\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// Start pressure plus a tenth of the rise to the largest pressure \[Pa\].
    pub toe: f64,
    /// Start pressure plus half of the rise to the largest pressure \[Pa\].
    pub half: f64,
}

impl Levels {
    /// The levels between the start pressure and the largest pressure \[Pa\].
    pub fn new(start: f64, peak: f64) -> Levels {
        let half = 0.5 * (start + peak);
        Levels { toe: start + 0.2 * (half - start), half }
    }
}

/// Positions to record and the arrivals so far.
#[derive(Clone, Debug, Default)]
pub struct Arrivals {
    places: Vec<Between>,
    /// Levels from the finest coarse run; `None`: no wave came to the position.
    levels: Vec<Option<Levels>>,
    wanted: Vec<u64>,
    passings: Vec<[Passing; 2]>,
}

impl Arrivals {
    /// Records arrivals at these positions with these levels.
    pub fn new(places: Vec<Between>, levels: Vec<Option<Levels>>) -> Arrivals {
        let mut wanted: Vec<u64> = places.iter().flat_map(|p| p.ids).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let passings = vec![[Passing::default(); 2]; places.len()];
        Arrivals { places, levels, wanted, passings }
    }

    /// Checks the pressures of the particles. Collective.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn look<const D: usize>(&mut self, simulation: &Simulation<'_, D>) {
        if self.places.is_empty() {
            return;
        }
        let followed = simulation.follow(&self.wanted);
        // only rank 0 gets the particles
        if followed.is_empty() {
            return;
        }
        let time = simulation.time();
        for ((place, level), passings) in
            self.places.iter().zip(&self.levels).zip(&mut self.passings)
        {
            let Some(level) = level else { continue };
            for (id, passing) in place.ids.iter().zip(passings) {
                let at = self.wanted.binary_search(id).expect("a place's particle is wanted");
                if let Some(followed) = &followed[at] {
                    passing.see(time, followed.pressure, *level);
                }
            }
        }
    }

    /// Arrival time at position `k`, and rise time from the `toe` to the `half` level \[s\]. `None`
    /// until the run has continued for three rise times, or if no wave passes from one particle to
    /// the other.
    pub fn time(&self, k: usize) -> Option<(f64, f64)> {
        let (place, passings) = (self.places.get(k)?, self.passings.get(k)?);
        let mean = |of: fn(&Passing) -> Option<f64>| {
            let both = [of(&passings[0])?, of(&passings[1])?];
            Some(place.weights[0] * both[0] + place.weights[1] * both[1])
        };
        let (toe, half) = (mean(|p| p.toe)?, mean(|p| p.half)?);
        let rise = half - toe;
        // beyond the last particle of a body, the time is extrapolated
        let is_passing = half >= 0.0 && rise > 0.0;
        (is_passing && passings[0].last_time >= half + 3.0 * rise).then_some((half, rise))
    }

    /// State for a checkpoint.
    pub fn state(&self) -> Vec<[Passing; 2]> {
        self.passings.clone()
    }

    /// Restores the state of a checkpoint.
    pub fn resume(&mut self, state: Vec<[Passing; 2]>) {
        if state.len() == self.passings.len() {
            self.passings = state;
        }
    }
}

impl Passing {
    fn see(&mut self, time: f64, pressure: f64, levels: Levels) {
        let (t0, p0) = (self.last_time, self.last_pressure);
        let cross = |level: f64| {
            (p0 < level && pressure >= level)
                .then(|| t0 + (time - t0) * (level - p0) / (pressure - p0))
        };
        self.toe = self.toe.or(cross(levels.toe));
        self.half = self.half.or(cross(levels.half));
        (self.last_time, self.last_pressure) = (time, pressure);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_passing_counts() {
        let mut passing = Passing::default();
        for (t, p) in [(1.0, 0.0), (2.0, 4.0), (3.0, 8.0), (4.0, 0.0), (5.0, 9.0)] {
            passing.see(t, p, Levels { toe: 1.2, half: 6.0 });
        }
        assert_eq!((passing.toe, passing.half), (Some(1.3), Some(2.5)));
    }
}
