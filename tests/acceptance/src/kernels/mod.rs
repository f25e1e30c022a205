//! Instructions, memory traffic and speed of the steps of frozen scenes, one per scheme.
//!
//! The scenes in `tests/acceptance/bench` give their method in full, so that a new default does not
//! change them.

mod roofline;

use crate::bounds::{Bound, Unit, kernels as bounds};
use crate::counts;
use crate::runs::Job;
use crate::section::{Section, usual};
use crate::table::Table;
use roofline::{Least, Machine};

/// Subject of the group.
pub const TITLE: &str = "Kernels: instructions, memory traffic and speed of frozen scenes";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 3] =
    [usual("instructions", instructions), usual("memory", memory), usual("speed", speed)];

/// Runs of each scene whose median speed is taken.
const ROUNDS: usize = 5;

/// A frozen scene.
struct Bench {
    scene: &'static str,
    /// Ends of the two runs whose difference is counted \[s\].
    counted: [f64; 2],
    /// End of the run whose speed is measured \[s\].
    timed: f64,
    /// Instructions per particle and step that must not be exceeded, and two numbers aimed at: with
    /// the present order of sums, and with another.
    instructions: Bound,
    aims: &'static str,
    /// Particle-steps per CPU second that must be reached on a core of its own, and those aimed at.
    speed: Bound,
    fast: &'static str,
    /// Bytes and floating-point operations per particle and step that the scheme cannot do without.
    least: Option<Least>,
    memory: Option<Bound>,
}

/// Least work of linear functions and FLIP, of linear CPDI, and of quadratic CPDI with FMPM(4), all
/// in a plane.
const LINEAR: Option<Least> = Some(Least { bytes: 240.0, operations: 150.0 });
const CPDI: Option<Least> = Some(Least { bytes: 360.0, operations: 500.0 });
const FMPM: Option<Least> = Some(Least { bytes: 600.0, operations: 3500.0 });

const BENCHES: [Bench; 11] = [
    Bench {
        scene: "line_cpdi_flip",
        counted: [1.25e-8, 5e-8],
        timed: 1e-6,
        instructions: bounds::instructions::LINE_CPDI_FLIP,
        aims: "260, 200",
        speed: bounds::speed::LINE_CPDI_FLIP,
        fast: "50 M",
        least: None,
        memory: None,
    },
    Bench {
        scene: "line_fmpm",
        counted: [1.25e-8, 5e-8],
        timed: 1e-6,
        instructions: bounds::instructions::LINE_FMPM,
        aims: "700, 470",
        speed: bounds::speed::LINE_FMPM,
        fast: "22 M",
        least: None,
        memory: None,
    },
    Bench {
        scene: "line_default",
        counted: [1.25e-8, 5e-8],
        timed: 1e-6,
        instructions: bounds::instructions::LINE_DEFAULT,
        aims: "-",
        speed: bounds::speed::LINE_DEFAULT,
        fast: "-",
        least: None,
        memory: None,
    },
    Bench {
        scene: "line_limiter",
        counted: [1.25e-8, 5e-8],
        timed: 1e-6,
        instructions: bounds::instructions::LINE_LIMITER,
        aims: "-",
        speed: bounds::speed::LINE_LIMITER,
        fast: "-",
        least: None,
        memory: None,
    },
    Bench {
        scene: "plane_linear_flip",
        counted: [5e-9, 1.5e-8],
        timed: 6e-8,
        instructions: bounds::instructions::PLANE_LINEAR_FLIP,
        aims: "340, 250",
        speed: bounds::speed::PLANE_LINEAR_FLIP,
        fast: "40 M",
        least: LINEAR,
        memory: Some(bounds::memory::PLANE_LINEAR_FLIP),
    },
    Bench {
        scene: "plane_cpdi_flip",
        counted: [5e-9, 1.5e-8],
        timed: 6e-8,
        instructions: bounds::instructions::PLANE_CPDI_FLIP,
        aims: "750, 520",
        speed: bounds::speed::PLANE_CPDI_FLIP,
        fast: "18 M",
        least: CPDI,
        memory: Some(bounds::memory::PLANE_CPDI_FLIP),
    },
    Bench {
        scene: "plane_cpdi_flip_sheared",
        counted: [4e-3, 1.2e-2],
        timed: 0.04,
        instructions: bounds::instructions::PLANE_CPDI_FLIP_SHEARED,
        aims: "900, 680",
        speed: bounds::speed::PLANE_CPDI_FLIP_SHEARED,
        fast: "14 M",
        least: CPDI,
        memory: None,
    },
    Bench {
        scene: "plane_fmpm",
        counted: [1e-8, 5e-8],
        timed: 2.4e-7,
        instructions: bounds::instructions::PLANE_FMPM,
        aims: "2700, 2300",
        speed: bounds::speed::PLANE_FMPM,
        fast: "4.3 M",
        least: FMPM,
        memory: None,
    },
    Bench {
        scene: "plane_fmpm_spin",
        counted: [1e-8, 5e-8],
        timed: 2.4e-7,
        instructions: bounds::instructions::PLANE_FMPM_SPIN,
        aims: "-, 3200",
        speed: bounds::speed::PLANE_FMPM_SPIN,
        fast: "3.0 M",
        least: FMPM,
        memory: None,
    },
    Bench {
        scene: "plane_fmpm_relaxed",
        counted: [2.5e-9, 7.5e-9],
        timed: 2.5e-8,
        instructions: bounds::instructions::PLANE_FMPM_RELAXED,
        aims: "3300, 2600",
        speed: bounds::speed::PLANE_FMPM_RELAXED,
        fast: "2.4 M",
        least: FMPM,
        memory: Some(bounds::memory::PLANE_FMPM_RELAXED),
    },
    Bench {
        scene: "plane_default",
        counted: [5e-9, 1.5e-8],
        timed: 6e-8,
        instructions: bounds::instructions::PLANE_DEFAULT,
        aims: "-",
        speed: bounds::speed::PLANE_DEFAULT,
        fast: "-",
        least: FMPM,
        memory: Some(bounds::memory::PLANE_DEFAULT),
    },
];

