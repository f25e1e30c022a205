//! Coulomb's law between bodies: in every step, over a run, on an incline, and of a disk that rolls.

use serde_json::{Value, json};

use super::measure::{Measured, run};
use super::scenes::{Material, block, contact, disk, scene};
use crate::bounds::{Unit, contact as bounds};
use crate::table::Table;

/// A block or another region on a base that walls hold, under gravity.
fn on_base(
    region: Value,
    height: f64,
    material: Material,
    friction: f64,
    gravity: [f64; 2],
    speed: f64,
    end: f64,
) -> Value {
    let domain = [[-0.1, -0.04], [0.4, height + 0.04]];
    let base = block([-0.1, -0.04], [0.4, 0.0], 0.0);
    let bodies = [(region, [speed, 0.0]), (base, [0.0; 2])];
    let mut scene = scene(&bodies, domain, material, contact(Some(friction)), end);
    scene["boundary"] = json!({"y_lower": "no_slip", "x_lower": "no_slip", "x_upper": "no_slip"});
    scene["body_force"] = json!({"gravity": gravity});
    scene
}

/// Impulse of friction over that of the normal force, and the greatest distance of their ratio from
/// `friction` in a step with more than a tenth of the `weight` [N/m], relative to it.
fn ratios(found: &Measured, friction: f64, weight: f64) -> (f64, f64) {
    let off = |step: &[f64; 3]| (step[2] / (friction * step[1]) - 1.0).abs();
    let pressed = found.forces.iter().filter(|step| step[1] > 0.1 * weight);
    let worst = pressed.map(off).fold(0.0, f64::max);
    let sum = |k: usize| found.forces.iter().map(|step| step[0] * step[k]).sum::<f64>();
    (sum(2) / (friction * sum(1)) - 1.0, worst)
}

/// A block under gravity, with every transfer.
pub fn check(table: &mut Table) {
    for transfer in
        [json!("pic"), json!("flip"), json!("apic"), json!({"xpic": 2}), json!({"fmpm": 4})]
    {
        let region = block([0.0, 0.0], [0.2, 0.04], 0.0);
        let gravity = [0.0, -10.0];
        let mut scene = on_base(region, 0.04, Material::Rubber, 0.3, gravity, 1.0, 0.06);
        scene["method"] = match transfer.is_object() && transfer["fmpm"].is_number() {
            true => scene["method"].clone(),
            false => json!({
                "shape": "cpdi_bspline_quadratic", "transfer": transfer, "stepping": "midpoint"
            }),
        };
        let name = format!("block, mu 0.3, {transfer}");
        let Some(found) = table.take(&name, run(&scene)) else { continue };
        let (whole, worst) = ratios(&found, 0.3, 80.0);
        let figure = |what: &str| format!("{name}: {what}");
        table.check(&figure("every step, off mu"), Some(worst), bounds::friction::EVERY_STEP);
        table.check(&figure("all impulses, off mu"), Some(whole), bounds::friction::MEAN);
        let normal: f64 = found.forces.iter().map(|step| step[0] * step[1]).sum();
        let lost = found.bodies[0].mass * (1.0 - found.bodies[0].velocity[0]);
        let slowed = Some(lost / (0.3 * normal) - 1.0);
        table.check(&figure("slowing, off mu g"), slowed, bounds::friction::MEAN);
        if scene["method"]["energy"] == "compatible" {
            let drift = Some(found.energy_drift);
            table.check(&figure("energy drift"), drift, bounds::friction::ENERGY_DRIFT);
        }
    }
}

/// A block on inclines that are steeper and less steep than the coefficient of friction, and a disk
/// that rolls.
pub fn incline(table: &mut Table) {
    let slope = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [10.0 * sin, -10.0 * cos]
    };
    for degrees in [20.0f64, 30.0] {
        let gravity = slope(degrees);
        let region = block([0.0, 0.0], [0.1, 0.04], 0.0);
        let scene = on_base(region, 0.04, Material::StiffRubber, 0.5, gravity, 0.0, 0.2);
        let name = format!("block, mu 0.5, {degrees} degrees");
        let Some(found) = table.take(&name, run(&scene)) else { continue };
        let exact = (gravity[0] + 0.5 * gravity[1]).max(0.0);
        let off = found.bodies[0].velocity[0] / 0.2 - exact;
        let (figure, bound, scale) = match exact > 0.0 {
            true => ("acceleration off, of mu g cos", bounds::incline::SLIDES, -0.5 * gravity[1]),
            false => ("acceleration, of g sin", bounds::incline::STICKS, gravity[0]),
        };
        table.check(&format!("{name}: {figure}"), Some(off / scale), bound);
    }
    let gravity = slope(20.0);
    let scene =
        on_base(disk([0.05, 0.1], 0.1, 0.0), 0.2, Material::StiffRubber, 0.5, gravity, 0.0, 0.2);
    if let Some(found) = table.take("disk that rolls", run(&scene)) {
        let exact = 2.0 / 3.0 * gravity[0] * 0.2;
        let off = found.bodies[0].velocity[0] / exact - 1.0;
        table.check("disk that rolls: speed off", Some(off), bounds::incline::ROLLS);
        let (whole, _) = ratios(&found, 0.5, 1.0);
        table.beside("disk that rolls: friction over mu N", Some(1.0 + whole), "", Unit::One);
    }
}
