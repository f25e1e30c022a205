//! Ranks as threads of one process: for tests, and for programs that run several ranks without MPI.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use super::watch::{Awaited, Control, StallWatch};
use super::{Comm, Traffic};

/// Runs `body` on `size` ranks, each a thread, and returns their results by rank.
///
/// # Panics
///
/// If a rank panics, or ends while another waits for it; the other ranks end too.
pub fn run_ranks<R: Send>(size: usize, body: impl Fn(&LocalRank) -> R + Sync) -> Vec<R> {
    let body = &body;
    let ends: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> =
            LocalRank::all(size).into_iter().map(|rank| scope.spawn(move || body(&rank))).collect();
        threads.into_iter().map(|thread| thread.join()).collect()
    });
    let (mut results, mut faults) = (Vec::new(), Vec::new());
    for end in ends {
        match end {
            Ok(result) => results.push(result),
            Err(fault) => faults.push(fault),
        }
    }
    // ranks that ended because of another rank carry no message
    let first = faults.iter().position(|fault| !fault.is::<EndedByAnother>()).unwrap_or(0);
    if !faults.is_empty() {
        resume_unwind(faults.swap_remove(first));
    }
    results
}

/// A rank that is a thread of this process.
pub struct LocalRank {
    rank: usize,
    /// Channel to each rank.
    to: Vec<Sender<Vec<u64>>>,
    /// Channel from each rank.
    from: Vec<Receiver<Vec<u64>>>,
    watch: StallWatch<Channel>,
}

/// Panic payload of a thread that ends because another rank has failed.
struct EndedByAnother;

impl LocalRank {
    fn all(size: usize) -> Vec<Self> {
        let failed = Arc::new(AtomicBool::new(false));
        let (mut to, mut from) = (vec![Vec::new(); size], Vec::new());
        let (mut asks, mut asked) = (Vec::new(), Vec::new());
        for _ in 0..size {
            let (senders, receivers): (Vec<_>, Vec<_>) = (0..size).map(|_| channel()).unzip();
            to.iter_mut().zip(senders).for_each(|(to, sender)| to.push(sender));
            from.push(receivers);
            let (sender, receiver) = channel();
            asks.push(sender);
            asked.push(receiver);
        }
        let ends = to.into_iter().zip(from).zip(asked).enumerate();
        ends.map(|(rank, ((to, from), asked))| {
            let (to_control, failed) = (asks.clone(), failed.clone());
            let watch = StallWatch::new(Channel { rank, to: to_control, from: asked, failed });
            LocalRank { rank, to, from, watch }
        })
        .collect()
    }

    fn send(&self, to: usize, words: Vec<u64>) {
        if self.to[to].send(words).is_err() {
            self.lost(to);
        }
    }

    fn receive(&self, source: usize) -> Vec<u64> {
        let mut found = None;
        self.watch.wait(Awaited::Rank(source), || match self.from[source].try_recv() {
            Ok(words) => {
                found = Some(words);
                true
            }
            Err(TryRecvError::Empty) => {
                self.watch.control().end_with_others();
                false
            }
            Err(TryRecvError::Disconnected) => self.lost(source),
        });
        found.expect("the wait ends with a message")
    }

    fn lost(&self, other: usize) -> ! {
        self.watch.control().end_with_others();
        panic!("rank {} needs rank {other}, which has ended", self.rank)
    }

    /// Combines the values of all ranks at rank 0, in order of ranks, and sends the result to all.
    fn reduce(&self, values: &mut [u64], combine: impl Fn(u64, u64) -> u64) {
        self.watch.count_reduction();
        self.watch.heartbeat();
        if self.rank != 0 {
            self.send(0, values.to_vec());
            values.copy_from_slice(&self.receive(0));
            return;
        }
        for source in 1..self.size() {
            let theirs = self.receive(source);
            assert_eq!(theirs.len(), values.len(), "all ranks reduce as many values");
            values.iter_mut().zip(theirs).for_each(|(mine, other)| *mine = combine(*mine, other));
        }
        (1..self.size()).for_each(|rank| self.send(rank, values.to_vec()));
    }
}

impl Comm for LocalRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn exchange(
        &self,
        sends: &[(usize, &[u64])],
        from: &[usize],
        received: &mut Vec<Vec<u64>>,
        meanwhile: &mut dyn FnMut(),
    ) {
        self.watch.count_sends(sends);
        sends.iter().for_each(|(to, words)| self.send(*to, words.to_vec()));
        self.watch.heartbeat();
        meanwhile();
        received.clear();
        received.extend(from.iter().map(|&source| self.receive(source)));
        self.watch.count_received(received);
    }

    fn min(&self, values: &mut [f64]) {
        let mut words: Vec<u64> = values.iter().map(|v| v.to_bits()).collect();
        self.reduce(&mut words, |a, b| f64::from_bits(a).min(f64::from_bits(b)).to_bits());
        values.iter_mut().zip(words).for_each(|(value, word)| *value = f64::from_bits(word));
    }

    fn sum(&self, values: &mut [i64]) {
        let mut words: Vec<u64> = values.iter().map(|&v| v as u64).collect();
        self.reduce(&mut words, u64::wrapping_add);
        values.iter_mut().zip(words).for_each(|(value, word)| *value = word as i64);
    }

    fn traffic(&self) -> Traffic {
        self.watch.traffic()
    }

    fn heartbeat(&self) {
        self.watch.heartbeat();
    }

    fn set_stall_timeout(&self, timeout: Duration) {
        self.watch.set_timeout(timeout);
    }

    /// Ends the ranks, not the process: [`run_ranks`] panics.
    fn abort(&self, code: i32) -> ! {
        panic!("rank {} ends all ranks with code {code}", self.rank)
    }
}

impl Drop for LocalRank {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.watch.control().failed.store(true, Ordering::Release);
        }
    }
}

/// Channels for questions and answers, and a flag for a failed rank.
struct Channel {
    rank: usize,
    to: Vec<Sender<(usize, Vec<u64>)>>,
    from: Receiver<(usize, Vec<u64>)>,
    failed: Arc<AtomicBool>,
}

impl Channel {
    /// Ends this rank without a message if another rank has failed.
    fn end_with_others(&self) {
        if self.failed.load(Ordering::Acquire) {
            let quiet: Box<dyn Any + Send> = Box::new(EndedByAnother);
            resume_unwind(quiet);
        }
    }
}

impl Control for Channel {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn send(&self, to: usize, words: &[u64]) {
        // a rank that has ended does not answer; its end is detected elsewhere
        let _ = self.to[to].send((self.rank, words.to_vec()));
    }

    fn receive(&self, words: &mut Vec<u64>) -> Option<usize> {
        let (from, message) = self.from.try_recv().ok()?;
        *words = message;
        Some(from)
    }

    fn end(&self, why: &str) -> ! {
        panic!("{why}")
    }
}