/// Instructions per particle and step, beside the bound and the numbers aimed at.
fn instructions(table: &mut Table) {
    if let Err(reason) = counts::can_count() {
        return table.not_measured("instructions", reason);
    }
    for bench in &BENCHES {
        let figure = format!("{}: instructions, aims {}", bench.scene, bench.aims);
        let count = counts::instructions(&Job::bench(bench.scene), bench.counted);
        let Some(count) = table.take(&figure, count) else { continue };
        let most = bench.instructions.number() * (1.0 + bounds::instructions::EXCESS.number());
        table.check(&figure, Some(count), Bound { at_most: Some(most), ..bench.instructions });
    }
}

/// Bytes per particle and step between L2 cache and memory, from a simulated cache.
fn memory(table: &mut Table) {
    if let Err(reason) = counts::can_count() {
        return table.not_measured("memory", reason);
    }
    for (bench, bound) in BENCHES.iter().filter_map(|bench| Some((bench, bench.memory?))) {
        let figure = format!("{}: bytes per particle and step beyond L2", bench.scene);
        let bytes = counts::memory_bytes(&Job::bench(bench.scene), bench.counted);
        let Some(bytes) = table.take(&figure, bytes) else { continue };
        table.check(&figure, Some(bytes), bound);
    }
}

/// Particle-steps per CPU second on one core, and their share of what the machine could do.
fn speed(table: &mut Table) {
    let machine = Machine::measure();
    for (figure, value, unit) in [
        ("triad on one core, per second", machine.bytes, Unit::Bytes),
        ("additions and multiplications on one core, 1e9/s", 1e-9 * machine.operations, Unit::One),
    ] {
        table.beside(figure, Some(value), "", unit);
    }
    for bench in &BENCHES {
        let figure = format!("{}: particle-steps/s, aim {}", bench.scene, bench.fast);
        let run = || counts::until(Job::bench(bench.scene), bench.timed).run();
        let speeds = (0..ROUNDS).map(|_| run().map(|r| r.summary.particle_steps_per_cpu_second));
        let Some(mut speeds) = table.take(&figure, speeds.collect::<Result<Vec<_>, _>>()) else {
            continue;
        };
        speeds.sort_by(f64::total_cmp);
        let speed = speeds[ROUNDS / 2];
        table.check(&figure, Some(speed), bench.speed);
        if let Some(least) = &bench.least {
            let share = speed / machine.roof(least);
            table.beside("  share of the roofline", Some(share), "", Unit::Fraction);
        }
    }
}
