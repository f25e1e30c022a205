//! Checks whether the exact solution of a scene is valid for its bodies.

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use super::common::find_body;
use super::plane_reference;
use crate::material::{IdealGasParameters, MieGruneisenParameters};
use crate::scene::CheckedScene;
use crate::scene::{Burn, Eos, FlyerImpact, Reference, Riemann, Side, WallImpact};

pub(super) fn check(checked: &mut CheckedScene) -> Result<(), Faults> {
    match checked.scene.reference.clone() {
        Some(Reference::FlyerImpact(impact)) => check_flyer_impact(checked, &impact),
        Some(Reference::Riemann(riemann)) => check_riemann(checked, &riemann),
        other => Ok(check_one_body(checked, other)?),
    }
}

/// Checks an exact solution for one body.
fn check_one_body(checked: &CheckedScene, reference: Option<Reference>) -> Result<(), SceneFault> {
    match reference {
        None | Some(Reference::FlyerImpact(_) | Reference::Riemann(_)) => Ok(()),
        Some(Reference::WallImpact(impact)) => check_wall_impact(checked, &impact),
        Some(Reference::SimpleWave(named)) => check_simple_wave(checked, &named.body),
        Some(Reference::Vortex(named)) => plane_reference::check_vortex(checked, &named),
        Some(Reference::Rotation(named)) => plane_reference::check_rotation(checked, &named),
        Some(Reference::ShearLayer(named)) => plane_reference::check_shear_layer(checked, &named),
        Some(Reference::Gresho(named)) => plane_reference::check_gresho(checked, &named),
        Some(Reference::Noh(named)) => plane_reference::check_noh(checked, &named),
    }
}

fn check_flyer_impact(checked: &mut CheckedScene, impact: &FlyerImpact) -> Result<(), Faults> {
    const FLYER: &str = "reference.flyer_impact.flyer";
    const TARGET: &str = "reference.flyer_impact.target";
    super::front::check(checked, "reference.flyer_impact")?;
    let flyer = find_even_body(checked, FLYER, &impact.flyer)?;
    let target = find_even_body(checked, TARGET, &impact.target)?;
    check_unlike(TARGET, &impact.target, FLYER, flyer == target)?;
    let mut faults = Faults::default();
    for (path, i) in [(FLYER, flyer), (TARGET, target)] {
        if faults.take(check_eos(checked, path, i, "mie_gruneisen")).is_some() {
            faults.take(check_straight(checked, path, i));
        }
    }
    faults.ok_or_faults(())?;
    // with contact nothing happens before a gap has closed
    let apart = checked.velocity_fields() > 1;
    let from_below = check_touch(checked, [FLYER, TARGET], [flyer, target], apart)?;
    let speed = checked.speed_along(flyer) - checked.speed_along(target);
    let closing = if from_below { speed } else { -speed };
    if closing <= 0.0 {
        let key = join(&join("bodies", &impact.flyer), "velocity");
        let sign = if from_below { "above" } else { "below" };
        let target_velocity = checked.speed_along(target);
        let reason = format!(
            "does not approach {TARGET} = \"{}\"; allowed: {sign} {target_velocity}, the target's \
             velocity",
            impact.target
        );
        return Err(SceneFault::new(key, &checked.bodies[flyer].velocity, reason).into());
    }
    warn_of_flyer(checked, flyer, target, from_below);
    Ok(())
}

/// Warns of settings with which the run deviates from its exact solution.
fn warn_of_flyer(checked: &mut CheckedScene, flyer: usize, target: usize, from_below: bool) {
    let impedance = |i: usize| match checked.material_of(i).eos {
        Eos::MieGruneisen(MieGruneisenParameters { c0, .. }) => checked.material_of(i).density * c0,
        _ => 0.0,
    };
    let mut warnings = Vec::new();
    if impedance(flyer) < impedance(target) && checked.velocity_fields() == 1 {
        warnings.push(
            "reference.flyer_impact: the flyer is softer than the target and would separate; \
             without contact the run holds them together"
                .to_string(),
        );
    }
    if checked.front().is_some_and(|front| front.angle != 0.0) {
        checked.warnings.extend(warnings);
        return;
    }
    let rear = &checked.bodies[flyer];
    let tolerance = checked.tolerance(0);
    let rear_at = if from_below { rear.lower[0] } else { rear.upper[0] };
    let at_wall = |i: usize| {
        let domain = &checked.scene.domain;
        let end = if from_below { domain.lower[0] } else { domain.upper[0] };
        let [[lower, upper], _] = checked.sides::<2>();
        let side = if from_below { lower } else { upper };
        let beside = checked.bodies.iter().enumerate().any(|(j, body)| {
            let near = if from_below { body.upper[0] } else { body.lower[0] };
            j != i && (near - rear_at).abs() <= tolerance
        });
        beside || ((rear_at - end).abs() <= tolerance && side != Side::default())
    };
    if at_wall(flyer) {
        warnings.push(
            "reference.flyer_impact: the flyer's rear touches another body or a side of the \
             domain; the exact solution takes it as free"
                .to_string(),
        );
    }
    checked.warnings.extend(warnings);
}

