//! Messages between ranks: the trait and its implementations for one rank, threads and MPI.

#[cfg(feature = "mpi")]
mod life;
pub mod local;
#[cfg(feature = "mpi")]
pub mod mpi;
mod watch;

use std::time::Duration;

use crate::{bytes_of, words_of};

/// Default time for which a rank waits for others that give no sign of life.
pub const STALL_TIMEOUT: Duration = Duration::from_secs(300);

/// Messages sent and received and time waited by one rank since its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Messages sent to single ranks.
    pub messages: u64,
    /// Size of these messages [bytes].
    pub bytes: u64,
    /// Size of the messages received [bytes].
    pub bytes_received: u64,
    /// Reductions over all ranks: `min` and `sum`.
    pub reductions: u64,
    /// Time spent waiting for other ranks, receiving included [s].
    pub waited: f64,
}

/// Communication between the ranks of a run. All ranks must make the calls marked "collective", in
/// the same order. If a wait times out, the rank ends the run with a message that names the hanging
/// rank, because the caller could not recover.
pub trait Comm {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends each `(rank, words)`, calls `meanwhile` once, and then receives one message from each
    /// rank of `from` (in that order) into `received`. Messages travel while `meanwhile` computes.
    /// Every send must have a matching receive on the other rank; messages from one rank to another
    /// arrive in the order in which they were sent.
    fn exchange(
        &self,
        sends: &[(usize, &[u64])],
        from: &[usize],
        received: &mut Vec<Vec<u64>>,
        meanwhile: &mut dyn FnMut(),
    );

    /// Minimum of each value over the ranks. Collective.
    fn min(&self, values: &mut [f64]);

    /// Exact sum of each value over the ranks. Collective.
    fn sum(&self, values: &mut [i64]);

    /// Messages sent and received and time waited by this rank so far.
    fn traffic(&self) -> Traffic;

    /// Shows other ranks that this rank makes progress. A rank calls it regularly while it computes
    /// or writes files for a long time and others may wait for it. It costs a read of the clock and
    /// at most a check for a message.
    fn heartbeat(&self) {}

    /// Sets the time for which ranks wait for a rank that gives no sign of life. The time between
    /// two exchanges, reductions or heartbeats of any rank must stay well below it. Must be the
    /// same on all ranks.
    fn set_stall_timeout(&self, _timeout: Duration) {}

    /// Gathers every rank's words at rank 0, ordered by rank; empty on other ranks. Collective.
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

    /// Sends the bytes of rank 0 to every rank. Collective.
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

    /// Ends all ranks with `code`; called by one rank alone.
    fn abort(&self, code: i32) -> !;
}

/// A run with one rank and no messages.
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
