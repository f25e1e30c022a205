//! Profiles of many particles as means over blocks of cells, so that rank 0 holds a bounded table.

use decomp::{ExactSum, Shares};

use super::diagnostics::RowOrder;
use super::run::Simulation;
use crate::simulation::{ParticleTable, TableColumn};

/// Columns whose mean is weighted by mass; the others are weighted by volume.
const BY_MASS: [&str; 7] =
    ["x", "y", "velocity", "specific_internal_energy", "reference", "spin", "spin_inertia"];

/// Number of cells along an edge of a block, for at most about `most` blocks with particles.
fn block_edge(particles: u64, most: u64, dimension: usize) -> i64 {
    let share = (particles as f64 / most.max(1) as f64).powf(1.0 / dimension as f64);
    (share.ceil() as i64).max(1)
}

/// The name without the component.
fn base(name: &str) -> &str {
    ["_xx", "_yy", "_xy", "_zz", "_x", "_y"]
        .iter()
        .find_map(|end| name.strip_suffix(end))
        .unwrap_or(name)
}

/// What the mean of a column is weighted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Weight {
    Mass,
    Volume,
    /// No mean but a sum.
    None,
}

impl Weight {
    fn of(column: &str) -> Weight {
        match base(column) {
            "mass" | "volume" => Weight::None,
            name if BY_MASS.contains(&name) => Weight::Mass,
            _ => Weight::Volume,
        }
    }
}

/// Sum that stands for one with a term that is not finite.
const NOT_FINITE: i128 = i128::MIN;

/// Terms of the sums over blocks: the columns of the particles times their weights, and the volumes.
fn weighted(table: &mut ParticleTable) -> Vec<Vec<f64>> {
    let column = |name: &str| table.column(name).expect("mass and density are always there");
    let (mass, density) = (column("mass").to_vec(), column("density"));
    let volume: Vec<f64> = mass.iter().zip(density).map(|(m, rho)| m / rho).collect();
    let mut terms = Vec::new();
    for column in &mut table.columns {
        let mut values = std::mem::take(&mut column.values);
        let weights = match Weight::of(&column.name) {
            Weight::Mass => &mass[..],
            Weight::Volume => &volume[..],
            Weight::None => &[],
        };
        values.iter_mut().zip(weights).for_each(|(value, weight)| *value *= weight);
        terms.push(values);
    }
    terms.push(volume);
    terms
}

/// The greatest magnitude of the finite terms.
fn greatest(terms: &[f64]) -> f64 {
    terms.iter().filter(|t| t.is_finite()).fold(0.0, |most: f64, term| most.max(term.abs()))
}

/// Sum of the terms of some particles, in multiples of the quantum of sums up to `largest`.
fn sum(terms: &[f64], largest: f64) -> i128 {
    let mut sum = ExactSum::new(largest);
    sum.add_all(terms);
    if terms.iter().all(|term| term.is_finite()) { sum.total() } else { NOT_FINITE }
}

/// Values of the `columns` of each block, from the partial sums of several ranks: `parts` are the key
/// of a block and its sums, `largest` the greatest term of each. Returns the keys too, ascending.
fn means(
    columns: &[TableColumn],
    mut parts: Vec<(u64, &[u64])>,
    largest: &[f64],
) -> (Vec<u64>, Vec<Vec<f64>>) {
    parts.sort_by_key(|(key, _)| *key);
    let mass = columns.iter().position(|c| c.name == "mass").expect("it is always there");
    let mut keys = Vec::new();
    let mut values = vec![Vec::new(); columns.len()];
    for of_block in parts.chunk_by(|a, b| a.0 == b.0) {
        let total = |k: usize| {
            let mut total = ExactSum::new(largest[k]);
            for (_, words) in of_block {
                let part = i128::from(words[2 * k]) | (i128::from(words[2 * k + 1]) << 64);
                if part == NOT_FINITE {
                    return f64::NAN;
                }
                total.carry_on(total.total() + part);
            }
            total.value()
        };
        keys.push(of_block[0].0);
        let (mass, volume) = (total(mass), total(columns.len()));
        for (k, column) in columns.iter().enumerate() {
            values[k].push(match Weight::of(&column.name) {
                Weight::Mass => total(k) / mass,
                Weight::Volume => total(k) / volume,
                Weight::None => total(k),
            });
        }
    }
    (keys, values)
}