fn check_riemann(checked: &CheckedScene, riemann: &Riemann) -> Result<(), Faults> {
    const LEFT: &str = "reference.riemann.left";
    const RIGHT: &str = "reference.riemann.right";
    super::front::check(checked, "reference.riemann")?;
    let left = find_even_body(checked, LEFT, &riemann.left)?;
    let right = find_even_body(checked, RIGHT, &riemann.right)?;
    check_unlike(RIGHT, &riemann.right, LEFT, left == right)?;
    let mut escape = 0.0;
    let mut faults = Faults::default();
    for (path, i) in [(LEFT, left), (RIGHT, right)] {
        if faults.take(check_eos(checked, path, i, "ideal_gas")).is_none() {
            continue;
        }
        let (body, material) = (&checked.scene.bodies[i], checked.material_of(i));
        if body.pressure <= 0.0 {
            let key = join(&join("bodies", &body.name), "pressure");
            let reason = format!("the exact solution of {path} needs pressure; allowed: above 0");
            faults.add(SceneFault::new(key, body.pressure, reason));
        }
        if let Eos::IdealGas(IdealGasParameters { gamma }) = material.eos {
            escape += 2.0 * (gamma * body.pressure / material.density).sqrt() / (gamma - 1.0);
        }
    }
    faults.ok_or_faults(())?;
    // at an angle the front gives the position of the diaphragm
    let slanted = riemann.front.as_ref().is_some_and(|front| front.angle != 0.0);
    if !slanted && !check_touch(checked, [LEFT, RIGHT], [left, right], false)? {
        let reason = format!("lies above {RIGHT} = \"{}\"; allowed: the body below", riemann.right);
        return Err(SceneFault::new(LEFT, &riemann.left, reason).into());
    }
    let apart = checked.speed_along(right) - checked.speed_along(left);
    if apart >= escape {
        let key = join(&join("bodies", &riemann.right), "velocity");
        let reason = format!(
            "leaves {LEFT} at {apart} m/s, so that a vacuum opens, which the exact solution does \
             not have; allowed: less than {escape} m/s apart"
        );
        return Err(SceneFault::new(key, &checked.bodies[right].velocity, reason).into());
    }
    Ok(())
}

fn check_wall_impact(checked: &CheckedScene, impact: &WallImpact) -> Result<(), SceneFault> {
    const BODY: &str = "reference.wall_impact.body";
    let body = find_even_body(checked, BODY, &impact.body)?;
    check_no_strength(checked, BODY, body)?;
    if checked.material_of(body).eos.is_solid() {
        let reason = "an elastic body; allowed: one with an equation of state of a fluid, such as \
             \"mie_gruneisen\" or \"ideal_gas\"";
        return Err(SceneFault::new(BODY, &impact.body, reason));
    }
    if matches!(checked.material_of(body).eos.burn(), Some(Burn::Front(_))) {
        let reason = "an explosive that burns, which has no steady shock; allowed: another body, or \
                      eos.burn \"complete\"";
        return Err(SceneFault::new(BODY, &impact.body, reason));
    }
    if checked.wall_struck_by(body).is_some() {
        return check_steady(checked, BODY, body);
    }
    let box_path = join(&join("bodies", &impact.body), "box");
    let reason = format!(
        "{box_path} touches no wall that the body moves into; allowed: a body beside \
         boundary.x_lower or boundary.x_upper \"wall\", \"symmetry\" or {{\"velocity\": v}}, and \
         moving towards it"
    );
    Err(SceneFault::new(BODY, &impact.body, reason))
}

/// Checks that the piston behind a steady shock has a constant velocity.
fn check_steady(checked: &CheckedScene, path: &str, body: usize) -> Result<(), SceneFault> {
    match checked.piston_at(body) {
        Some(piston) if piston.course.changes() => {
            let reason = "is driven by a piston whose velocity changes; allowed: one number for \
                          its velocity, or \"simple_wave\"";
            Err(SceneFault::new(path, &checked.scene.bodies[body].name, reason))
        }
        _ => Ok(()),
    }
}

