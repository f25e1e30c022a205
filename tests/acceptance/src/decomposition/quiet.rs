//! What is left out because nothing has reached it yet.

use crate::bounds::{Bound, Unit, decomposition as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Share of particle-steps left out to the end, by patches; a bound for one of them.
struct Case {
    name: &'static str,
    job: Job,
    /// Number of patches at which the share has a bound.
    bound: Option<(usize, Bound)>,
    /// What an earlier experiment found.
    other: &'static str,
}

/// The shipped scenes to 1 us.
pub fn check(table: &mut Table) {
    let cpdi = Job::new("flyer").set("method.shape=cpdi").set(r#"method.transfer={"fmpm":4}"#);
    let cases = [
        Case {
            name: "flyer.json",
            job: Job::new("flyer"),
            bound: Some((16, bounds::quiet::FLYER)),
            other: "",
        },
        Case { name: "cpdi, FMPM(4)", job: cpdi, bound: None, other: "exact 4 %" },
        Case {
            name: "flyer_uintah.json",
            job: Job::new("flyer_uintah"),
            bound: Some((61, bounds::quiet::FLYER_UINTAH)),
            other: "32 %, 54 %",
        },
    ];
    for Case { name, job, bound, other } in cases {
        for patches in [1, 16, 61] {
            let job = job.clone().set(format!("domain.patches=[{patches}]"));
            let [with, without] = [true, false]
                .map(|skip| job.clone().set(format!("decomposition.skip_quiescent={skip}")).run());
            let name = format!("{name}, {patches} patches: particle-steps left out");
            let (Some(with), Some(without)) = (table.take(&name, with), table.take(&name, without))
            else {
                continue;
            };
            let steps = &with.summary.decomposition;
            let skipped = steps.particle_steps_skipped as f64;
            let share = Some(skipped / (skipped + steps.particle_steps_computed as f64));
            match bound {
                Some((at, bound)) if at == patches => table.check(&name, share, bound),
                _ => table.beside(&name, share, other, Unit::Fraction),
            }
            let [with, without] = [with, without].map(|run| run.summary.loop_wall_seconds);
            let other = format!("{without:.3} s");
            table.beside("  time loop, and with all computed", Some(with), &other, Unit::Seconds);
        }
    }
}
