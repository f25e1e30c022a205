//! Threads of a rank, each pinned to a core if free cores are known.

use std::sync::OnceLock;

use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Cores that this thread may use.
fn own_cores() -> Vec<usize> {
    let set = sched_getaffinity(Pid::from_raw(0)).unwrap_or_default();
    (0..CpuSet::count()).filter(|&c| set.is_set(c).unwrap_or(false)).collect()
}

/// Cores that this process may use, recorded before any thread was pinned: a new thread inherits
/// the cores of the thread that creates it.
fn allowed_cores() -> &'static [usize] {
    static ALLOWED: OnceLock<Vec<usize>> = OnceLock::new();
    ALLOWED.get_or_init(own_cores)
}

/// Cores for the `threads` threads of this rank; `None` if a choice would be a guess: with fewer
/// cores than threads, or if other ranks of this machine may use the same cores.
///
/// A scheduler may leave two threads on one core and another core idle, as they sleep and wake too
/// often for it to notice.
fn choose_cores(allowed: &[usize], threads: usize, ranks_here: usize) -> Option<&[usize]> {
    let alone = ranks_here <= 1 && allowed.len() >= threads;
    let bound = allowed.len() == threads;
    (alone || bound).then_some(allowed)
}

/// Number of ranks that the launcher has started on this machine; 1 without a launcher.
fn ranks_here() -> usize {
    ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"]
        .iter()
        .find_map(|name| std::env::var(name).ok()?.parse().ok())
        .unwrap_or(1)
}

/// Pins this thread to some cores.
fn stay_on(cores: &[usize]) {
    let mut set = CpuSet::new();
    // if the system refuses, threads run unpinned
    if cores.iter().all(|&core| set.set(core).is_ok()) {
        let _ = sched_setaffinity(Pid::from_raw(0), &set);
    }
}

/// Pool of `threads` threads including the calling thread, which works instead of waiting for
/// others to wake. A thread can belong to only one such pool in its life; the pool of a later run
/// does not include it.
///
/// # Panics
///
/// If the system cannot start the threads.
pub fn make_pool(threads: usize) -> ThreadPool {
    let allowed = allowed_cores();
    let cores = choose_cores(allowed, threads, ranks_here());
    let stay = move |thread: usize| stay_on(cores.map_or(allowed, |c| &c[thread..=thread]));
    let builder = || ThreadPoolBuilder::new().num_threads(threads).start_handler(stay);
    match builder().use_current_thread().build() {
        Ok(pool) => {
            stay(0);
            pool
        }
        Err(_) => builder().build().expect("the system gives threads"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_get_cores_that_are_surely_free() {
        assert_eq!(choose_cores(&[2, 3], 2, 1), Some(&[2, 3][..]));
        assert_eq!(choose_cores(&[0, 1, 2, 3], 2, 1), Some(&[0, 1, 2, 3][..]));
        assert_eq!(choose_cores(&[0, 1], 3, 1), None, "too few");
        assert_eq!(choose_cores(&[0, 1, 2, 3], 2, 2), None, "not bound");
        assert_eq!(choose_cores(&[4, 5], 2, 8), Some(&[4, 5][..]), "bound by the launcher");
    }

    #[test]
    fn a_later_pool_has_the_cores_of_the_first() {
        let cores = || {
            let pool = make_pool(2);
            pool.broadcast(|_| own_cores())
        };
        let both = std::thread::spawn(move || [cores(), cores()]).join().expect("no panic");
        assert_eq!(both[0], both[1]);
    }
}
