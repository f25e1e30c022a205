//! Waiting for other ranks: the only function in which a rank waits, and the search for the rank
//! that hangs if the wait times out. Independent of MPI and threads.
//!
//! A rank whose wait nears its limit asks the rank that it waits for whether it is alive; in a
//! reduction, rank 0 and those whose number differs from its own in one bit. A rank answers while it
//! waits itself and at each exchange, reduction or heartbeat. The answer names the rank it waits for.
//! A rank that does not answer hangs, and is named. Otherwise the wait continues with a new time limit.
//!
//! Rank 0 asks all ranks in a reduction, and the ranks that those that it asks wait for. If all have
//! answered, and none of them computes or has progressed since the previous round of questions, they
//! are in a deadlock. So P ranks that wait ask P log P questions, and each rank is asked by several.
//!
//! Several ranks reach the same verdict at about the same time, so only one reports it: the lowest
//! rank that does not hang. The others send it the verdict, and report it themselves only if it
//! does not react.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use super::{STALL_TIMEOUT, Traffic};

/// Checks before a waiting rank yields its core.
const SPIN: u64 = 2000;

/// Checks between two reads of the clock and of the other ranks' questions.
const GLANCE: u64 = 8;

/// Longest time between a question and the verdict.
pub(crate) const GRACE: Duration = Duration::from_secs(10);

const ASK: u64 = 0;
const ANSWER: u64 = 1;
const SPEAK: u64 = 2;

/// Transport of questions and answers, separate from all other messages.
pub(crate) trait Control {
    /// Number of this rank.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends words without waiting.
    fn send(&self, to: usize, words: &[u64]);

    /// Receives a message into `words`, if there is one, and returns its sender.
    fn receive(&self, words: &mut Vec<u64>) -> Option<usize>;

    /// Ends all ranks and prints the reason.
    fn end(&self, why: &str) -> !;
}

/// The rank or ranks that a rank waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Awaited {
    /// The rank does not wait.
    Nobody,
    /// One rank.
    Rank(usize),
    /// Any of the other ranks; unknown which.
    All,
}

impl Awaited {
    fn word(self) -> u64 {
        match self {
            Awaited::Nobody => u64::MAX,
            Awaited::All => u64::MAX - 1,
            Awaited::Rank(rank) => rank as u64,
        }
    }

    fn from_word(word: u64) -> Self {
        match word {
            u64::MAX => Awaited::Nobody,
            w if w == u64::MAX - 1 => Awaited::All,
            rank => Awaited::Rank(rank as usize),
        }
    }
}

/// Progress of a rank: number of finished waits and signs of life, and the ranks it waits for.
type WatchState = (u64, Awaited);

/// Waits of a rank, its traffic, and its answers to other ranks.
pub(crate) struct StallWatch<C> {
    control: C,
    timeout: Cell<Duration>,
    /// Time of the last check for questions.
    looked: Cell<Instant>,
    finished: Cell<u64>,
    awaits: Cell<Awaited>,
    /// Number of the last question, to recognize late answers.
    questions: Cell<u64>,
    words: RefCell<Vec<u64>>,
    traffic: Cell<Traffic>,
}

impl<C: Control> StallWatch<C> {
    /// Starts without waits and traffic.
    pub fn new(control: C) -> Self {
        StallWatch {
            control,
            timeout: Cell::new(STALL_TIMEOUT),
            looked: Cell::new(Instant::now()),
            finished: Cell::new(0),
            awaits: Cell::new(Awaited::Nobody),
            questions: Cell::new(0),
            words: RefCell::new(Vec::new()),
            traffic: Cell::new(Traffic::default()),
        }
    }

    /// Transport of questions and answers.
    pub fn control(&self) -> &C {
        &self.control
    }

    /// Sets the time for which to wait for ranks that give no sign of life.
    pub fn set_timeout(&self, timeout: Duration) {
        self.timeout.set(timeout);
    }

    /// Messages sent and received and time waited so far.
    pub fn traffic(&self) -> Traffic {
        self.traffic.get()
    }

    /// Counts the messages that an exchange sends.
    pub fn count_sends(&self, sends: &[(usize, &[u64])]) {
        let mut traffic = self.traffic.get();
        traffic.messages += sends.len() as u64;
        traffic.bytes += sends.iter().map(|(_, words)| size_of_val(*words) as u64).sum::<u64>();
        self.traffic.set(traffic);
    }

    /// Counts the messages that an exchange has received.
    pub fn count_received(&self, received: &[Vec<u64>]) {
        let mut traffic = self.traffic.get();
        traffic.bytes_received +=
            received.iter().map(|words| size_of_val(&words[..]) as u64).sum::<u64>();
        self.traffic.set(traffic);
    }

    /// Counts a reduction.
    pub fn count_reduction(&self) {
        let traffic = self.traffic.get();
        self.traffic.set(Traffic { reductions: traffic.reductions + 1, ..traffic });
    }

    /// Time within which a rank has to answer.
    fn grace(&self) -> Duration {
        GRACE.min(self.timeout.get() / 2)
    }

