//! Time of a run as a function of its cell size, from pilot runs.

use super::pilot::Pilot;

/// Time and number of steps of the runs of a scheme.
#[derive(Clone, Copy, Debug)]
pub struct RunTime {
    cpu: CpuTime,
    /// Wall time over CPU time.
    wall: f64,
    /// Number of steps times the cell size \[m\].
    steps: f64,
}

impl RunTime {
    /// Times on other cells, from two pilot runs.
    pub fn from_two(coarse: &Pilot, fine: &Pilot) -> RunTime {
        let cpu = CpuTime::through(measured(coarse), measured(fine));
        RunTime { cpu, ..RunTime::from_one(fine) }
    }

    /// Times of a run with the cells of this pilot run.
    pub fn from_one(pilot: &Pilot) -> RunTime {
        let (h, seconds) = measured(pilot);
        RunTime {
            cpu: CpuTime { a: seconds * h * h, b: 0.0 },
            wall: (pilot.wall_seconds / seconds).max(1.0),
            steps: pilot.steps as f64 * h,
        }
    }

    /// User CPU time on cells of size `h` \[m\] \[s\].
    pub fn cpu(&self, h: f64) -> f64 {
        self.cpu.at(h)
    }

    /// Wall time \[s\] on cells of size `h` \[m\]. On more than one rank each step takes `extra` \[s\]
    /// longer.
    pub fn wall(&self, h: f64, ranks: usize, extra: f64) -> f64 {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let share = ranks.min(cores).max(1) as f64;
        let messages = if ranks > 1 { extra * self.steps / h } else { 0.0 };
        self.cpu(h) * self.wall / share + messages
    }
}

/// Cell size \[m\] and CPU time \[s\] of a pilot run.
fn measured(pilot: &Pilot) -> (f64, f64) {
    (pilot.cell_size, pilot.cpu_seconds.max(1e-6))
}

/// CPU seconds as a function of the cell size h: a / h^2 + b / h.
#[derive(Clone, Copy, Debug)]
struct CpuTime {
    a: f64,
    b: f64,
}

impl CpuTime {
    /// Time through two pilot runs, with a and b not negative.
    fn through(coarse: (f64, f64), fine: (f64, f64)) -> CpuTime {
        let ((h0, s0), (h1, s1)) = (coarse, fine);
        // s h = a / h + b
        let a = (s1 * h1 - s0 * h0) / (1.0 / h1 - 1.0 / h0);
        let b = s1 * h1 - a / h1;
        match (a > 0.0, b > 0.0) {
            (true, true) => CpuTime { a, b },
            (false, _) => CpuTime { a: 0.0, b: s1 * h1 },
            (_, false) => CpuTime { a: s1 * h1 * h1, b: 0.0 },
        }
    }

    fn at(&self, h: f64) -> f64 {
        self.a / (h * h) + self.b / h
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_go_through_pilots_and_back() {
        let cost = CpuTime { a: 2.0, b: 3.0 };
        let fitted = CpuTime::through((0.5, cost.at(0.5)), (0.25, cost.at(0.25)));
        assert!((fitted.a - 2.0).abs() < 1e-12 && (fitted.b - 3.0).abs() < 1e-12, "{fitted:?}");
        // cheaper on finer cells: noise
        let odd = CpuTime::through((0.5, 4.0), (0.25, 3.0));
        assert!(odd.a >= 0.0 && odd.b >= 0.0 && (odd.at(0.25) - 3.0).abs() < 1e-12);
    }
}
