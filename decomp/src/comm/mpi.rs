//! Ranks over MPI. No other file depends on MPI.

use std::cell::RefCell;
use std::time::Duration;

use mpi::collective::SystemOperation;
use mpi::environment::Universe;
use mpi::point_to_point::{Destination, Source};
use mpi::request::{Request, Scope};
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::traits::{CommunicatorCollectives, Equivalence};
use smallvec::SmallVec;

use super::life::{HeartbeatFiles, Life, STALLED};
use super::watch::{Awaited, Control, StallWatch};
use super::{Comm, STALL_TIMEOUT, Traffic};

/// Number of messages that an exchange sends without a heap allocation.
const INLINE: usize = 16;

/// The ranks that a launcher such as `mpirun` has started.
///
/// Dropping it is collective: all ranks wait for each other and then finalize MPI.
pub struct Mpi {
    world: SimpleCommunicator,
    watch: StallWatch<MpiChannel>,
    /// Buffers for this rank's part of a reduction.
    floats: RefCell<Vec<f64>>,
    integers: RefCell<Vec<i64>>,
    // finalizes MPI when dropped, after everything above
    _universe: Universe,
    // dropped last, because a rank may be stopped while MPI is finalized
    life: Option<Life>,
}

impl Mpi {
    /// Whether a launcher has started this process. Without one, starting MPI would cost half a
    /// second for no benefit.
    pub fn is_launched() -> bool {
        ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"]
            .iter()
            .any(|name| std::env::var_os(name).is_some())
    }

    /// Starts MPI; `None` if it was started before. Collective.
    ///
    /// After this call, a panic on one rank ends all ranks. Otherwise MPI's finalization would
    /// leave the other ranks waiting forever.
    pub fn start() -> Option<Self> {
        Self::start_within(STALL_TIMEOUT)
    }

