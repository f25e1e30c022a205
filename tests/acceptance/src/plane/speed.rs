//! Particle-steps a second on one core, and what a second rank gains.

use flyer_mpm::study::scaling::statistics::median;

use crate::bounds::plane as bounds;
use crate::runs::Job;
use crate::table::Table;

/// Runs of each kind.
const ROUNDS: usize = 5;

/// No option beyond the textbook's.
const PLAIN: [&str; 7] = [
    "method.transfer=flip",
    "method.stepping=leapfrog",
    "method.energy=textbook",
    "method.filter_heat=false",
    "method.pressure_relaxation=null",
    "method.edge_mask=null",
    "artificial_viscosity={\"linear\": 0.2, \"quadratic\": 2}",
];

fn job() -> Job {
    Job::new("flyer_2d")
        // hat functions at points tear the flyer's rear apart at 1.9e-8 s
        .set("time.end=1.5e-8")
        .set("output.profiles.times=[1.5e-8]")
        .set("decomposition.skip_quiescent=false")
}

/// The schemes of the table, each with four particles a cell.
pub fn check(table: &mut Table) {
    let plain = |shape: &str| {
        let job = PLAIN.iter().fold(job(), |job, set| job.set(*set));
        job.set(format!("method.shape={shape}")).set("domain.patches=[1, 1]")
    };
    let linear = plain("linear").set("method.domain_limit=null");
    let kinds = [
        ("linear FLIP", linear, bounds::speed::LINEAR_FLIP),
        ("CPDI FLIP", plain("cpdi"), bounds::speed::CPDI_FLIP),
        (
            "CPDI on quadratics, FMPM(4), exact energy",
            job().set("method.pressure_relaxation=null").set("domain.patches=[1, 1]"),
            bounds::speed::CPDI_QUADRATIC,
        ),
        ("flyer_2d.json as it is", job().set("domain.patches=[1, 1]"), bounds::speed::FLYER_2D),
    ];
    for (name, job, bound) in kinds {
        let speeds =
            (0..ROUNDS).map(|_| job.run().map(|r| r.summary.particle_steps_per_cpu_second));
        let Some(speed) = table.take(name, speeds.collect::<Result<Vec<_>, _>>().map(median))
        else {
            continue;
        };
        let name = format!("{name}: particle-steps per CPU second");
        table.check(&name, speed, bound);
    }
    two_ranks(table);
}

/// Two ranks with 200 000 particles against one, and against two runs of half of them that share
/// nothing but the machine.
fn two_ranks(table: &mut Table) {
    let large = || {
        let job = job().set("time.end=3e-8").set("output.profiles.times=[3e-8]");
        job.set("domain.cell_size=1.6e-5")
    };
    let half = |core| {
        let job = large().set("domain.upper=[0.0048, 0.001792]");
        let job = job.set("bodies.flyer.box.upper=[0, 0.00075]");
        job.set("bodies.target.box.upper=[0.004, 0.0015]").on_core(core)
    };
    let (mut gains, mut shares) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let on_ranks = |ranks| wall(&large().ranks(ranks).on_own_cores());
        let halves = || {
            std::thread::scope(|scope| {
                let other = scope.spawn(|| wall(&half(1)));
                let own = wall(&half(0));
                let other = other.join().map_err(|_| "a thread has ended".to_string())?;
                Ok::<_, String>(own?.max(other?))
            })
        };
        let walls = on_ranks(1).and_then(|one| Ok([one, on_ranks(2)?, halves()?]));
        let Some([one, two, halves]) = table.take("200 000 particles", walls) else { return };
        gains.push(one / two);
        shares.push(halves / two);
    }
    table.either(
        "200 000 particles, 2 ranks: to 1 rank, to 2 runs",
        [(median(gains), bounds::speed::TWO_RANKS), (median(shares), bounds::speed::TWO_RUNS)],
    );
}

/// Wall time of the time loop [s].
fn wall(job: &Job) -> Result<f64, String> {
    job.run().map(|run| run.summary.loop_wall_seconds)
}