    /// Records progress of this rank. Answers questions if the last check for them was a while ago;
    /// mostly this costs one read of the clock.
    pub fn heartbeat(&self) {
        self.finished.set(self.finished.get() + 1);
        let now = Instant::now();
        if now - self.looked.get() >= self.grace() / 16 {
            self.looked.set(now);
            self.answer(&mut BTreeMap::new());
        }
    }

    /// Waits for `awaited`: polls `done` until it is true, and yields the core after a short while.
    /// The clock is read only if the first poll fails.
    pub fn wait(&self, awaited: Awaited, mut done: impl FnMut() -> bool) {
        if !done() {
            let start = Instant::now();
            self.awaits.set(awaited);
            self.look_until(&mut done, start);
            self.awaits.set(Awaited::Nobody);
            let traffic = self.traffic.get();
            let waited = traffic.waited + start.elapsed().as_secs_f64();
            self.traffic.set(Traffic { waited, ..traffic });
        }
        self.finished.set(self.finished.get() + 1);
    }

    fn look_until(&self, done: &mut dyn FnMut() -> bool, start: Instant) {
        let mut inquiry = Inquiry::new(start);
        for look in 1u64.. {
            if done() {
                return;
            }
            if look > SPIN {
                std::thread::yield_now();
                if look % GLANCE == 0 {
                    inquiry.go_on(self);
                }
            }
        }
    }

    fn state(&self) -> WatchState {
        (self.finished.get(), self.awaits.get())
    }

    /// Answers questions and records the answers of the ranks in `asked`.
    fn answer(&self, asked: &mut BTreeMap<usize, Asked>) {
        let mut words = self.words.borrow_mut();
        while let Some(from) = self.control.receive(&mut words) {
            match words[..] {
                [ASK, question] => {
                    let (finished, awaits) = self.state();
                    self.control.send(from, &[ANSWER, question, finished, awaits.word()]);
                }
                [ANSWER, question, finished, awaits] => {
                    // an answer that arrives after the end of its wait is ignored
                    if let Some(asked) = asked.get_mut(&from).filter(|a| a.question == question) {
                        asked.answer = Some((finished, Awaited::from_word(awaits)));
                    }
                }
                [SPEAK, ref text @ ..] => {
                    let text: Vec<u8> = text.iter().map(|&b| b as u8).collect();
                    self.control.end(&String::from_utf8_lossy(&text));
                }
                _ => unreachable!("no such control message: {words:?}"),
            }
        }
    }
}

/// A rank that was asked whether it is alive.
struct Asked {
    question: u64,
    /// Time of the question, by the inquiry's clock.
    at: Duration,
    answer: Option<WatchState>,
    /// Whether the ranks that it waits for were asked too.
    followed: bool,
}

/// Questions and answers of one long wait.
struct Inquiry {
    /// Time waited since the last sign of life. A jump of the clock counts little, because this
    /// rank may have been stopped or the machine suspended.
    clock: Duration,
    seen: Instant,
    asked: BTreeMap<usize, Asked>,
    /// The answers of the previous round.
    before: BTreeMap<usize, Asked>,
    /// Time and text of a verdict that was sent to another rank for reporting.
    reported: Option<(Duration, String)>,
}

impl Inquiry {
    fn new(start: Instant) -> Self {
        Inquiry {
            clock: Duration::ZERO,
            seen: start,
            asked: BTreeMap::new(),
            before: BTreeMap::new(),
            reported: None,
        }
    }

    fn go_on<C: Control>(&mut self, watch: &StallWatch<C>) {
        let (timeout, grace) = (watch.timeout.get(), watch.grace());
        let now = Instant::now();
        self.clock += (now - self.seen).min(grace / 4);
        self.seen = now;
        watch.answer(&mut self.asked);
        if let Some((at, why)) = &self.reported {
            if self.clock - *at >= grace {
                watch.control.end(why);
            }
            return;
        }
        if self.clock < timeout - grace {
            return;
        }
        self.ask(watch, watch.awaits.get());
        let follows = watch.control.rank() == 0;
        if follows {
            let fresh = self.asked.values_mut().filter(|a| a.answer.is_some() && !a.followed);
            let next: Vec<Awaited> = fresh
                .map(|asked| {
                    asked.followed = true;
                    asked.answer.map_or(Awaited::Nobody, |(_, awaits)| awaits)
                })
                .collect();
            next.into_iter().for_each(|awaited| self.ask(watch, awaited));
        }

        let due = |asked: &Asked| self.clock - asked.at >= grace;
        let silent = self.asked.iter().filter(|(_, a)| a.answer.is_none() && due(a));
        let silent: Vec<usize> = silent.map(|(&rank, _)| rank).collect();
        if !silent.is_empty() {
            let why = hanging(&silent, timeout, watch.control.rank());
            self.report(watch, &silent, why);
        } else if self.asked.values().all(|a| a.answer.is_some() && due(a)) {
            if follows && self.asked.iter().all(|(rank, now)| stuck(self.before.get(rank), now)) {
                let ranks: Vec<usize> = self.asked.keys().copied().collect();
                let why = deadlocked(&ranks, 2 * timeout);
                self.report(watch, &[], why);
                return;
            }
            self.clock = Duration::ZERO;
            self.before = std::mem::take(&mut self.asked);
        }
    }

