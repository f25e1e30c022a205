//! Options of the scheme that cannot go together, each refused with both keys named.

use serde::Serialize;

use super::super::errors::Fault;
use super::super::model::{
    Contact, EnergyUpdate, FrameKind, LimitedTerms, Method, Normals, Scene, ShapeKind, Stepping,
    StressUpdate, Transfer,
};
use super::super::validate::join;
use super::CheckedScene;

const MIDPOINT: &str = "method.stepping = \"midpoint\"";

pub(super) fn check(scene: &Scene, warnings: &mut Vec<String>) -> Result<(), Fault> {
    let method = &scene.method;
    if method.stepping == Stepping::Midpoint {
        check_midpoint(scene)?;
    } else {
        check_leapfrog(scene)?;
    }
    if let Some(viscosity) = &scene.artificial_viscosity
        && let Some(growth) = viscosity.growth
        && growth.most <= viscosity.quadratic
    {
        let reason = format!(
            "leaves no room to grow from artificial_viscosity.quadratic {}; allowed: a greater number",
            viscosity.quadratic
        );
        return Err(Fault::new("artificial_viscosity.growth.most", growth.most, reason));
    }
    if let Some(viscosity) = &scene.artificial_viscosity
        && viscosity.limited != LimitedTerms::Linear
        && viscosity.limiter.is_none()
    {
        let reason = "says nothing while artificial_viscosity.limiter is left out; allowed: to \
                      leave both out, or artificial_viscosity.limiter \"christensen\" or \"nodal\"";
        return Err(Fault::new("artificial_viscosity.limited", viscosity.limited, reason));
    }
    if let Some(limit) = method.domain_limit {
        let deforms = matches!(method.shape, ShapeKind::Cpdi | ShapeKind::CpdiBsplineQuadratic);
        if !deforms {
            let reason = "has no effect: no particle's domain deforms; allowed: to leave it out, \
                          or method.shape \"cpdi\" or \"cpdi_bspline_quadratic\"";
            return Err(Fault::new("method.domain_limit", limit, reason));
        }
    }
    if let (Some(rate), None) = (method.volume_relaxation, method.edge_mask) {
        let reason = "needs method.edge_mask, which knows what is filled; allowed: to leave it \
                      out, or method.edge_mask";
        return Err(Fault::new("method.volume_relaxation", rate, reason));
    }
    check_contact(scene, warnings)?;
    if method.shape == ShapeKind::Linear {
        warnings.push(
            "method.shape = \"linear\": inaccurate, since forces jump when a particle passes into \
             another cell; allowed all the same"
                .to_string(),
        );
    }
    Ok(())
}

/// What a method says nothing of where no body is a fluid.
pub(super) fn check_bodies(checked: &CheckedScene) -> Result<(), Fault> {
    let fluids = (0..checked.bodies.len()).any(|i| !checked.material_of(i).eos.is_solid());
    let reason = "acts on fluids alone, and every body is elastic; allowed: to leave it out";
    let method = &checked.scene.method;
    match (method.pressure_relaxation, method.volume_relaxation) {
        (Some(relaxation), _) if !fluids => {
            Err(Fault::new("method.pressure_relaxation", relaxation, reason))
        }
        (_, Some(rate)) if !fluids => Err(Fault::new("method.volume_relaxation", rate, reason)),
        _ => Ok(()),
    }
}

/// Most nodes along one direction that a particle touches, on a line and in a plane: those that a
/// step has room for.
const MOST_NODES: [usize; 2] = [18, 10];

/// How much longer a particle may become within a step.
const STRETCH: f64 = 1.25;

/// Length of the longest particle that a step has room for [cells]; none where the shape function
/// does not grow with it.
fn longest_particle(method: &Method, dimension: usize) -> Option<f64> {
    let (nodes, deforms) = match method.shape {
        ShapeKind::Gimp => (2, false),
        ShapeKind::Cpdi => (2, true),
        ShapeKind::CpdiBsplineQuadratic => (3, true),
        ShapeKind::Linear | ShapeKind::BsplineQuadratic | ShapeKind::BsplineCubic => return None,
    };
    let deforms = deforms && method.frame == FrameKind::UpdatedLagrangian;
    let room = (MOST_NODES[dimension - 1] - nodes) as f64;
    Some(if deforms { room / STRETCH } else { room })
}

