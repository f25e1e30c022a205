//! Estimate of the memory of a run, compared with the free memory of each machine before it starts.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use decomp::Comm;

use super::output::folder::host;
use super::recorder::most_particles;
use crate::input::{self, SceneError};
use crate::scene::CheckedScene;
use crate::simulation::rank_memory;

/// Memory of a particle in the table of a profile and in the messages that it is made of [bytes], on a
/// line and in a plane, where it also has a parallelogram and a second velocity.
const BYTES_PER_ROW: [u64; 2] = [180, 300];

/// Memory of rank 0 for messages of all ranks, and the part of each of them [bytes]: buffers of MPI, and
/// what rank 0 gathers.
const MESSAGES: u64 = 5 << 20;
const FROM_A_RANK: u64 = 128 << 10;

/// Estimated memory of `rank` of `ranks` in a run with `threads` threads a rank [bytes]. Rank 0 also
/// holds the table of a profile, and what other ranks send it.
pub fn needed_memory(scene: &CheckedScene, rank: usize, ranks: usize, threads: usize) -> u64 {
    let own = rank_memory(scene, rank, ranks, threads);
    if rank > 0 {
        return own;
    }
    let rows = most_particles(scene).min(scene.particles);
    let table = BYTES_PER_ROW[scene.dimension - 1].saturating_mul(rows);
    let messages = if ranks > 1 { MESSAGES + FROM_A_RANK * ranks as u64 } else { 0 };
    own.saturating_add(table).saturating_add(messages)
}

/// Memory of one rank, and what its machine has left [bytes]; `available` is 0 where that is not
/// known.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RankMemory {
    machine: u64,
    needed: u64,
    available: u64,
}

/// The memory needed and left [bytes] of the machine that lacks most, if one does: the ranks of each
/// machine share what it has left.
fn lacking(ranks: &[RankMemory]) -> Option<[u64; 2]> {
    let mut machines: BTreeMap<u64, [u64; 2]> = BTreeMap::new();
    for rank in ranks.iter().filter(|rank| rank.available > 0) {
        let [needed, available] = machines.entry(rank.machine).or_insert([0, u64::MAX]);
        *needed = needed.saturating_add(rank.needed);
        *available = rank.available.min(*available);
    }
    let lack = |[needed, available]: &[u64; 2]| needed.saturating_sub(*available);
    machines.into_values().filter(|machine| lack(machine) > 0).max_by_key(lack)
}

/// Rejects a run that needs more memory than one of its machines has left. Collective.
///
/// # Errors
///
/// If a machine has too little memory; the same on all ranks.
pub fn check_memory(
    comm: &dyn Comm,
    scene: &CheckedScene,
    threads: usize,
) -> Result<(), SceneError> {
    let needed = needed_memory(scene, comm.rank(), comm.size(), threads);
    let mut hasher = DefaultHasher::new();
    host().hash(&mut hasher);
    let mine = [hasher.finish(), needed, input::available_memory().unwrap_or(0)];
    let ranks = comm.gather(&mine);
    let of =
        |words: &Vec<u64>| RankMemory { machine: words[0], needed: words[1], available: words[2] };
    let ranks: Vec<RankMemory> = ranks.iter().map(of).collect();
    let verdict = lacking(&ranks).map_or(Vec::new(), |lack| lack.map(u64::to_le_bytes).concat());
    let verdict = comm.broadcast(verdict);
    match verdict.as_chunks().0 {
        [needed, available] => {
            let [needed, available] = [*needed, *available].map(u64::from_le_bytes);
            Err(scene.lacks_memory(needed, available))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_share_the_memory_of_their_machine() {
        let rank = |machine, needed| RankMemory { machine, needed, available: 100 };
        // each machine has room for its own ranks, none for all
        assert_eq!(lacking(&[rank(1, 50), rank(1, 50), rank(2, 90), rank(3, 90)]), None);
        assert_eq!(lacking(&[rank(1, 60), rank(1, 50), rank(2, 90)]), Some([110, 100]));
        // the machine that lacks most
        assert_eq!(lacking(&[rank(1, 101), rank(2, 150)]), Some([150, 100]));
        // what a machine has left is what the last of its ranks has seen
        let less = RankMemory { available: 40, ..rank(1, 30) };
        assert_eq!(lacking(&[rank(1, 30), less]), Some([60, 40]));
        // unknown memory refuses nothing
        assert_eq!(lacking(&[RankMemory { available: 0, ..rank(1, 500) }]), None);
    }
}
