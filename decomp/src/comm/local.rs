//! Ranks as threads of one process: for tests, and for programs that run several ranks without MPI.

use std::any::Any;
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
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
    shared: Arc<Shared>,
    /// Messages of all ranks, as they arrive.
    from: Receiver<Message>,
    /// Messages that have arrived before this rank asked for them, by sender.
    early: RefCell<BTreeMap<usize, VecDeque<Vec<u64>>>>,
    watch: StallWatch<Channel>,
}

/// Sender and words of a message.
type Message = (usize, Vec<u64>);

/// State that all ranks share: one channel for messages and one for control messages to each rank.
struct Shared {
    messages: Vec<Sender<Message>>,
    control: Vec<Sender<Message>>,
    /// Whether each rank has ended.
    ended: Vec<AtomicBool>,
    /// Whether a rank has failed.
    failed: AtomicBool,
}

/// Panic payload of a thread that ends because another rank has failed.
struct EndedByAnother;

impl LocalRank {
    fn all(size: usize) -> Vec<Self> {
        let channels = || -> (Vec<_>, Vec<_>) { (0..size).map(|_| channel()).unzip() };
        let ((messages, from), (control, asked)) = (channels(), channels());
        let ended = (0..size).map(|_| AtomicBool::new(false)).collect();
        let failed = AtomicBool::new(false);
        let shared = Arc::new(Shared { messages, control, ended, failed });
        let ends = from.into_iter().zip(asked).enumerate();
        ends.map(|(rank, (from, asked))| {
            let watch = StallWatch::new(Channel { rank, shared: shared.clone(), from: asked });
            LocalRank { rank, shared: shared.clone(), from, early: RefCell::default(), watch }
        })
        .collect()
    }

    fn send(&self, to: usize, words: Vec<u64>) {
        if self.shared.messages[to].send((self.rank, words)).is_err() {
            self.lost(to);
        }
    }

    fn receive(&self, source: usize) -> Vec<u64> {
        let mut found = None;
        self.watch.wait(Awaited::Rank(source), || {
            // the flag first: after its end a rank sends nothing more
            let ended = self.shared.ended[source].load(Ordering::Acquire);
            found = self.arrived_from(source);
            if found.is_none() {
                self.watch.control().end_with_others();
                if ended {
                    self.lost(source);
                }
            }
            found.is_some()
        });
        found.expect("the wait ends with a message")
    }

    /// The next message of `source`, if it has arrived.
    fn arrived_from(&self, source: usize) -> Option<Vec<u64>> {
        let mut early = self.early.borrow_mut();
        for (from, words) in self.from.try_iter() {
            early.entry(from).or_default().push_back(words);
        }
        let messages = early.get_mut(&source)?;
        let words = messages.pop_front();
        if messages.is_empty() {
            early.remove(&source);
        }
        words
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
        self.shared.messages.len()
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
            self.shared.failed.store(true, Ordering::Release);
        }
        self.shared.ended[self.rank].store(true, Ordering::Release);
    }
}

/// Channels for questions and answers.
struct Channel {
    rank: usize,
    shared: Arc<Shared>,
    from: Receiver<Message>,
}

impl Channel {
    /// Ends this rank without a message if another rank has failed.
    fn end_with_others(&self) {
        if self.shared.failed.load(Ordering::Acquire) {
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
        self.shared.control.len()
    }

    fn send(&self, to: usize, words: &[u64]) {
        // a rank that has ended does not answer; its end is detected elsewhere
        let _ = self.shared.control[to].send((self.rank, words.to_vec()));
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
