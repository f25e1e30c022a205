//! What one core can do at most: bytes from memory and floating-point operations per second
//! (Williams, Waterman & Patterson 2009, Roofline).

use std::hint::black_box;
use std::time::Instant;

/// Runs of which the fastest counts.
const ROUNDS: usize = 7;

/// Numbers in each array of the triad: far more than the caches hold.
const LENGTH: usize = 1 << 23;

/// Independent sums, so that none waits for another.
const CHAINS: usize = 32;

/// Work per particle and step that a scheme cannot do without.
pub struct Least {
    /// Bytes read or written.
    pub bytes: f64,
    /// Floating-point operations.
    pub operations: f64,
}

/// Limits of one core.
pub struct Machine {
    /// Bytes per second of a = b + s c from and to memory.
    pub bytes: f64,
    /// Multiplications and additions per second.
    pub operations: f64,
}

impl Machine {
    /// Measures this machine.
    pub fn measure() -> Machine {
        Machine { bytes: triad(), operations: multiply_and_add() }
    }

    /// Most particle-steps per second.
    pub fn roof(&self, least: &Least) -> f64 {
        (self.bytes / least.bytes).min(self.operations / least.operations)
    }
}

/// Bytes per second of a = b + s c, as STREAM counts them (McCalpin 1995).
fn triad() -> f64 {
    let mut a = vec![0.0; LENGTH];
    let (b, c) = (vec![1.0; LENGTH], vec![2.0; LENGTH]);
    let seconds = fastest(|| {
        let scale = black_box(3.0);
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + scale * c;
        }
        black_box(&mut a);
    });
    (3 * LENGTH * size_of::<f64>()) as f64 / seconds
}

fn multiply_and_add() -> f64 {
    const TIMES: usize = 4_000_000;
    let seconds = fastest(|| {
        let (mut sums, scale, term) = ([1.0; CHAINS], black_box(0.5), black_box(1.0));
        for _ in 0..TIMES {
            sums.iter_mut().for_each(|sum| *sum = *sum * scale + term);
        }
        black_box(sums);
    });
    (2 * CHAINS * TIMES) as f64 / seconds
}

/// Shortest time of a call \[s\].
fn fastest(mut call: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        call();
        start.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_roof_is_the_lower_limit() {
        let machine = Machine { bytes: 20e9, operations: 60e9 };
        assert_eq!(machine.roof(&Least { bytes: 200.0, operations: 100.0 }), 100e6);
        assert_eq!(machine.roof(&Least { bytes: 200.0, operations: 6000.0 }), 10e6);
    }
}
