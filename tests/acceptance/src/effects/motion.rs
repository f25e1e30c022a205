//! Smooth waves against their exact solution, and conservation for bodies that fall and voids that close.

use crate::bounds::{Unit, effects as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Viscosity as the other scenes have it.
const VISCOSITY: &str = "artificial_viscosity={\"linear\":0.1,\"quadratic\":1.25,\
                         \"limiter\":\"christensen\",\"limited\":\"linear\"}";

/// Orders of the simple wave's error from one cell to the next, at its last profile.
pub fn wave(figures: &mut Table) {
    let cpdi: &[&str] =
        &["method.shape=cpdi", "method.pressure_relaxation={\"rate\":0.3,\"interval\":1}"];
    for (what, sets) in [
        ("cpdi_bspline_quadratic", &[][..]),
        ("the same with limited viscosity", &[VISCOSITY]),
        ("cpdi", cpdi),
        ("the same with limited viscosity", &[cpdi[0], cpdi[1], VISCOSITY]),
    ] {
        let error = |cell: &str| {
            let job = Job::new("simple_wave").set(format!("domain.cell_size={cell}"));
            let run = sets.iter().fold(job, |job, set| job.set(*set)).run()?;
            Ok((run.summary.profiles.last().and_then(|p| p.error("l2")), run.summary.energy.drift))
        };
        let cells = ["4e-5", "2e-5", "1e-5"];
        let runs: Result<Vec<_>, String> = cells.iter().map(|cell| error(cell)).collect();
        let Some(runs) = figures.take(what, runs) else { continue };
        for pair in 0..2 {
            let order = runs[pair].0.zip(runs[pair + 1].0).map(|(a, b)| (a / b).log2());
            let cells = format!("{what}: order of L2, {} to {} um", 40 >> pair, 20 >> pair);
            figures.check(&cells, order, bounds::wave::ORDER);
        }
        figures.beside("its L2 at 10 um", runs[2].0, "", Unit::Fraction);
        figures.check(
            "its energy, with the work of the piston",
            runs[2].1,
            bounds::wave::ENERGY_DRIFT,
        );
    }
}

/// Momentum and energy in free fall, of plates while the voids between them close, and while they
/// erode.
pub fn conservation(figures: &mut Table) {
    let fall = Job::new("simple_wave")
        .set("boundary=null")
        .set("reference=null")
        .set("domain.lower=[-2e-4]")
        .set("bodies.slab.velocity=[100]")
        .set("body_force={\"gravity\":[-2e8]}");
    let erode = Job::new("flyer_strength")
        .set("materials.copper.erosion={\"plastic_strain\":0.05}")
        .set("materials.aluminium.erosion={\"plastic_strain\":0.05}");
    let jobs = [
        ("free fall, -2e8 m/s2 over 0.6 us", fall),
        ("`gap.json`, a void that closes", Job::new("gap")),
        ("`three_plates.json`, voids that close", Job::new("three_plates")),
        ("`flyer_strength.json`, eroded at 5 %", erode),
    ];
    for (what, job) in jobs {
        let Some(run) = figures.take(what, job.run()) else { continue };
        let summary = &run.summary;
        figures.check(
            &format!("{what}: momentum"),
            summary.momentum.drift,
            bounds::conservation::MOMENTUM_DRIFT,
        );
        figures.check(
            &format!("{what}: energy"),
            summary.energy.drift,
            bounds::conservation::ENERGY_DRIFT,
        );
        if let Some(gone) = &summary.erosion {
            let gone = Some(gone.particles as f64);
            figures.check(
                &format!("{what}: particles"),
                gone,
                bounds::conservation::ERODED_PARTICLES,
            );
        }
    }
}