impl<const D: usize> Simulation<'_, D> {
    /// As [`Simulation::gather`] for at most `most` particles. Of more particles the table holds means
    /// over those of each body in blocks of cells, as many cells along each edge as needed for about
    /// `most` blocks: densities as mass over volume, velocities and energies weighted by mass, other
    /// values by volume. The digest is always that of all particles. Collective.
    pub fn profile(&self, most: u64) -> Option<(ParticleTable, String)> {
        if self.scene.particles <= most {
            return self.gather();
        }
        let (digest, bins) = (self.digest(), self.bins(most));
        (self.comm.rank() == 0).then_some((bins, digest))
    }

    /// Cells along an edge of the blocks of [`Simulation::profile`]; `None` if it has all particles.
    pub fn profile_block(&self, most: u64) -> Option<u64> {
        let particles = self.scene.particles;
        (particles > most).then(|| block_edge(particles, most, D) as u64)
    }

    /// The table of means over blocks; empty except at rank 0, which receives sums over the blocks of
    /// each rank. The sums are exact, so that it does not matter which rank has which particles of a
    /// block. Collective.
    fn bins(&self, most: u64) -> ParticleTable {
        let edge = block_edge(self.scene.particles, most, D);
        let bodies = self.scene.bodies.len() as u64;
        let blocks: [u64; D] =
            std::array::from_fn(|a| (self.scene.cells[a] as u64).div_ceil(edge as u64));
        let body = self.stepper.columns.body;
        let own = self.patches.iter().map(|p| &p.block);
        let shares = Shares::of_own(self.comm, own, |block, r| {
            let at = |a: usize| (i64::from(block.cells[r][a]) / edge) as u64;
            let place = (0..D).rev().fold(0, |place, a| place * blocks[a] + at(a));
            Some(place * bodies + block.columns[body][r] as u64)
        });
        // all columns of a profile, and the masses
        let unwanted = ["strain", "failed", super::HALF_EDGES];
        let mut table =
            self.table(&shares, RowOrder::Share, &|name| !unwanted.contains(&base(name)));
        let terms = weighted(&mut table);
        let mut largest: Vec<f64> = terms.iter().map(|terms| -greatest(terms)).collect();
        self.comm.min(&mut largest);
        largest.iter_mut().for_each(|l| *l = -*l);
        let mut words = Vec::new();
        let mut first = 0;
        for of_block in shares.keys.chunk_by(|a, b| a == b) {
            let rows = first..first + of_block.len();
            words.push(of_block[0]);
            for (terms, &largest) in terms.iter().zip(&largest) {
                let sum = sum(&terms[rows.clone()], largest);
                words.extend([sum as u64, (sum >> 64) as u64]);
            }
            first = rows.end;
        }
        drop(terms);
        let all = self.comm.gather(&words);
        let parts = all.iter().flat_map(|words| words.chunks_exact(1 + 2 * largest.len()));
        let parts = parts.map(|words| (words[0], &words[1..])).collect();
        let (keys, values) = means(&table.columns, parts, &largest);
        self.bin_table(table, (keys, values), edge)
    }

    /// The table of the blocks with these keys and values, by x.
    fn bin_table(
        &self,
        table: ParticleTable,
        (keys, values): (Vec<u64>, Vec<Vec<f64>>),
        edge: i64,
    ) -> ParticleTable {
        let (x, bodies) = (&values[0], self.scene.bodies.len() as u64);
        let mut order: Vec<usize> = (0..keys.len()).collect();
        order.sort_unstable_by(|&a, &b| x[a].total_cmp(&x[b]).then(keys[a].cmp(&keys[b])));
        let columns = table.columns.into_iter().zip(&values).filter(|(c, _)| c.name != "mass");
        let columns = columns.map(|(column, values)| TableColumn {
            values: order.iter().map(|&r| values[r]).collect(),
            ..column
        });
        let columns = columns.collect();
        let body: Vec<u32> = order.iter().map(|&r| (keys[r] % bodies) as u32).collect();
        let half = |a: usize| 0.5 * edge as f64 * self.scene.cell_size[a];
        let square = if D == 1 { None } else { Some([[half(0), 0.0], [0.0, half(1)]]) };
        ParticleTable {
            ids: order.iter().map(|&r| keys[r]).collect(),
            material: body.iter().map(|&b| self.scene.bodies[b as usize].material as u32).collect(),
            half_edges: square.map_or(Vec::new(), |square| vec![square; body.len()]),
            body,
            columns,
            ..table
        }
    }
}

#[cfg(test)]
mod tests {
    use decomp::comm::local::run_ranks;
    use decomp::{Comm, Serial};

    use super::*;
    use crate::input;