/// Particles at positions of their own may be longer than a step has room for; those of a lattice are
/// not.
pub(super) fn check_positions(checked: &CheckedScene) -> Result<(), Fault> {
    let method = &checked.scene.method;
    let Some(limit) = longest_particle(method, checked.dimension) else { return Ok(()) };
    for (body, own) in checked.scene.bodies.iter().zip(&checked.bodies) {
        let tiles = own.tiles.iter().flat_map(|tiles| tiles.iter());
        let lengths = tiles.flat_map(|t| t.size.into_iter().zip(&checked.cell_size));
        let longest = lengths.map(|(size, cell)| size / cell).fold(0.0, f64::max);
        if longest > limit {
            let reason = format!(
                "too few: a particle is {longest:.1} cells long; allowed: up to {limit:.1} with \
                 method.shape = {}",
                serde_json::json!(method.shape)
            );
            return Err(Fault::missing(join(&join("bodies", &body.name), "positions"), reason));
        }
    }
    Ok(())
}

/// What a scene's contact cannot do.
fn check_contact(scene: &Scene, warnings: &mut Vec<String>) -> Result<(), Fault> {
    let (rubs, normals) = match scene.contact {
        None => return Ok(()),
        Some(Contact::Stick {}) => (false, Normals::default()),
        Some(Contact::Frictionless { normals }) => (false, normals),
        Some(Contact::Friction { normals, .. }) => (true, normals),
    };
    let on_a_line = scene.domain.lower.len() == 1;
    if on_a_line && normals == Normals::LogisticRegression {
        let reason = "says nothing: on a line every normal is along it; allowed: to leave it out, \
                      or two dimensions";
        return Err(Fault::new("contact.normals", normals, reason));
    }
    if scene.bodies.len() == 1 {
        warnings.push("contact: the scene has one body, which touches no other".to_string());
    } else if on_a_line && rubs {
        warnings.push(
            "contact.type = \"friction\": on a line nothing slides; the same as \"frictionless\""
                .to_string(),
        );
    }
    Ok(())
}

/// A mid-point step has one order of stress, and needs what its options act on.
fn check_midpoint(scene: &Scene) -> Result<(), Fault> {
    let method = &scene.method;
    if method.stress_update != StressUpdate::Last {
        return Err(conflict(
            ("method.stress_update", method.stress_update),
            ("method.stepping", method.stepping),
            "\"last\", or method.stepping = \"leapfrog\"",
        ));
    }
    let transfer = ("method.transfer", method.transfer);
    if method.energy == EnergyUpdate::Compatible && method.transfer == Transfer::Apic {
        let allowed = "\"textbook\", or another method.transfer";
        return Err(conflict(("method.energy", method.energy), transfer, allowed));
    }
    if method.filter_heat && matches!(method.transfer, Transfer::Flip | Transfer::Apic) {
        let allowed = "false, or method.transfer \"pic\", {\"flip_pic\": a}, {\"xpic\": m} or \
                       {\"fmpm\": m}";
        return Err(conflict(("method.filter_heat", true), transfer, allowed));
    }
    match method.edge_mask {
        Some(mask) if !matches!(method.transfer, Transfer::Fmpm(_)) => {
            let allowed = "to leave it out, or method.transfer {\"fmpm\": m}";
            Err(conflict(("method.edge_mask", mask), transfer, allowed))
        }
        _ => Ok(()),
    }
}

/// A leapfrog step has none of the options that are made for the mid-point.
fn check_leapfrog(scene: &Scene) -> Result<(), Fault> {
    let method = &scene.method;
    let stepping = ("method.stepping", method.stepping);
    if method.energy != EnergyUpdate::Textbook {
        let allowed = format!("\"textbook\", or {MIDPOINT}");
        return Err(conflict(("method.energy", method.energy), stepping, &allowed));
    }
    if method.filter_heat {
        let allowed = format!("false, or {MIDPOINT}");
        return Err(conflict(("method.filter_heat", true), stepping, &allowed));
    }
    let allowed = format!("to leave it out, or {MIDPOINT}");
    if let Some(relaxation) = method.pressure_relaxation {
        return Err(conflict(("method.pressure_relaxation", relaxation), stepping, &allowed));
    }
    match method.edge_mask {
        Some(mask) => Err(conflict(("method.edge_mask", mask), stepping, &allowed)),
        None => Ok(()),
    }
}

/// One key that another forbids: their paths and values, and what is allowed for the first.
fn conflict(
    (path, value): (&str, impl Serialize),
    (other_path, other): (&str, impl Serialize),
    allowed: &str,
) -> Fault {
    let other = serde_json::json!(other);
    Fault::new(path, value, format!("cannot go with {other_path} = {other}; allowed: {allowed}"))
}