    /// Asks the ranks of `awaited` that were not asked in this round.
    fn ask<C: Control>(&mut self, watch: &StallWatch<C>, awaited: Awaited) {
        let (me, size) = (watch.control.rank(), watch.control.size());
        let ranks = match awaited {
            Awaited::Nobody => return,
            Awaited::Rank(rank) => vec![rank],
            Awaited::All if self.asked.len() == size => return,
            Awaited::All => asked_in_reductions(me, size),
        };
        for rank in ranks {
            self.asked.entry(rank).or_insert_with(|| {
                let question = watch.questions.get() + 1;
                watch.questions.set(question);
                // a rank needs no question about itself
                let answer = (rank == watch.control.rank()).then(|| watch.state());
                if answer.is_none() {
                    watch.control.send(rank, &[ASK, question]);
                }
                Asked { question, at: self.clock, answer, followed: false }
            });
        }
    }

    /// Lets the lowest rank that does not hang report the verdict and end the run.
    fn report<C: Control>(&mut self, watch: &StallWatch<C>, hanging: &[usize], why: String) {
        let me = watch.control.rank();
        let speaker = (0..me).find(|rank| !hanging.contains(rank)).unwrap_or(me);
        if speaker == me {
            watch.control.end(&why);
        }
        let words: Vec<u64> = std::iter::once(SPEAK).chain(why.bytes().map(u64::from)).collect();
        watch.control.send(speaker, &words);
        self.reported = Some((self.clock, why));
    }
}

/// The ranks that rank `me` of `size` asks while it waits for all, itself included: rank 0 asks every
/// rank, the others rank 0 and their neighbours on a hypercube.
fn asked_in_reductions(me: usize, size: usize) -> Vec<usize> {
    if me == 0 {
        return (0..size).collect();
    }
    let neighbours = (0..usize::BITS).map(|bit| me ^ (1 << bit)).filter(|&rank| rank < size);
    [0, me].into_iter().chain(neighbours).collect()
}

/// Whether a rank waits, and was in the same wait in the previous round.
fn stuck(before: Option<&Asked>, now: &Asked) -> bool {
    let waits = now.answer.is_some_and(|(_, awaits)| awaits != Awaited::Nobody);
    waits && before.is_some_and(|before| before.answer == now.answer)
}

fn list(ranks: &[usize]) -> String {
    ranks.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

pub(crate) fn hanging(ranks: &[usize], waited: Duration, waiter: usize) -> String {
    let (ranks, seconds) = (list(ranks), waited.as_secs_f64());
    match ranks.contains(',') {
        false => format!(
            "rank {ranks} has made no progress for {seconds} s: it hangs or was stopped (rank {waiter} waited for it)"
        ),
        true => format!(
            "ranks {ranks} have made no progress for {seconds} s: they hang or were stopped (rank {waiter} waited for them)"
        ),
    }
}

fn deadlocked(ranks: &[usize], waited: Duration) -> String {
    let seconds = waited.as_secs_f64();
    format!("no progress for {seconds} s: ranks {} wait for each other, a deadlock", list(ranks))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_in_a_reduction_ask_few_and_each_is_asked() {
        for size in [2usize, 3, 8, 16, 32, 100, 1024] {
            let mut asked = vec![0; size];
            for me in 0..size {
                let mut ranks = asked_in_reductions(me, size);
                ranks.sort_unstable();
                ranks.dedup();
                ranks.into_iter().filter(|&rank| rank != me).for_each(|rank| asked[rank] += 1);
            }
            let all: usize = asked.iter().sum();
            let levels = size.ilog2() as usize + 1;
            assert!(all <= size * (levels + 2), "{size}: {all}");
            // by rank 0, and in a full hypercube by a neighbour beside it
            let least = if size.is_power_of_two() && size > 2 { 2 } else { 1 };
            assert!(asked.iter().all(|&n| n >= least), "{size}: {asked:?}");
        }
    }

    #[test]
    fn only_ranks_that_wait_without_progress_are_stuck() {
        let asked = |answer| Asked { question: 1, at: Duration::ZERO, answer, followed: true };
        let waits = |finished| asked(Some((finished, Awaited::Rank(2))));
        assert!(stuck(Some(&waits(7)), &waits(7)));
        assert!(!stuck(Some(&waits(6)), &waits(7)), "it has got on between two questions");
        let other = asked(Some((7, Awaited::All)));
        assert!(!stuck(Some(&other), &waits(7)), "it waits for another");
        let works = asked(Some((7, Awaited::Nobody)));
        assert!(!stuck(Some(&works), &works));
        assert!(!stuck(None, &waits(7)) && !stuck(Some(&waits(7)), &asked(None)));
    }
}
