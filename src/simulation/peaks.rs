//! Peak values of a rank's particles relative to the values that the scene explains; see [`Peaks`].

use decomp::Block;

use super::expected_peaks::FRONT_TIMES;
use super::run::Simulation;
use crate::simulation::monitor::Peaks;

impl<const D: usize> Simulation<'_, D> {
    /// Updates the peak values from all particles. Collective.
    pub(super) fn note_peaks(&mut self) {
        let mut peaks = Peaks::default();
        for block in self.patches.iter().map(|p| &p.block) {
            for r in 0..block.own() {
                peaks = peaks.max(&self.peaks_of(block, r));
            }
        }
        let mut values = peaks.values().map(|value| -value);
        self.comm.min(&mut values);
        self.peaks = self.peaks.max(&Peaks::of(values.map(|value| -value)));
    }

    fn peaks_of(&self, block: &Block<D>, r: usize) -> Peaks {
        let c = &self.stepper.columns;
        let column = |k: usize| block.columns[k][r];
        let expected = &self.expected[column(c.body) as usize];
        let energy = column(c.energy) - expected.energy;
        let plastic = |strain| self.stepper.plastic_heat(block, r, strain);
        let released = |energy| column(energy) / column(c.mass);
        let unexplained = energy
            - self.stepper.elastic_energy(block, r, expected.isentrope.as_deref())
            - c.friction_heat.map_or(0.0, column)
            - c.plastic_strain.map_or(0.0, plastic)
            - c.released_energy.map_or(0.0, released);
        let mut peaks = Peaks {
            heat: unexplained / expected.heat,
            energy: if expected.heat.is_finite() { energy } else { 0.0 },
            ..Peaks::default()
        };
        let velocity = || -> [f64; D] {
            let grid = self.frame.velocity(self.time);
            std::array::from_fn(|a| column(c.velocity + a) + grid[a] - expected.velocity[a])
        };
        if let Some(ahead) = &expected.ahead {
            let travel = self.frame.travel(self.time);
            let drift = |a: usize| travel[a] - expected.velocity[a] * self.time;
            let start = std::array::from_fn(|a| column(c.position + a) + drift(a));
            if let Some(against) = ahead.arrival.against(&start, &velocity(), self.time) {
                peaks.tension = -column(c.pressure) / ahead.pressure;
                peaks.against = against / ahead.velocity;
            }
        }
        if let (Some(front), Some([fraction, lighting_time])) = (expected.front, c.burn) {
            let since = self.time - column(lighting_time);
            if column(fraction) == 0.0 {
                let speed = velocity().iter().map(|v| v * v).sum::<f64>().sqrt();
                peaks.ahead = speed / front.velocity;
            } else if (0.0..FRONT_TIMES * front.duration).contains(&since) {
                peaks.front = column(c.pressure) / front.pressure;
            }
        }
        if let Some(temperature) = c.temperature {
            peaks.frozen = -column(temperature);
        }
        peaks
    }

    /// Peak values so far; the same on all ranks.
    pub fn peaks(&self) -> &Peaks {
        &self.peaks
    }
}
