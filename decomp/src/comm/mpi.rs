//! Ranks over MPI: the only file that names it.

use std::time::{Duration, Instant};

use mpi::collective::SystemOperation;
use mpi::environment::Universe;
use mpi::point_to_point::{Destination, Source};
use mpi::request::{Request, Scope};
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::traits::CommunicatorCollectives;

use super::Comm;

/// How long a rank waits for another before it takes it for lost.
const DEADLINE: Duration = Duration::from_secs(300);

/// The ranks that a launcher such as `mpirun` has started.
pub struct Mpi {
    world: SimpleCommunicator,
    // finalizes MPI when dropped
    _universe: Universe,
}

impl Mpi {
    /// Whether a launcher has started this process. Starting MPI without one costs half a second
    /// and gains nothing.
    pub fn is_launched() -> bool {
        ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"]
            .iter()
            .any(|name| std::env::var_os(name).is_some())
    }

    /// Starts MPI; `None` if it was started before. Collective.
    ///
    /// A panic on one rank must not leave the others waiting for ever, as MPI's own finalizing
    /// would: from here on it ends them all.
    pub fn start() -> Option<Self> {
        let (universe, _) = mpi::initialize_with_threading(mpi::Threading::Funneled)?;
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            report(info);
            SimpleCommunicator::world().abort(101)
        }));
        Some(Mpi { world: universe.world(), _universe: universe })
    }

    /// Waits until `done`, looking again and again; gives way to others after a short while.
    fn wait_until(&self, what: impl Fn() -> String, mut done: impl FnMut() -> bool) {
        let mut start = None;
        for look in 0u64.. {
            if done() {
                return;
            }
            if look > 2000 {
                std::thread::yield_now();
                let waited = start.get_or_insert_with(Instant::now).elapsed();
                if waited > DEADLINE {
                    let (rank, s) = (self.rank(), waited.as_secs());
                    eprintln!(
                        "error: rank {rank} has waited {s} s for {}: it hangs or was lost",
                        what()
                    );
                    self.abort(7);
                }
            }
        }
    }

    fn wait_request<'a, D: ?Sized, S: Scope<'a>>(&self, what: &str, request: Request<'a, D, S>) {
        let mut pending = Some(request);
        self.wait_until(
            || what.to_string(),
            || match pending.take().map(Request::test) {
                Some(Err(again)) => {
                    pending = Some(again);
                    false
                }
                _ => true,
            },
        );
    }

    fn reduce<T: mpi::traits::Equivalence + Copy>(&self, values: &mut [T], op: SystemOperation) {
        let mine = values.to_vec();
        mpi::request::scope(|scope| {
            let request = self.world.immediate_all_reduce_into(scope, &mine[..], values, op);
            self.wait_request("a reduction over all ranks", request);
        });
    }
}

impl Comm for Mpi {
    fn rank(&self) -> usize {
        self.world.rank() as usize
    }

    fn size(&self) -> usize {
        self.world.size() as usize
    }

    fn exchange(
        &self,
        sends: &[(usize, &[u64])],
        from: &[usize],
        received: &mut Vec<Vec<u64>>,
        meanwhile: &mut dyn FnMut(),
    ) {
        received.resize_with(from.len(), Vec::new);
        mpi::request::scope(|scope| {
            let requests: Vec<_> = sends
                .iter()
                .map(|(to, words)| {
                    self.world.process_at_rank(*to as i32).immediate_send(scope, *words)
                })
                .collect();
            meanwhile();
            for (source, words) in from.iter().zip(received.iter_mut()) {
                let process = self.world.process_at_rank(*source as i32);
                let mut found = None;
                self.wait_until(
                    || format!("rank {source}"),
                    || {
                        found = process.immediate_matched_probe();
                        found.is_some()
                    },
                );
                let (message, status) = found.expect("the wait ends with a message");
                let count = status.count(<u64 as mpi::traits::Equivalence>::equivalent_datatype());
                words.clear();
                words.resize(count as usize, 0);
                message.matched_receive_into(&mut words[..]);
            }
            for request in requests {
                self.wait_request("a message to be taken", request);
            }
        });
    }

    fn min(&self, values: &mut [f64]) {
        self.reduce(values, SystemOperation::min());
    }

    fn sum(&self, values: &mut [i64]) {
        self.reduce(values, SystemOperation::sum());
    }

    fn abort(&self, code: i32) -> ! {
        self.world.abort(code)
    }
}
