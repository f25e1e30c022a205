//! Measures the cost of messages, sent as in a run: by [`Comm::exchange`] and [`Comm::min`].

use std::time::Instant;

use decomp::Comm;

use crate::perf_model::Network;
use crate::perf_model::fit::{Sample, dot, fit};

/// Lengths of the messages \[words of 8 bytes\].
const WORDS: [usize; 6] = [1, 16, 64, 256, 1024, 2048];

/// Exchanges per batch, and batches per message length.
const BATCH: usize = 20;
const BATCHES: usize = 200;

/// Computing time that hides a message in flight \[s\].
const HIDING: f64 = 40e-6;

/// Measures latency, time per byte and overhead between ranks 0 and 1, and the level of a reduction
/// over all ranks. Result at rank 0; `None` with a single rank. Collective.
pub fn measure(comm: &dyn Comm) -> Option<Network> {
    if comm.size() < 2 {
        return None;
    }
    let times = WORDS.map(|words| exchange(comm, words, 0.0));
    let hidden = exchange(comm, WORDS[0], HIDING);
    let reduction = fast(comm, || comm.min(&mut [1.0, 2.0, 3.0, 4.0]));
    let call = fast(comm, || comm.exchange(&[], &[], &mut Vec::new(), &mut || {}));
    if comm.rank() != 0 {
        return None;
    }
    let line: Vec<Sample<2>> = WORDS
        .iter()
        .zip(times)
        .map(|(&words, value)| Sample { features: [1.0, 8.0 * words as f64], value, whole: value })
        .collect();
    let line = fit(&line);
    let [alone, seconds_per_byte] = line.coefficients;
    let overhead = (hidden - HIDING - call).clamp(0.0, alone);
    let levels = usize::BITS - (comm.size() - 1).leading_zeros();
    let short = dot(&[1.0, 8.0], &line.coefficients);
    Some(Network {
        name: "measured".into(),
        source: format!(
            "measured between {} ranks; {:.2} us a short message, the line within {:.0} %",
            comm.size(),
            short * 1e6,
            line.largest * 100.0
        ),
        latency: (alone - overhead - call).max(0.0),
        seconds_per_byte,
        overhead,
        call,
        reduction_level: reduction / f64::from(levels),
        measured: true,
    })
}

/// Time of an exchange of messages of `words` words between ranks 0 and 1, which compute for
/// `meanwhile` \[s\] during it \[s\]. Collective.
fn exchange(comm: &dyn Comm, words: usize, meanwhile: f64) -> f64 {
    let message = vec![1u64; words];
    let (other, mut received) = (1 - comm.rank().min(1), Vec::new());
    let takes_part = comm.rank() < 2;
    fast(comm, || {
        if takes_part {
            comm.exchange(&[(other, &message)], &[other], &mut received, &mut || spin(meanwhile));
        }
    })
}

/// Computes for this time.
fn spin(seconds: f64) {
    let start = Instant::now();
    while seconds > 0.0 && start.elapsed().as_secs_f64() < seconds {
        std::hint::spin_loop();
    }
}

/// Time of one call: the 5 % quantile over batches, because other programs only add time \[s\].
/// Collective.
fn fast(comm: &dyn Comm, mut call: impl FnMut()) -> f64 {
    let mut times = Vec::with_capacity(BATCHES);
    for _ in 0..BATCHES {
        comm.min(&mut [0.0]);
        let start = Instant::now();
        (0..BATCH).for_each(|_| call());
        times.push(start.elapsed().as_secs_f64() / BATCH as f64);
    }
    times.sort_by(f64::total_cmp);
    times[BATCHES / 20]
}
