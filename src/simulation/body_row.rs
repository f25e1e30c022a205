//! Surfaces and failed parts of the bodies of a run on a line, for the x-t diagram.

use super::run::Simulation;

/// Surfaces and failed parts of all bodies at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyRow {
    /// Time [s].
    pub time: f64,
    /// Positions of the first and the last particle of each body [m]; infinite if none is left.
    pub ends: Vec<[f64; 2]>,
    /// Lower and upper end of each part that has failed [m], in ascending order.
    pub failed: Vec<[f64; 2]>,
}

impl<const D: usize> Simulation<'_, D> {
    /// The bodies along x at rank 0; of the failed material every `stride`th particle by id is
    /// looked at. Other ranks get no failed parts. Collective.
    pub fn body_row(&self, stride: u64) -> BodyRow {
        let c = &self.stepper.columns;
        let shift = self.frame.travel(self.time)[0];
        let mut ends = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.scene.bodies.len()];
        let mut failed = Vec::new();
        for block in self.patches.iter().map(|patch| &patch.block) {
            for r in 0..block.own() {
                let (x, body) = (block.columns[c.position][r] + shift, block.columns[c.body][r]);
                let body = body as usize;
                ends[body] = [ends[body][0].min(x), ends[body][1].max(x)];
                if c.may_fail() && block.ids[r].is_multiple_of(stride) {
                    let damage = c.tension_free[body].map_or(0.0, |k| block.columns[k][r]);
                    failed.extend([x.to_bits(), u64::from(damage >= 1.0)]);
                }
            }
        }
        let words: Vec<u64> = ends.iter().flatten().map(|x| x.to_bits()).collect();
        for rank in self.comm.gather(&words) {
            for (end, of_rank) in ends.iter_mut().zip(rank.chunks_exact(2)) {
                let [low, high] = [of_rank[0], of_rank[1]].map(f64::from_bits);
                *end = [end[0].min(low), end[1].max(high)];
            }
        }
        let mut all: Vec<(f64, bool)> = Vec::new();
        if c.may_fail() {
            let gathered = self.comm.gather(&failed);
            let particles = gathered.iter().flat_map(|words| words.chunks_exact(2));
            all.extend(particles.map(|w| (f64::from_bits(w[0]), w[1] == 1)));
            // particles at one place in an order that no layout changes
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        BodyRow { time: self.time, ends, failed: failed_parts(&all) }
    }
}

/// A longer distance between failed particles, in median distances, is a gap of the material.
const GAP: f64 = 6.0;

/// First and last position of each run of failed particles without a gap among particles sorted by
/// position.
fn failed_parts(particles: &[(f64, bool)]) -> Vec<[f64; 2]> {
    let mut distances: Vec<f64> = particles.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let middle = distances.len() / 2;
    let longest = match distances.is_empty() {
        true => 0.0,
        false => GAP * *distances.select_nth_unstable_by(middle, f64::total_cmp).1,
    };
    let together = |a: &(f64, bool), b: &(f64, bool)| a.1 == b.1 && b.0 - a.0 <= longest;
    let runs = particles.chunk_by(together).filter(|run| run[0].1);
    runs.map(|run| [run[0].0, run[run.len() - 1].0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_that_have_failed_are_one_part() {
        let failed = [false, true, true, false, true, false, false, true, true];
        let particles: Vec<(f64, bool)> =
            failed.iter().enumerate().map(|(k, failed)| (k as f64, *failed)).collect();
        assert_eq!(failed_parts(&particles), [[1.0, 2.0], [4.0, 4.0], [7.0, 8.0]]);
        assert!(failed_parts(&particles[..1]).is_empty());
        // the surfaces of a spall gap are two parts
        let apart = [0.0, 1.0, 2.0, 3.0, 10.0, 11.0].map(|x| (x, (2.0..=10.0).contains(&x)));
        assert_eq!(failed_parts(&apart), [[2.0, 3.0], [10.0, 10.0]]);
    }
}