    /// As `start`, with a timeout. If a rank of this machine gives no sign of life for `timeout`
    /// while MPI starts or ends, it is named and the run ends. The timeout also serves as that of
    /// [`Comm::set_stall_timeout`].
    pub fn start_within(timeout: Duration) -> Option<Self> {
        let life = place().and_then(|place| Life::start(place, timeout));
        let (mut universe, _) = mpi::initialize_with_threading(mpi::Threading::Funneled)?;
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            report(info);
            SimpleCommunicator::world().abort(101)
        }));
        let world = universe.world();
        // room for many questions to and answers from every rank
        universe.set_buffer_size((64 + world.size() as usize) << 10);
        let watch = StallWatch::new(MpiChannel(world.duplicate()));
        watch.set_timeout(timeout);
        if let Some(life) = &life {
            life.runs();
        }
        Some(Mpi {
            world,
            watch,
            floats: RefCell::default(),
            integers: RefCell::default(),
            _universe: universe,
            life,
        })
    }

    fn wait_request<'a, D: ?Sized, S: Scope<'a>>(
        &self,
        awaited: Awaited,
        request: Request<'a, D, S>,
    ) {
        let mut pending = Some(request);
        self.watch.wait(awaited, || match pending.take().map(Request::test) {
            Some(Err(again)) => {
                pending = Some(again);
                false
            }
            _ => true,
        });
    }

    /// Receives one message. Its transfer may still take time after the message has been announced.
    fn receive(&self, source: usize, words: &mut Vec<u64>) {
        let process = self.world.process_at_rank(source as i32);
        let mut found = None;
        self.watch.wait(Awaited::Rank(source), || {
            found = process.immediate_matched_probe();
            found.is_some()
        });
        let (message, status) = found.expect("the wait ends with a message");
        words.clear();
        words.resize(status.count(u64::equivalent_datatype()) as usize, 0);
        mpi::request::scope(|scope| {
            let request = message.immediate_matched_receive_into(scope, &mut words[..]);
            self.wait_request(Awaited::Rank(source), request);
        });
    }

    fn reduce<T: Equivalence + Copy>(
        &self,
        values: &mut [T],
        mine: &RefCell<Vec<T>>,
        op: SystemOperation,
    ) {
        self.watch.count_reduction();
        let mut mine = mine.borrow_mut();
        mine.clear();
        mine.extend_from_slice(values);
        mpi::request::scope(|scope| {
            let request = self.world.immediate_all_reduce_into(scope, &mine[..], values, op);
            self.watch.heartbeat();
            self.wait_request(Awaited::All, request);
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
        self.watch.count_sends(sends);
        mpi::request::scope(|scope| {
            let requests: SmallVec<[_; INLINE]> = sends
                .iter()
                .map(|(to, words)| {
                    let process = self.world.process_at_rank(*to as i32);
                    (*to, process.immediate_send(scope, *words))
                })
                .collect();
            self.watch.heartbeat();
            meanwhile();
            for (source, words) in from.iter().zip(received.iter_mut()) {
                self.receive(*source, words);
            }
            self.watch.count_received(received);
            for (to, request) in requests {
                self.wait_request(Awaited::Rank(to), request);
            }
        });
    }

    fn min(&self, values: &mut [f64]) {
        self.reduce(values, &self.floats, SystemOperation::min());
    }

    fn sum(&self, values: &mut [i64]) {
        self.reduce(values, &self.integers, SystemOperation::sum());
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

    fn abort(&self, code: i32) -> ! {
        self.world.abort(code)
    }
}

impl Drop for Mpi {
    fn drop(&mut self) {
        // MPI's finalization would wait forever for a rank that hangs. Two barriers, because a rank
        // may have been stopped after it joined the first one
        for _ in 0..2 {
            self.wait_request(Awaited::All, self.world.immediate_barrier());
        }
        if let Some(life) = &self.life {
            life.ends();
        }
    }
}

/// Files for the signs of life of the ranks of this machine. They are in the folder that the
/// launcher creates for the run and removes after it, or in the system's temporary folder. `None`
/// if the launcher does not number the ranks of a machine.
fn place() -> Option<HeartbeatFiles> {
    let text = |name: &str| std::env::var(name).ok();
    let number = |name: &str| text(name)?.parse::<usize>().ok();
    let local = [number("OMPI_COMM_WORLD_LOCAL_RANK")?, number("OMPI_COMM_WORLD_LOCAL_SIZE")?];
    let rank = [number("OMPI_COMM_WORLD_RANK")?, number("OMPI_COMM_WORLD_SIZE")?];
    let job = text("PMIX_NAMESPACE").or_else(|| text("OMPI_MCA_ess_base_jobid"))?;
    // the job becomes part of a file name
    let job = job.chars().filter(char::is_ascii_alphanumeric).collect();
    let folder = text("PMIX_SERVER_TMPDIR").map_or_else(std::env::temp_dir, Into::into);
    (local[0] < local[1] && rank[0] < rank[1]).then_some(HeartbeatFiles {
        folder,
        job,
        local,
        rank,
    })
}

/// Questions and answers, on a separate communicator.
struct MpiChannel(SimpleCommunicator);

impl Control for MpiChannel {
    fn rank(&self) -> usize {
        self.0.rank() as usize
    }

    fn size(&self) -> usize {
        self.0.size() as usize
    }

    fn send(&self, to: usize, words: &[u64]) {
        self.0.process_at_rank(to as i32).buffered_send(words);
    }

    fn receive(&self, words: &mut Vec<u64>) -> Option<usize> {
        let (message, status) = self.0.any_process().immediate_matched_probe()?;
        words.clear();
        words.resize(status.count(u64::equivalent_datatype()) as usize, 0);
        message.matched_receive_into(&mut words[..]);
        Some(status.source_rank() as usize)
    }

    fn end(&self, why: &str) -> ! {
        eprintln!("error: {why}");
        self.0.abort(STALLED)
    }
}
