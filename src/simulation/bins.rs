//! Profiles of many particles as means over blocks of cells, so that rank 0 holds a bounded table.

use std::ops::Range;

use decomp::Shares;

use super::diagnostics::RowOrder;
use super::run::Simulation;
use crate::simulation::{ParticleTable, TableColumn};

/// Columns whose mean is weighted by mass; the others are weighted by volume.
const BY_MASS: [&str; 5] = ["x", "y", "velocity", "specific_internal_energy", "reference"];

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

/// The values of each block of particles, of which `groups` are the rows in the table.
fn means(table: &ParticleTable, groups: &[Range<usize>]) -> Vec<TableColumn> {
    let column = |name: &str| table.column(name).expect("mass and density are always there");
    let (mass, density) = (column("mass"), column("density"));
    let volume = |r: usize| mass[r] / density[r];
    let sum = |rows: &Range<usize>, of: &dyn Fn(usize) -> f64| rows.clone().map(of).sum::<f64>();
    let value = |column: &TableColumn, rows: &Range<usize>| {
        let values = &column.values;
        match base(&column.name) {
            "density" => sum(rows, &|r| mass[r]) / sum(rows, &volume),
            "volume" | "mass" => sum(rows, &|r| values[r]),
            name if BY_MASS.contains(&name) => {
                sum(rows, &|r| mass[r] * values[r]) / sum(rows, &|r| mass[r])
            }
            _ => sum(rows, &|r| volume(r) * values[r]) / sum(rows, &volume),
        }
    };
    let of_column = |column: &TableColumn| TableColumn {
        values: groups.iter().map(|rows| value(column, rows)).collect(),
        ..column.clone()
    };
    table.columns.iter().map(of_column).collect()
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

    /// The table of means over blocks; empty except at rank 0. Collective.
    fn bins(&self, most: u64) -> ParticleTable {
        let edge = block_edge(self.scene.particles, most, D);
        let bodies = self.scene.bodies.len() as u64;
        let blocks: [u64; D] =
            std::array::from_fn(|a| (self.scene.cells[a] as u64).div_ceil(edge as u64));
        let body = self.stepper.columns.body;
        let own = self.patches.iter().map(|p| &p.block);
        let (ranks, places) = (self.comm.size(), blocks.iter().product::<u64>() * bodies);
        let layout = self.layout();
        // the rank that has the first cell of a block gets the whole block: few particles travel
        let end = places * ranks as u64;
        let shares = Shares::by_key(self.comm, own, end, ranks, |block, r| {
            let at: [i64; D] = std::array::from_fn(|a| i64::from(block.cells[r][a]) / edge);
            let rank = layout.rank_of(layout.patch_of(at.map(|k| k * edge)));
            let place = (0..D).rev().fold(0, |place, a| place * blocks[a] + at[a] as u64);
            Some(rank as u64 * places + place * bodies + block.columns[body][r] as u64)
        });
        // all columns of a profile, and the masses
        let unwanted = ["strain", "failed", super::HALF_EDGES];
        let table = self.table(&shares, RowOrder::Share, &|name| !unwanted.contains(&base(name)));
        let mut groups: Vec<Range<usize>> = Vec::new();
        for rows in shares.keys.chunk_by(|a, b| a == b) {
            let first = groups.last().map_or(0, |rows| rows.end);
            groups.push(first..first + rows.len());
        }
        let mine = means(&table, &groups);
        let keys = groups.iter().map(|rows| shares.keys[rows.start] % places);
        let mut words: Vec<u64> = keys.collect();
        words.extend(groups.iter().map(|rows| u64::from(table.body[rows.start])));
        words.extend(mine.iter().flat_map(|column| column.values.iter().map(|v| v.to_bits())));
        let all = self.comm.gather(&words);
        self.joined_bins(table, mine, &all, edge)
    }

    /// The table of the bins of all ranks, whose words are keys, bodies and columns; by x.
    fn joined_bins(
        &self,
        table: ParticleTable,
        columns: Vec<TableColumn>,
        all: &[Vec<u64>],
        edge: i64,
    ) -> ParticleTable {
        let width = 2 + columns.len();
        let part = |k: usize| -> Vec<u64> {
            let of = |words: &Vec<u64>| {
                let n = words.len() / width;
                words[k * n..(k + 1) * n].to_vec()
            };
            all.iter().flat_map(of).collect()
        };
        let values =
            |k: usize| -> Vec<f64> { part(2 + k).into_iter().map(f64::from_bits).collect() };
        let (keys, bodies, x) = (part(0), part(1), values(0));
        let mut order: Vec<usize> = (0..keys.len()).collect();
        order.sort_unstable_by(|&a, &b| x[a].total_cmp(&x[b]).then(keys[a].cmp(&keys[b])));
        let mut joined = Vec::new();
        for (k, column) in columns.into_iter().enumerate() {
            if column.name != "mass" {
                let values = values(k);
                let values = order.iter().map(|&r| values[r]).collect();
                joined.push(TableColumn { values, ..column });
            }
        }
        let body: Vec<u32> = order.iter().map(|&r| bodies[r] as u32).collect();
        let half = |a: usize| 0.5 * edge as f64 * self.scene.cell_size[a];
        let square = if D == 1 { None } else { Some([[half(0), 0.0], [0.0, half(1)]]) };
        ParticleTable {
            ids: order.iter().map(|&r| keys[r]).collect(),
            material: body.iter().map(|&b| self.scene.bodies[b as usize].material as u32).collect(),
            half_edges: square.map_or(Vec::new(), |square| vec![square; body.len()]),
            body,
            columns: joined,
            ..table
        }
    }
}

#[cfg(test)]
mod tests {
    use decomp::Serial;
    use decomp::comm::local::run_ranks;

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

    #[test]
    fn means_are_weighted_by_mass_or_volume() {
        let column = |name: &str, values: [f64; 2]| TableColumn {
            name: name.into(),
            unit: String::new(),
            values: values.into(),
        };
        let table = ParticleTable {
            time: 0.0,
            dimension: 1,
            ids: vec![0, 1],
            material: vec![0; 2],
            materials: Vec::new(),
            body: vec![0; 2],
            columns: vec![
                column("x", [0.0, 4.0]),
                column("velocity", [1.0, 5.0]),
                column("pressure", [1.0, 4.0]),
                column("density", [1.0, 3.0]),
                column("mass", [1.0, 3.0]),
            ],
            half_edges: Vec::new(),
        };
        // equal volumes, masses of 1 and 3
        let values: Vec<f64> =
            means(&table, std::slice::from_ref(&(0..2))).iter().map(|c| c.values[0]).collect();
        assert_eq!(values, [3.0, 4.0, 2.5, 2.0, 4.0]);
    }
}
