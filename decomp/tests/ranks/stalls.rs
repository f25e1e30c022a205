//! Detection of hanging ranks, without false alarms.

use std::time::{Duration, Instant};

use decomp::Comm;
use decomp::comm::local::{LocalRank, run_ranks};

use crate::messages::fault;

fn receive(comm: &LocalRank, from: usize) {
    comm.exchange(&[], &[from], &mut Vec::new(), &mut || {});
}

fn send(comm: &LocalRank, to: usize) {
    comm.exchange(&[(to, &[1])], &[], &mut Vec::new(), &mut || {});
}

/// Gives no sign of life for this time [s].
fn hang(seconds: f64) {
    std::thread::sleep(Duration::from_secs_f64(seconds));
}

#[test]
fn the_rank_at_the_end_of_a_chain_is_named() {
    let since = Instant::now();
    let fault = fault(4, |comm| {
        comm.set_stall_timeout(Duration::from_secs_f64(0.5));
        match comm.rank() {
            0 => receive(comm, 1),
            1 => receive(comm, 3),
            // enters late but is not the cause
            2 => receive(comm, 0),
            _ => hang(3.0),
        }
    });
    assert!(fault.contains("rank 3 has made no progress for 0.5 s: it hangs"), "{fault}");
    assert!(since.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_rank_missing_in_a_reduction_is_named() {
    for victim in 0..3 {
        let fault = fault(3, |comm| {
            comm.set_stall_timeout(Duration::from_secs_f64(0.5));
            comm.min(&mut [0.0]);
            if comm.rank() == victim {
                hang(3.0);
            }
            comm.min(&mut [0.0]);
        });
        let message = format!("rank {victim} has made no progress for 0.5 s: it hangs");
        assert!(fault.contains(&message), "{fault}");
    }
}

/// The others wait through several rounds of questions; rank 0 waits only for a rank that itself
/// waits.
#[test]
fn a_slow_rank_that_shows_life_is_waited_for() {
    let traffic = run_ranks(3, |comm| {
        comm.set_stall_timeout(Duration::from_secs(1));
        match comm.rank() {
            0 => receive(comm, 1),
            1 => {
                receive(comm, 2);
                send(comm, 0);
            }
            _ => {
                let start = Instant::now();
                while start.elapsed() < Duration::from_secs(4) {
                    hang(0.02);
                    comm.heartbeat();
                }
                send(comm, 1);
            }
        }
        // late answers do no harm
        comm.min(&mut [0.0]);
        comm.traffic()
    });
    assert!(traffic[0].waited > 3.0, "{traffic:?}");
}

/// Progress between two waits is also a sign of life.
#[test]
fn a_rank_that_works_with_another_is_waited_for() {
    run_ranks(3, |comm| {
        comm.set_stall_timeout(Duration::from_secs(1));
        match comm.rank() {
            0 => receive(comm, 1),
            rank => {
                for _ in 0..12 {
                    // in turn, so that rank 1 mostly waits
                    if rank == 2 {
                        hang(0.25);
                        send(comm, 1);
                    } else {
                        receive(comm, 2);
                    }
                }
                if rank == 1 {
                    send(comm, 0);
                }
            }
        }
    });
}

#[test]
fn ranks_that_wait_for_each_other_are_reported() {
    let fault = fault(3, |comm| {
        comm.set_stall_timeout(Duration::from_secs_f64(0.5));
        receive(comm, [1, 0, 1][comm.rank()]);
    });
    assert_eq!(fault, "no progress for 1 s: ranks 0, 1 wait for each other, a deadlock");
}
