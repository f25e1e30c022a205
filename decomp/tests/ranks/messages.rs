//! Guarantees of an exchange.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use decomp::comm::local::{LocalRank, run_ranks};
use decomp::{Comm, Traffic};

/// The text with which `run_ranks` panics.
pub fn fault<R: Send>(size: usize, body: impl Fn(&LocalRank) -> R + Sync) -> String {
    let end = catch_unwind(AssertUnwindSafe(|| run_ranks(size, body)));
    let fault = end.err().expect("a rank fails");
    fault
        .downcast_ref::<String>()
        .cloned()
        .unwrap_or_else(|| fault.downcast_ref::<&str>().expect("a panic has a text").to_string())
}

#[test]
fn messages_come_in_order_and_by_their_sender() {
    run_ranks(4, |comm| {
        let others: Vec<usize> = (0..4).filter(|&r| r != comm.rank()).rev().collect();
        for round in 0..100u64 {
            let messages: Vec<Vec<u64>> =
                others.iter().map(|&to| vec![round, comm.rank() as u64, to as u64]).collect();
            let sends: Vec<(usize, &[u64])> =
                others.iter().zip(&messages).map(|(&to, words)| (to, &words[..])).collect();
            let (mut received, mut calls) = (vec![vec![9; 9]; 7], 0);
            comm.exchange(&sends, &others, &mut received, &mut || calls += 1);
            let me = comm.rank() as u64;
            let expected: Vec<Vec<u64>> =
                others.iter().map(|&from| vec![round, from as u64, me]).collect();
            assert_eq!((received, calls), (expected, 1));
        }
    });
}

/// Rank 0 continues in `meanwhile` only after it has learned that its message has arrived, so
/// messages must be sent before `meanwhile` ends.
#[test]
fn sends_leave_before_the_rank_computes() {
    let (to_0, from_1) = std::sync::mpsc::channel();
    let from_1 = std::sync::Mutex::new(from_1);
    run_ranks(2, |comm| {
        let mut received = Vec::new();
        if comm.rank() == 0 {
            comm.exchange(&[(1, &[5])], &[], &mut received, &mut || {
                let got = from_1.lock().unwrap().recv_timeout(Duration::from_secs(20));
                assert_eq!(got, Ok(5), "the message waits for the computing");
            });
        } else {
            comm.exchange(&[], &[0], &mut received, &mut || {});
            to_0.send(received[0][0]).unwrap();
        }
    });
}

#[test]
fn all_ranks_get_the_reductions() {
    let got = run_ranks(5, |comm| {
        let r = comm.rank() as f64;
        let mut least = [r, -r, 0.5];
        comm.min(&mut least);
        let mut sums = [comm.rank() as i64, -(1 << 40)];
        comm.sum(&mut sums);
        let text = comm.broadcast(if comm.rank() == 0 { b"eleven bytes".to_vec() } else { vec![] });
        (least, sums, text, comm.gather(&[comm.rank() as u64; 2]))
    });
    for (rank, (least, sums, text, gathered)) in got.into_iter().enumerate() {
        assert_eq!((least, sums), ([0.0, -4.0, 0.5], [10, -5 << 40]));
        assert_eq!(text, b"eleven bytes");
        let all: Vec<Vec<u64>> = (0..5).map(|r| vec![r, r]).collect();
        assert_eq!(gathered, if rank == 0 { all } else { vec![] });
    }
}

#[test]
fn traffic_is_counted() {
    let traffic = run_ranks(2, |comm| {
        let mut received = Vec::new();
        match comm.rank() {
            0 => comm.exchange(&[(1, &[1, 2, 3]), (1, &[])], &[], &mut received, &mut || {
                std::thread::sleep(Duration::from_millis(100))
            }),
            _ => comm.exchange(&[], &[0, 0], &mut received, &mut || {}),
        }
        comm.sum(&mut [1]);
        comm.traffic()
    });
    let [first, second] = traffic[..] else { panic!("two ranks") };
    let (none, waited) = (Traffic { reductions: 1, ..Traffic::default() }, first.waited);
    assert_eq!(first, Traffic { messages: 2, bytes: 24, waited, ..none });
    assert_eq!(second, Traffic { bytes_received: 24, waited: second.waited, ..none });
    assert!((0.05..20.0).contains(&second.waited), "{second:?}");
}

#[test]
fn a_rank_that_fails_ends_all() {
    let fault = fault(3, |comm| {
        if comm.rank() == 1 {
            panic!("no such material");
        }
        comm.min(&mut [0.0]);
    });
    assert_eq!(fault, "no such material");
}

#[test]
fn a_rank_that_has_ended_is_not_waited_for() {
    let fault = fault(2, |comm| {
        if comm.rank() == 0 {
            comm.exchange(&[], &[1], &mut Vec::new(), &mut || {});
        }
    });
    assert_eq!(fault, "rank 0 needs rank 1, which has ended");
}

#[test]
fn one_rank_ends_all_with_a_code() {
    let fault = fault(3, |comm| {
        if comm.rank() == 2 {
            comm.abort(3);
        }
        comm.min(&mut [0.0]);
    });
    assert_eq!(fault, "rank 2 ends all ranks with code 3");
}
