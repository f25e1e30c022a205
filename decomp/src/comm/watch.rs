//! Waiting for other ranks: the one function in which a rank waits, and who is to blame when it
//! waits in vain. Knows neither MPI nor threads.
//!
//! A rank whose wait nears its limit asks the ranks that it waits for whether they live. A rank
//! answers while it waits itself and at each exchange, reduction or heartbeat, and tells whom it
//! waits for; these are asked in turn. One that does not answer hangs, and is named. When all have answered and none of them
//! computes or has come further since the round of questions before, they wait for each other for
//! ever. Otherwise the wait goes on with a fresh clock.
//!
//! Several ranks come to the same verdict at about the same time, so one speaks for all: the
//! lowest that does not hang. The others tell it, and speak themselves only if it stays silent.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use super::{STALL_TIMEOUT, Traffic};

/// Looks before a waiting rank gives way to others.
const SPIN: u64 = 2000;

/// Looks between two glances at the clock and at the other ranks' questions.
const GLANCE: u64 = 8;

/// Longest time between a question and the verdict.
pub(crate) const GRACE: Duration = Duration::from_secs(10);

const ASK: u64 = 0;
const ANSWER: u64 = 1;
const SPEAK: u64 = 2;

/// How questions and answers travel, apart from all other messages.
pub(crate) trait Control {
    /// This rank.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends words without ever waiting.
    fn send(&self, to: usize, words: &[u64]);

    /// Takes a message into `words` if one is there, and returns its sender.
    fn receive(&self, words: &mut Vec<u64>) -> Option<usize>;

    /// Ends all ranks and tells why.
    fn end(&self, why: &str) -> !;
}

/// Whom a rank waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Awaited {
    /// It does not wait.
    Nobody,
    /// One rank.
    Rank(usize),
    /// Some of the others, it cannot tell whom.
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

/// How far a rank has come: finished waits and signs of life, and whom it waits for.
type State = (u64, Awaited);

/// A rank's waits, what it has sent, and its answers to others.
pub(crate) struct Watch<C> {
    control: C,
    timeout: Cell<Duration>,
    /// When it last looked for questions.
    looked: Cell<Instant>,
    finished: Cell<u64>,
    awaits: Cell<Awaited>,
    /// Number of the last question, so that late answers are known as such.
    questions: Cell<u64>,
    words: RefCell<Vec<u64>>,
    traffic: Cell<Traffic>,
}

