//! Other metals and speeds under the settings of `inputs/flyer.json`.

use flyer_mpm::exact::{Accuracy, Impact, ImpactBody, Landmarks};
use flyer_mpm::material::MieGruneisen;

use crate::bounds::flyer as bounds;
use crate::runs::Job;
use crate::table::Table;

/// A metal: name, density \[kg/m3\], c0 \[m/s\], s \[-\], gamma0 \[-\], by
/// the handbooks.
type Metal = (&'static str, f64, f64, f64, f64);

const COPPER: Metal = ("copper", 8930.0, 3940.0, 1.489, 1.96);
const ALUMINIUM: Metal = ("aluminium", 2785.0, 5386.0, 1.339, 2.1);
const TANTALUM: Metal = ("tantalum", 16650.0, 3410.0, 1.20, 1.67);
const TUNGSTEN: Metal = ("tungsten", 19220.0, 4030.0, 1.237, 1.67);
const IRON: Metal = ("iron", 7850.0, 3574.0, 1.920, 1.69);
const NICKEL: Metal = ("nickel", 8874.0, 4602.0, 1.437, 1.93);

/// Flyer, target and speed [m/s]; no flyer is softer than its target.
const IMPACTS: [(Metal, Metal, f64); 10] = [
    (COPPER, ALUMINIUM, 300.0),
    (COPPER, ALUMINIUM, 3000.0),
    (COPPER, COPPER, 1500.0),
    (TUNGSTEN, COPPER, 1000.0),
    (TANTALUM, ALUMINIUM, 2000.0),
    (NICKEL, ALUMINIUM, 500.0),
    (NICKEL, IRON, 2500.0),
    (IRON, ALUMINIUM, 1500.0),
    (TUNGSTEN, TANTALUM, 3000.0),
    (ALUMINIUM, ALUMINIUM, 700.0),
];

const THICKNESS: f64 = 0.5e-3;
const TARGET: f64 = 8e-3;
const CELL: f64 = 1e-5;

fn eos(metal: Metal) -> MieGruneisen {
    let (_, rho0, c0, s, gamma0) = metal;
    MieGruneisen { rho0, c0, s, gamma0 }
}

/// What the exact solution says at these times.
pub fn landmarks(
    [flyer, target]: [MieGruneisen; 2],
    speed: f64,
    [thickness, length]: [f64; 2],
    times: &[f64],
) -> Result<Vec<Landmarks>, String> {
    let flyer = ImpactBody { material: flyer, lower: -thickness, upper: 0.0, velocity: speed };
    let target = ImpactBody { material: target, lower: 0.0, upper: length, velocity: 0.0 };
    let impact = Impact::new(flyer, target).map_err(|e| e.to_string())?;
    let solution = impact.solve(times, &[], Accuracy::default()).map_err(|e| e.to_string())?;
    let marks = solution.snapshots.into_iter().map(|s| s.landmarks);
    marks.collect::<Option<_>>().ok_or_else(|| "no exact solution at a time".into())
}

/// Materials of the standard problem, flyer first.
pub fn standard() -> [MieGruneisen; 2] {
    [eos(COPPER), eos(ALUMINIUM)]
}

/// E1, and where it is over 20 cells the plateau, of each impact at two times.
pub fn check(table: &mut Table) {
    for (flyer, target, speed) in IMPACTS {
        let name = format!("{} on {} at {speed} m/s", flyer.0, target.0);
        // The shock is to stay within the target; c0 + s * speed is faster than it.
        let end = (0.9 * TARGET / (target.2 + target.3 * speed)).min(1e-6);
        let times = [0.5 * end, end];
        let exact = landmarks([eos(flyer), eos(target)], speed, [THICKNESS, TARGET], &times);
        let Some(exact) = table.take(&name, exact) else { continue };
        let mut job = Job::new("flyer")
            .set(format!("time.end={end:e}"))
            .set(format!("output.profiles.times=[{:e},{end:e}]", 0.5 * end))
            .set(format!("bodies.flyer.velocity=[{speed}]"));
        for (body, metal) in [("flyer", flyer), ("target", target)] {
            let (material, rho0, c0, s, gamma0) = metal;
            job = job.set(format!("bodies.{body}.material={material}")).set(format!(
                r#"materials.{material}={{"density":{rho0},"eos":{{"type":"mie_gruneisen","c0":{c0},"s":{s},"gamma0":{gamma0}}}}}"#
            ));
        }
        let Some(run) = table.take(&name, job.run()) else { continue };
        for (profile, exact) in run.summary.profiles.iter().zip(exact) {
            let name = format!("{name}, {:.2} us", profile.time * 1e6);
            table.check(
                &format!("{name}: E1, cells"),
                profile.error("e1_cells"),
                bounds::impacts::E1,
            );
            if exact.plateau.is_some_and(|[lower, upper]| upper - lower > 20.0 * CELL) {
                let [plateau, noise] = ["plateau", "noise"].map(|e| profile.error(e));
                table.check(&format!("{name}: plateau"), plateau, bounds::impacts::PLATEAU);
                table.check(&format!("{name}: noise"), noise, bounds::impacts::NOISE);
            }
        }
    }
}

/// The thin flyer whose release catches the shock: peak pressure and E1.
pub fn check_attenuation(table: &mut Table) {
    let Some(run) = table.take("attenuation", Job::new("attenuation").run()) else { return };
    let times: Vec<f64> = run.summary.profiles.iter().map(|p| p.time).collect();
    let exact = landmarks(standard(), 1000.0, [0.25e-3, 9e-3], &times);
    let Some(exact) = table.take("attenuation, exact", exact) else { return };
    let Some(profiles) = table.take("attenuation, files", run.tables()) else { return };
    for ((profile, exact), file) in run.summary.profiles.iter().zip(exact).zip(profiles) {
        let name = format!("attenuation, {:.2} us", profile.time * 1e6);
        let peak = file.numbers("pressure").map(|p| p.iter().fold(f64::MIN, |a, &b| a.max(b)));
        // Before the catch the peak is the plateau, judged elsewhere.
        if profile.time > 0.871290e-6 {
            let error = peak.map(|peak| peak / exact.behind_shock - 1.0);
            table.check(&format!("{name}: peak"), error, bounds::attenuation::PEAK);
        }
        table.check(
            &format!("{name}: E1, cells"),
            profile.error("e1_cells"),
            bounds::attenuation::E1,
        );
    }
}
