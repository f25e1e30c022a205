//! Threads of a rank, each on a core of its own where that is known to be free.

use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The cores that this process may use.
fn allowed_cores() -> Vec<usize> {
    let set = sched_getaffinity(Pid::from_raw(0)).unwrap_or_default();
    (0..CpuSet::count()).filter(|&c| set.is_set(c).unwrap_or(false)).collect()
}

/// Which core each of `threads` threads of this rank is to stay on; `None` where that would be
/// guessing: with fewer cores than threads, or where other ranks of this machine may use the same
/// cores.
///
/// A scheduler may well leave two threads on one core and the other idle: they sleep and wake too
/// often for it to notice.
fn choose_cores(allowed: Vec<usize>, threads: usize, ranks_here: usize) -> Option<Vec<usize>> {
    let alone = ranks_here <= 1 && allowed.len() >= threads;
    let bound = allowed.len() == threads;
    (alone || bound).then_some(allowed)
}

/// Ranks that the launcher has started on this machine; 1 without a launcher.
fn ranks_here() -> usize {
    ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"]
        .iter()
        .find_map(|name| std::env::var(name).ok()?.parse().ok())
        .unwrap_or(1)
}

fn stay_on(core: usize) {
    let mut set = CpuSet::new();
    // where the system refuses, threads run as it likes
    if set.set(core).is_ok() {
        let _ = sched_setaffinity(Pid::from_raw(0), &set);
    }
}

/// A pool of `threads` threads, the calling one among them: it works instead of waiting for
/// others to wake. A thread can belong to one such pool in its life; for a later run it stands
/// beside.
pub fn make_pool(threads: usize) -> ThreadPool {
    let builder = || ThreadPoolBuilder::new().num_threads(threads);
    let cores = choose_cores(allowed_cores(), threads, ranks_here());
    let places = cores.clone();
    let with_this = builder().use_current_thread().start_handler(move |thread| {
        if let Some(cores) = &places {
            stay_on(cores[thread]);
        }
    });
    match with_this.build() {
        Ok(pool) => {
            if let Some(cores) = &cores {
                stay_on(cores[0]);
            }
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
        assert_eq!(choose_cores(vec![2, 3], 2, 1), Some(vec![2, 3]));
        assert_eq!(choose_cores(vec![0, 1, 2, 3], 2, 1), Some(vec![0, 1, 2, 3]));
        assert_eq!(choose_cores(vec![0, 1], 3, 1), None, "too few");
        assert_eq!(choose_cores(vec![0, 1, 2, 3], 2, 2), None, "not bound");
        assert_eq!(choose_cores(vec![4, 5], 2, 8), Some(vec![4, 5]), "bound by the launcher");
    }
}