impl<C: Control> Watch<C> {
    /// No waits and no traffic yet.
    pub fn new(control: C) -> Self {
        Watch {
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

    /// What carries its questions.
    pub fn control(&self) -> &C {
        &self.control
    }

    /// Sets how long to wait for ranks that give no sign of life.
    pub fn set_timeout(&self, timeout: Duration) {
        self.timeout.set(timeout);
    }

    /// What was counted so far.
    pub fn traffic(&self) -> Traffic {
        self.traffic.get()
    }

    /// Counts messages.
    pub fn count_sends(&self, sends: &[(usize, &[u64])]) {
        let mut traffic = self.traffic.get();
        traffic.messages += sends.len() as u64;
        traffic.bytes += sends.iter().map(|(_, words)| size_of_val(*words) as u64).sum::<u64>();
        self.traffic.set(traffic);
    }

    /// Counts a reduction.
    pub fn count_reduction(&self) {
        let traffic = self.traffic.get();
        self.traffic.set(Traffic { reductions: traffic.reductions + 1, ..traffic });
    }

    /// Time that a rank has to answer.
    fn grace(&self) -> Duration {
        GRACE.min(self.timeout.get() / 2)
    }

    /// Shows that this rank has come further, and answers questions if it has not looked for any
    /// for a while: mostly this costs a glance at the clock.
    pub fn heartbeat(&self) {
        self.finished.set(self.finished.get() + 1);
        let now = Instant::now();
        if now - self.looked.get() >= self.grace() / 16 {
            self.looked.set(now);
            self.answer(&mut BTreeMap::new());
        }
    }

    /// Waits for `awaited` until `done`, looking again and again; gives way to others after a
    /// short while. The clock is read only if the first look is in vain.
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

    fn state(&self) -> State {
        (self.finished.get(), self.awaits.get())
    }

    /// Answers questions and notes the answers to those of `asked`.
    fn answer(&self, asked: &mut BTreeMap<usize, Asked>) {
        let mut words = self.words.borrow_mut();
        while let Some(from) = self.control.receive(&mut words) {
            match words[..] {
                [ASK, question] => {
                    let (finished, awaits) = self.state();
                    self.control.send(from, &[ANSWER, question, finished, awaits.word()]);
                }
                [ANSWER, question, finished, awaits] => {
                    // an answer that comes after its wait has ended is of no use
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

/// A rank that was asked whether it lives.
struct Asked {
    question: u64,
    /// When, by the inquiry's clock.
    at: Duration,
    answer: Option<State>,
    /// Whether those that it waits for were asked too.
    followed: bool,
}

/// What a rank that waits for long finds out about the others.
struct Inquiry {
    /// Time waited since the last sign of life. A jump counts little: this rank itself may have
    /// been stopped, or the machine asleep.
    clock: Duration,
    seen: Instant,
    asked: BTreeMap<usize, Asked>,
    /// The answers of the round before.
    before: BTreeMap<usize, Asked>,
    /// When another rank was told to speak, and what.
    told: Option<(Duration, String)>,
}

impl Inquiry {
    fn new(start: Instant) -> Self {
        Inquiry {
            clock: Duration::ZERO,
            seen: start,
            asked: BTreeMap::new(),
            before: BTreeMap::new(),
            told: None,
        }
    }

    fn go_on<C: Control>(&mut self, watch: &Watch<C>) {
        let (timeout, grace) = (watch.timeout.get(), watch.grace());
        let now = Instant::now();
        self.clock += (now - self.seen).min(grace / 4);
        self.seen = now;
        watch.answer(&mut self.asked);
        if let Some((at, why)) = &self.told {
            if self.clock - *at >= grace {
                watch.control.end(why);
            }
            return;
        }
        if self.clock < timeout - grace {
            return;
        }
        self.ask(watch, watch.awaits.get());
        let fresh = self.asked.values_mut().filter(|a| a.answer.is_some() && !a.followed);
        let next: Vec<Awaited> = fresh
            .map(|asked| {
                asked.followed = true;
                asked.answer.map_or(Awaited::Nobody, |(_, awaits)| awaits)
            })
            .collect();
        next.into_iter().for_each(|awaited| self.ask(watch, awaited));

        let due = |asked: &Asked| self.clock - asked.at >= grace;
        let silent = self.asked.iter().filter(|(_, a)| a.answer.is_none() && due(a));
        let silent: Vec<usize> = silent.map(|(&rank, _)| rank).collect();
        if !silent.is_empty() {
            let why = hanging(&silent, timeout, watch.control.rank());
            self.tell(watch, &silent, why);
        } else if self.asked.values().all(|a| a.answer.is_some() && due(a)) {
            if self.asked.iter().all(|(rank, now)| stuck(self.before.get(rank), now)) {
                let ranks: Vec<usize> = self.asked.keys().copied().collect();
                let why = deadlocked(&ranks, 2 * timeout);
                self.tell(watch, &[], why);
                return;
            }
            self.clock = Duration::ZERO;
            self.before = std::mem::take(&mut self.asked);
        }
    }

    /// Asks those of `awaited` that were not asked in this round.
    fn ask<C: Control>(&mut self, watch: &Watch<C>, awaited: Awaited) {
        let size = watch.control.size();
        let ranks = match awaited {
            Awaited::Nobody => return,
            Awaited::Rank(rank) => rank..rank + 1,
            Awaited::All if self.asked.len() == size => return,
            Awaited::All => 0..size,
        };
        for rank in ranks {
            self.asked.entry(rank).or_insert_with(|| {
                let question = watch.questions.get() + 1;
                watch.questions.set(question);
                // of itself a rank knows without asking
                let answer = (rank == watch.control.rank()).then(|| watch.state());
                if answer.is_none() {
                    watch.control.send(rank, &[ASK, question]);
                }
                Asked { question, at: self.clock, answer, followed: false }
            });
        }
    }

    /// Has the lowest rank that does not hang speak, and end the run.
    fn tell<C: Control>(&mut self, watch: &Watch<C>, hanging: &[usize], why: String) {
        let me = watch.control.rank();
        let speaker = (0..me).find(|rank| !hanging.contains(rank)).unwrap_or(me);
        if speaker == me {
            watch.control.end(&why);
        }
        let words: Vec<u64> = std::iter::once(SPEAK).chain(why.bytes().map(u64::from)).collect();
        watch.control.send(speaker, &words);
        self.told = Some((self.clock, why));
    }
}

/// Whether a rank waits, and has been in the same wait in the round before.
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