fn check_simple_wave(checked: &CheckedScene, name: &str) -> Result<(), SceneFault> {
    const BODY: &str = "reference.simple_wave.body";
    let body = find_even_body(checked, BODY, name)?;
    check_eos(checked, BODY, body, "mie_gruneisen")?;
    check_straight(checked, BODY, body)?;
    let fault = |reason: &str| Err(SceneFault::new(BODY, name, reason));
    if checked.dimension > 1 {
        return fault("stands in a plane; allowed: a scene of one dimension");
    }
    let Some(piston) = checked.piston_at(body) else {
        return fault(
            "touches no piston; allowed: a body beside boundary.x_lower or boundary.x_upper \
             {\"velocity\": ...}",
        );
    };
    let (start, own) = (piston.course.at(0.0), checked.bodies[body].velocity[0]);
    if start != own {
        let key = join(&join("bodies", name), "velocity");
        let reason = format!(
            "the piston beside it starts at {start} m/s, which is a shock; allowed: the same"
        );
        return Err(SceneFault::new(key, own, reason));
    }
    Ok(())
}

/// Checks that the Hugoniot of a body is a straight line and its initial pressure zero.
fn check_straight(checked: &CheckedScene, path: &str, i: usize) -> Result<(), SceneFault> {
    let body = &checked.scene.bodies[i];
    let material = checked.material_of(i);
    if material.eos.straight(material.density).is_none() {
        let key = join("materials", &body.material);
        let reason = format!(
            "{key}.eos has s2, gruneisen \"gamma_constant\" or a tension_cutoff, which the exact \
             solution does not have; allowed: to leave them out, or the reference"
        );
        return Err(SceneFault::new(path, &body.name, reason));
    }
    if body.pressure != 0.0 {
        let key = join(&join("bodies", &body.name), "pressure");
        let reason = format!("the exact solution of {path} starts without pressure; allowed: 0");
        return Err(SceneFault::new(key, body.pressure, reason));
    }
    Ok(())
}

/// Index of the body with this name, which must have a uniform velocity.
fn find_even_body(checked: &CheckedScene, path: &str, name: &str) -> Result<usize, SceneFault> {
    let body = find_body(checked, path, name)?;
    if checked.bodies[body].motion.is_none() {
        return Ok(body);
    }
    let key = join(&join("bodies", name), "velocity_field");
    let reason = format!("starts with {key}; allowed: a body with one velocity");
    Err(SceneFault::new(path, name, reason))
}

fn check_unlike(path: &str, name: &str, other: &str, same: bool) -> Result<(), SceneFault> {
    if !same {
        return Ok(());
    }
    Err(SceneFault::new(path, name, format!("the same body as {other}; allowed: two bodies")))
}

/// Checks that a body has no strength, which the exact solutions of fluids exclude.
fn check_no_strength(checked: &CheckedScene, path: &str, i: usize) -> Result<(), SceneFault> {
    let body = &checked.scene.bodies[i];
    if checked.material_of(i).strength.is_none() {
        return Ok(());
    }
    let key = join(&join("materials", &body.material), "strength");
    let reason = format!(
        "{key} is not in this exact solution, which is that of fluids; allowed: a body without it"
    );
    Err(SceneFault::new(path, &body.name, reason))
}

fn check_eos(checked: &CheckedScene, path: &str, i: usize, wanted: &str) -> Result<(), SceneFault> {
    check_no_strength(checked, path, i)?;
    let eos = serde_json::json!(checked.material_of(i).eos);
    let body = &checked.scene.bodies[i];
    if eos["type"] == wanted {
        return Ok(());
    }
    let key = join("materials", &body.material);
    let reason =
        format!("{key}.eos.type = {}; allowed: a body whose eos is \"{wanted}\"", eos["type"]);
    Err(SceneFault::new(path, &body.name, reason))
}

/// Whether the first body is below the second; they must touch along x, unless they may be `apart`.
fn check_touch(
    checked: &CheckedScene,
    [path, other_path]: [&str; 2],
    [a, b]: [usize; 2],
    apart: bool,
) -> Result<bool, SceneFault> {
    let spans = [(path, a), (other_path, b)].map(|(path, i)| {
        checked.span(i).ok_or_else(|| {
            let reason = "no box turned by the angle of this reference's front about its point; \
                          allowed: \"rotation\" of a \"box\" by that angle about that point";
            SceneFault::new(path, &checked.scene.bodies[i].name, reason)
        })
    });
    let [first, second] = spans;
    let ([first_lower, first_upper], [second_lower, second_upper]) = (first?, second?);
    let tolerance = checked.tolerance(0);
    let above = second_lower - first_upper;
    let below = first_lower - second_upper;
    if above.abs() <= tolerance || below.abs() <= tolerance {
        return Ok(above.abs() <= tolerance);
    }
    if apart {
        return Ok(above > below);
    }
    let names = [a, b].map(|i| checked.scene.bodies[i].name.as_str());
    let reason = format!(
        "a gap of {:e} m to {other_path} = \"{}\" is not supported by this reference; allowed: \
         bodies whose boxes touch",
        above.max(below),
        names[1]
    );
    Err(SceneFault::new(path, names[0], reason))
}
