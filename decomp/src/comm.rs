//! Messages between ranks: the trait, the form for one rank, ranks as threads, and MPI.

#[cfg(feature = "mpi")]
mod life;
pub mod local;
#[cfg(feature = "mpi")]
pub mod mpi;
mod watch;

use std::time::Duration;

use crate::{bytes_of, words_of};

/// How long a rank waits for others that give no sign of life, unless it is told otherwise.
pub const STALL_TIMEOUT: Duration = Duration::from_secs(300);

/// What a rank has sent and how long it has waited, since it was started.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Messages sent to single ranks.
    pub messages: u64,
    /// What they carried [bytes].
    pub bytes: u64,
    /// Reductions over all ranks: `min` and `sum`.
    pub reductions: u64,
    /// Time spent waiting for others, receiving included [s].
    pub waited: f64,
}

/// What the ranks of a run say to each other. Calls marked "collective" must be made by all
/// ranks in the same order. A rank that waits in vain ends the run with a message that names the
/// rank that hangs: there is nothing that its caller could do.
pub trait Comm {
    /// This rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends each `(rank, words)`, calls `meanwhile` once, and then receives one message from
    /// each rank of `from` (in that order) into `received`. Messages travel while `meanwhile`
    /// computes. Every send must be met by a receive on the other side; messages from one rank to
    /// another arrive in the order in which they were sent.
    fn exchange(
        &self,
        sends: &[(usize, &[u64])],
        from: &[usize],
        received: &mut Vec<Vec<u64>>,
        meanwhile: &mut dyn FnMut(),
    );

    /// Least of each value over the ranks. Collective.
    fn min(&self, values: &mut [f64]);

    /// Sum of each value over the ranks, exact. Collective.
    fn sum(&self, values: &mut [i64]);

    /// What this rank has sent and waited for so far.
    fn traffic(&self) -> Traffic;

    /// Shows the others that this rank makes progress: to be called now and then by a rank that
    /// computes or writes files for long while others may wait for it. Costs a glance at the
    /// clock, or at most a look for a message.
    fn heartbeat(&self) {}

    /// How long ranks wait for one that gives no sign of life: the time between two exchanges,
    /// reductions or heartbeats of any rank must stay well below. Alike on all ranks.
    fn set_stall_timeout(&self, _timeout: Duration) {}

    /// Every rank's words at rank 0, by rank; nothing elsewhere. Collective.
    fn gather(&self, words: &[u64]) -> Vec<Vec<u64>> {
        let mut all = Vec::new();
        if self.rank() == 0 {
            let from: Vec<usize> = (1..self.size()).collect();
            self.exchange(&[], &from, &mut all, &mut || {});
            all.insert(0, words.to_vec());
        } else {
            self.exchange(&[(0, words)], &[], &mut all, &mut || {});
        }
        all
    }

    /// Rank 0's bytes on every rank. Collective.
    fn broadcast(&self, bytes: Vec<u8>) -> Vec<u8> {
        let mut received = Vec::new();
        if self.rank() == 0 {
            let words = words_of(&bytes);
            let sends: Vec<(usize, &[u64])> = (1..self.size()).map(|r| (r, &words[..])).collect();
            self.exchange(&sends, &[], &mut received, &mut || {});
            return bytes;
        }
        self.exchange(&[], &[0], &mut received, &mut || {});
        bytes_of(&received[0])
    }

    /// Ends all ranks with `code`, from this one alone.
    fn abort(&self, code: i32) -> !;
}

/// One rank, no messages.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Comm for Serial {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange(
        &self,
        sends: &[(usize, &[u64])],
        from: &[usize],
        received: &mut Vec<Vec<u64>>,
        meanwhile: &mut dyn FnMut(),
    ) {
        debug_assert!(sends.is_empty() && from.is_empty(), "one rank has nobody to talk to");
        received.clear();
        meanwhile();
    }

    fn min(&self, _values: &mut [f64]) {}

    fn sum(&self, _values: &mut [i64]) {}

    fn traffic(&self) -> Traffic {
        Traffic::default()
    }

    fn abort(&self, code: i32) -> ! {
        std::process::exit(code)
    }
}
