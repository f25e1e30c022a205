//! Ranks x threads, how they are bound to cores, and in which order they take their turns.

/// Ranks and the threads of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
}

impl Configuration {
    /// What every other configuration is held against.
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

/// How mpirun places the ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A core each rank.
    Core,
    /// A core each thread.
    Cores(usize),
    /// Anywhere.
    None,
    /// More workers than cores: those that wait give way to those that work.
    Oversubscribed,
}

impl Binding {
    /// The binding wished for on a machine of so many cores.
    pub fn of(configuration: Configuration, cores: usize) -> Binding {
        match configuration.threads {
            _ if configuration.workers() > cores => Binding::Oversubscribed,
            1 => Binding::Core,
            threads => Binding::Cores(threads),
        }
    }

    /// Options of mpirun.
    pub fn options(self) -> Vec<String> {
        let line = match self {
            Binding::Core => "--bind-to core".into(),
            Binding::Cores(threads) => format!("--map-by slot:PE={threads} --bind-to core"),
            Binding::None => "--oversubscribe --bind-to none".into(),
            Binding::Oversubscribed => {
                "--oversubscribe --bind-to none --mca mpi_yield_when_idle 1".to_string()
            }
        };
        line.split(' ').map(String::from).collect()
    }

    /// A word for the table.
    pub fn name(self) -> &'static str {
        match self {
            Binding::Core | Binding::Cores(_) => "core",
            Binding::None => "none",
            Binding::Oversubscribed => "oversubscribed",
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
        let binding = |ranks, threads| Binding::of(Configuration { ranks, threads }, 4);
        assert_eq!(binding(4, 1), Binding::Core);
        assert_eq!(binding(2, 2), Binding::Cores(2));
        assert_eq!(binding(3, 2), Binding::Oversubscribed);
        assert_eq!(Binding::Cores(2).options(), ["--map-by", "slot:PE=2", "--bind-to", "core"]);
    }
}
