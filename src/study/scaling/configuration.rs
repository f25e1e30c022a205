//! Ranks x threads, their binding to cores, and the order of their runs.

/// Ranks and the threads of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
}

impl Configuration {
    /// Configuration with which all others are compared.
    pub const BASE: Configuration = Configuration { ranks: 1, threads: 1 };

    /// Ranks times threads.
    pub fn workers(self) -> usize {
        self.ranks * self.threads
    }
}

/// Every ranks x threads once, the base first, by workers, then threads.
pub fn configurations(ranks: &[usize], threads: &[usize]) -> Vec<Configuration> {
    let pairs = ranks
        .iter()
        .flat_map(|&ranks| threads.iter().map(move |&threads| Configuration { ranks, threads }));
    let mut all: Vec<_> = pairs.chain([Configuration::BASE]).collect();
    all.sort_by_key(|c| (c.workers(), c.threads));
    all.dedup();
    all
}

/// The order of `count` runs in a round: each round starts one later, so that no run always
/// follows the same pause or the end of a round.
pub fn turns(count: usize, round: usize) -> Vec<usize> {
    let mut turns: Vec<usize> = (0..count).collect();
    turns.rotate_left(round % count.max(1));
    turns
}

/// Placement of the ranks by mpirun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RankBinding {
    /// One core per rank.
    Core,
    /// One core per thread.
    Cores(usize),
    /// No binding.
    None,
    /// More workers than cores: ranks that wait yield to those that compute.
    Oversubscribed,
}

impl RankBinding {
    /// The best binding on a machine with `cores` cores.
    pub fn of(configuration: Configuration, cores: usize) -> RankBinding {
        match configuration.threads {
            _ if configuration.workers() > cores => RankBinding::Oversubscribed,
            1 => RankBinding::Core,
            threads => RankBinding::Cores(threads),
        }
    }

    /// Options of mpirun.
    pub fn options(self) -> Vec<String> {
        let line = match self {
            RankBinding::Core => "--bind-to core".into(),
            RankBinding::Cores(threads) => format!("--map-by slot:PE={threads} --bind-to core"),
            RankBinding::None => "--oversubscribe --bind-to none".into(),
            RankBinding::Oversubscribed => {
                "--oversubscribe --bind-to none --mca mpi_yield_when_idle 1".to_string()
            }
        };
        line.split(' ').map(String::from).collect()
    }

    /// Name in the table.
    pub fn name(self) -> &'static str {
        match self {
            RankBinding::Core | RankBinding::Cores(_) => "core",
            RankBinding::None => "none",
            RankBinding::Oversubscribed => "oversubscribed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_base_is_added_once_and_stands_first() {
        let pairs = |ranks, threads| {
            configurations(ranks, threads).iter().map(|c| (c.ranks, c.threads)).collect::<Vec<_>>()
        };
        assert_eq!(pairs(&[4, 2], &[1]), [(1, 1), (2, 1), (4, 1)]);
        assert_eq!(pairs(&[1, 2, 2], &[2, 1]), [(1, 1), (2, 1), (1, 2), (2, 2)]);
    }

    #[test]
    fn each_round_starts_one_later_and_runs_all() {
        assert_eq!(turns(3, 0), [0, 1, 2]);
        assert_eq!(turns(3, 1), [1, 2, 0]);
        assert_eq!(turns(3, 5), [2, 0, 1]);
        assert!(turns(0, 4).is_empty());
    }

    #[test]
    fn threads_get_cores_as_far_as_there_are_any() {
        let binding = |ranks, threads| RankBinding::of(Configuration { ranks, threads }, 4);
        assert_eq!(binding(4, 1), RankBinding::Core);
        assert_eq!(binding(2, 2), RankBinding::Cores(2));
        assert_eq!(binding(3, 2), RankBinding::Oversubscribed);
        assert_eq!(RankBinding::Cores(2).options(), ["--map-by", "slot:PE=2", "--bind-to", "core"]);
    }
}
