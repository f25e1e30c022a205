//! Gauges fixed in space: means around a point, and sums beyond a plane.

use decomp::exact_sums;

use super::run::Simulation;

/// Means over the particles around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around<const D: usize> {
    /// Velocity [m/s].
    pub velocity: [f64; D],
    /// Pressure [Pa].
    pub pressure: f64,
    /// Density [kg/m3].
    pub density: f64,
}

/// Words of a particle near a point: id, weight, velocity, pressure, density.
const fn words_of_one(dimension: usize) -> usize {
    4 + dimension
}

impl<const D: usize> Simulation<'_, D> {
    /// Means over the particles within one cell of `at` [m], weighted by mass and by
    /// 1 - |distance| / cell in each direction, at rank 0; `None` without particles there, and on other
    /// ranks. The same for any layout. Collective.
    pub fn around(&self, at: &[f64]) -> Option<Around<D>> {
        let c = &self.stepper.columns;
        let (grid, travel) = (self.frame.velocity(self.time), self.frame.travel(self.time));
        let cell = &self.scene.cell_size;
        let mut words = Vec::new();
        for block in self.patches.iter().map(|p| &p.block) {
            let column = |k: usize, r: usize| block.columns[k][r];
            for r in 0..block.own() {
                let near = |a: usize| {
                    1.0 - (column(c.position + a, r) + travel[a] - at[a]).abs() / cell[a]
                };
                let near: f64 = (0..D).map(|a| near(a).max(0.0)).product();
                if near > 0.0 {
                    words.extend([block.ids[r], (near * column(c.mass, r)).to_bits()]);
                    words.extend((0..D).map(|a| (column(c.velocity + a, r) + grid[a]).to_bits()));
                    let density =
                        column(c.mass, r) / (column(c.volume0, r) * column(c.jacobian, r));
                    words.extend([column(c.pressure, r), density].map(f64::to_bits));
                }
            }
        }
        let all = self.comm.gather(&words);
        let mut particles: Vec<&[u64]> =
            all.iter().flat_map(|words| words.chunks_exact(words_of_one(D))).collect();
        // sums in an order that no layout changes
        particles.sort_unstable_by_key(|words| words[0]);
        let sum = |value: &dyn Fn(&[u64]) -> f64| -> f64 {
            particles.iter().map(|words| f64::from_bits(words[1]) * value(words)).sum()
        };
        let weight = sum(&|_| 1.0);
        let mean = |k: usize| sum(&|words| f64::from_bits(words[k])) / weight;
        (weight > 0.0).then(|| Around {
            velocity: std::array::from_fn(|a| mean(2 + a)),
            pressure: mean(2 + D),
            density: mean(3 + D),
        })
    }

    /// Mass [kg] and momentum along `axis` [kg m/s] of the particles whose centre is beyond `at` [m]
    /// along the axis. Collective.
    pub fn beyond(&self, axis: usize, at: f64) -> [f64; 2] {
        let c = &self.stepper.columns;
        let (grid, travel) = (self.frame.velocity(self.time), self.frame.travel(self.time));
        exact_sums(self.comm, |add: &mut dyn FnMut(usize, &[f64])| {
            for block in self.patches.iter().map(|p| &p.block) {
                for r in 0..block.own() {
                    if block.columns[c.position + axis][r] + travel[axis] > at {
                        let mass = block.columns[c.mass][r];
                        let velocity = block.columns[c.velocity + axis][r] + grid[axis];
                        add(0, &[mass]);
                        add(1, &[mass * velocity]);
                    }
                }
            }
        })
    }

    /// Sound speed of the material of a body at rest and at zero pressure [m/s]; of a fluid, and of a
    /// fluid with strength, the bulk sound speed.
    pub fn sound_speed_at_rest(&self, body: usize) -> f64 {
        self.stepper.models[body].sound_speed_at(0.0)
    }
}