    #[test]
    fn a_block_holds_the_means_of_its_particles_on_any_ranks() {
        let text = include_bytes!("../../inputs/sod.json");
        let of = |patches: &str| input::parse(text, "sod.json", &[patches.to_string()]).unwrap();
        let (one, many) = (of("domain.patches=[1]"), of("domain.patches=[7]"));
        let whole = Simulation::<1>::new(&one, &Serial, 1).unwrap();
        let most = one.particles / 5;
        let (all, digest) = whole.gather().unwrap();
        let (bins, same) = whole.profile(most).unwrap();
        assert_eq!(digest, same);
        assert!(bins.len() as u64 <= most + 2 && bins.len() > 10, "{}", bins.len());
        assert_eq!(whole.profile(one.particles).unwrap().0, all);
        assert_eq!(bins.columns.len(), all.columns.len());
        // two gases at rest: the means are the values
        let (first, last) =
            (bins.column("pressure").unwrap()[0], all.column("pressure").unwrap()[0]);
        assert!((first / last - 1.0).abs() < 1e-12);
        for ranks in [1, 3] {
            let tables = run_ranks(ranks, |comm| {
                Simulation::<1>::new(&many, comm, 1).unwrap().profile(most)
            });
            assert_eq!(tables[0].as_ref().unwrap().0, bins);
            assert!(tables[1..].iter().all(Option::is_none));
        }
    }

    /// Values of one block whose two particles lie on two ranks.
    fn of_two(columns: [(&str, [f64; 2]); 5]) -> Vec<f64> {
        let column = |(name, values): (&str, [f64; 2])| TableColumn {
            name: name.into(),
            unit: String::new(),
            values: values.into(),
        };
        let mut table = ParticleTable {
            time: 0.0,
            dimension: 1,
            ids: vec![0, 1],
            material: vec![0; 2],
            materials: Vec::new(),
            body: vec![0; 2],
            columns: columns.map(column).into(),
            half_edges: Vec::new(),
        };
        let terms = weighted(&mut table);
        let largest: Vec<f64> = terms.iter().map(|terms| greatest(terms)).collect();
        let part = |r: usize| -> Vec<u64> {
            let sums = terms.iter().zip(&largest).map(|(terms, &most)| sum(&terms[r..=r], most));
            sums.flat_map(|sum| [sum as u64, (sum >> 64) as u64]).collect()
        };
        let parts = [part(0), part(1)];
        let parts = parts.iter().map(|words| (7, &words[..])).collect();
        let (keys, values) = means(&table.columns, parts, &largest);
        assert_eq!(keys, [7]);
        values.into_iter().flatten().collect()
    }

    #[test]
    fn means_are_weighted_by_mass_or_volume() {
        // equal volumes, masses of 1 and 3
        let columns = |pressure: [f64; 2]| {
            [
                ("x", [0.0, -4.0]),
                ("velocity", [1.0, 5.0]),
                ("pressure", pressure),
                ("density", [1.0, 3.0]),
                ("mass", [1.0, 3.0]),
            ]
        };
        assert_eq!(of_two(columns([1.0, -4.0])), [-3.0, 4.0, -1.5, 2.0, 4.0]);
        for unknown in [f64::NAN, f64::INFINITY] {
            let values = of_two(columns([unknown, 4.0]));
            assert!(values[2].is_nan() && values[..2] == [-3.0, 4.0], "{values:?}");
        }
    }

    /// Twice as many particles in the same blocks, which three ranks share.
    #[test]
    fn what_rank_0_receives_grows_with_the_blocks_alone() {
        let text = include_bytes!("../../inputs/sod.json");
        let received = |per_cell: u64| {
            let sets = [
                "domain.patches=[7]".to_string(),
                format!("bodies.0.particles_per_cell=[{per_cell}]"),
                format!("bodies.1.particles_per_cell=[{per_cell}]"),
            ];
            let scene = input::parse(text, "sod.json", &sets).unwrap();
            let most = scene.particles / 20;
            let ends = run_ranks(3, |comm| {
                let simulation = Simulation::<1>::new(&scene, comm, 1).unwrap();
                let before = comm.traffic().bytes_received;
                let blocks = simulation.bins(most).len();
                (blocks, comm.traffic().bytes_received - before)
            });
            ends[0]
        };
        let (few, many) = (received(2), received(4));
        assert_eq!(few.0, many.0, "as many blocks");
        assert!(few.1 > 0 && few.1 == many.1, "{few:?} {many:?}");
    }
}
