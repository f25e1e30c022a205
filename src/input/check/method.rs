//! Options of the method that exclude each other, each rejected with both keys named.

use serde::Serialize;

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use crate::scene::CheckedScene;
use crate::scene::{
    EnergyUpdate, FluxLimiter, FrameKind, Geometry, LimitedTerms, Method, Scene, Stepping,
    StressUpdate,
};
use crate::shape::{DomainExtent, most_nodes};

const MIDPOINT: &str = "method.stepping = \"midpoint\"";

pub(super) fn check(scene: &Scene, faults: &mut Faults, warnings: &mut Vec<String>) {
    let step = match scene.method.stepping {
        Stepping::Midpoint => check_midpoint,
        Stepping::Leapfrog => check_leapfrog,
    };
    faults.judge(&["artificial_viscosity"], || check_growth(scene));
    faults.judge(&["artificial_viscosity"], || check_limited(scene));
    faults.judge(&["contact", "domain.lower"], || check_contact(scene, warnings));
    if faults.concern("method") {
        return;
    }
    faults.take(step(scene));
    faults.take(check_domain_limit(scene));
    faults.take(check_volume_relaxation(scene));
    if scene.method.spin {
        faults.take(check_spin(scene));
    }
    if let Some(limiter) = scene.method.flux_limiter {
        faults.judge(&["contact"], || check_limiter(scene, limiter));
    }
    faults.take(check_mass_lumping(&scene.method));
    if scene.method.shape.has_jumps() {
        warnings.push(
            "method.shape = \"linear\": inaccurate, since forces jump when a particle passes into \
             another cell; allowed all the same"
                .to_string(),
        );
    }
}

fn check_growth(scene: &Scene) -> Result<(), SceneFault> {
    if let Some(viscosity) = &scene.artificial_viscosity
        && let Some(growth) = viscosity.growth
        && growth.max <= viscosity.quadratic
    {
        let reason = format!(
            "leaves no room to grow from artificial_viscosity.quadratic {}; allowed: a greater number",
            viscosity.quadratic
        );
        return Err(SceneFault::new("artificial_viscosity.growth.max", growth.max, reason));
    }
    Ok(())
}

fn check_limited(scene: &Scene) -> Result<(), SceneFault> {
    if let Some(viscosity) = &scene.artificial_viscosity
        && viscosity.limited != LimitedTerms::Linear
        && viscosity.limiter.is_none()
    {
        let reason = "says nothing while artificial_viscosity.limiter is left out; allowed: to \
                      leave both out, or artificial_viscosity.limiter \"christensen\" or \"nodal\"";
        return Err(SceneFault::new("artificial_viscosity.limited", viscosity.limited, reason));
    }
    Ok(())
}

fn check_domain_limit(scene: &Scene) -> Result<(), SceneFault> {
    if let Some(limit) = scene.method.domain_limit
        && scene.method.shape.extent() != DomainExtent::Current
    {
        let reason = "has no effect: no particle's domain deforms; allowed: to leave it out, or \
                      method.shape \"cpdi\" or \"cpdi_bspline_quadratic\"";
        return Err(SceneFault::new("method.domain_limit", limit, reason));
    }
    Ok(())
}

fn check_volume_relaxation(scene: &Scene) -> Result<(), SceneFault> {
    if let (Some(rate), None) = (scene.method.volume_relaxation, scene.method.edge_mask) {
        let reason = "needs method.edge_mask, which knows what is filled; allowed: to leave it \
                      out, or method.edge_mask";
        return Err(SceneFault::new("method.volume_relaxation", rate, reason));
    }
    Ok(())
}

/// Rejects options that act only on fluids if no body is a fluid.
pub(super) fn check_bodies(checked: &CheckedScene) -> Result<(), SceneFault> {
    let fluids = (0..checked.bodies.len()).any(|i| !checked.material_of(i).eos.is_solid());
    let reason = "acts on fluids alone, and every body is elastic; allowed: to leave it out";
    let method = &checked.scene.method;
    match (method.pressure_relaxation, method.volume_relaxation) {
        (Some(relaxation), _) if !fluids => {
            Err(SceneFault::new("method.pressure_relaxation", relaxation, reason))
        }
        (_, Some(rate)) if !fluids => {
            Err(SceneFault::new("method.volume_relaxation", rate, reason))
        }
        _ => Ok(()),
    }
}

/// Checks the options that particles with spin need.
fn check_spin(scene: &Scene) -> Result<(), SceneFault> {
    let method = &scene.method;
    let refuse = |reason: &str| Err(SceneFault::new("method.spin", true, reason.to_string()));
    if scene.domain.lower.len() == 1 {
        return refuse(
            "has no effect: on a line nothing rotates; allowed: to leave it out, or two dimensions",
        );
    }
    if scene.domain.geometry == Geometry::Axisymmetric {
        return refuse(
            "does not hold with axial symmetry: a rotation in the plane of radius and axis strains \
             the hoops, and no angular momentum in this plane is conserved; allowed: to leave it out",
        );
    }
    let spin = ("method.spin", true);
    if method.stepping != Stepping::Midpoint {
        let allowed = format!("to leave it out, or {MIDPOINT}");
        return Err(conflict(spin, ("method.stepping", method.stepping), &allowed));
    }
    if !method.transfer.plan().full_mass_matrix {
        let allowed = "to leave it out, or method.transfer {\"fmpm\": m}";
        return Err(conflict(spin, ("method.transfer", method.transfer), allowed));
    }
    if method.frame == FrameKind::TotalLagrangian {
        let allowed = "to leave it out, or method.frame \"updated_lagrangian\": distances to the \
                       nodes are those of the initial positions";
        return Err(conflict(spin, ("method.frame", method.frame), allowed));
    }
    if method.shape.has_jumps() {
        let allowed = "to leave it out, or another method.shape: a particle at a node has no moment \
                       of inertia";
        return Err(conflict(spin, ("method.shape", method.shape), allowed));
    }
    Ok(())
}

/// Checks the options that the flux limiter needs.
fn check_limiter(scene: &Scene, limiter: FluxLimiter) -> Result<(), SceneFault> {
    let method = &scene.method;
    let key = ("method.flux_limiter", limiter);
    if scene.domain.lower.len() != 1 {
        let reason = "acts on a line alone; allowed: to leave it out, or one dimension";
        return Err(SceneFault::new(key.0, limiter, reason));
    }
    if method.stepping != Stepping::Midpoint {
        let allowed = format!("to leave it out, or {MIDPOINT}");
        return Err(conflict(key, ("method.stepping", method.stepping), &allowed));
    }
    let plan = method.transfer.plan();
    if !plan.full_mass_matrix || plan.order < 2 {
        let allowed = "to leave it out, or method.transfer {\"fmpm\": m} with m of 2 or more";
        return Err(conflict(key, ("method.transfer", method.transfer), allowed));
    }
    if let Some(contact) = scene.contact.filter(|contact| contact.condition().is_some()) {
        let allowed = "to leave one of them out";
        return Err(conflict(key, ("contact.type", contact.name()), allowed));
    }
    Ok(())
}

/// Checks the options that a partly lumped mass matrix needs.
fn check_mass_lumping(method: &Method) -> Result<(), SceneFault> {
    let Some(lumping) = method.mass_lumping else { return Ok(()) };
    let key = ("method.mass_lumping", lumping);
    if method.transfer.plan().force_order() < 2 {
        let allowed = "to leave it out, or method.transfer {\"fmpm\": m} with m of 2 or more";
        return Err(conflict(key, ("method.transfer", method.transfer), allowed));
    }
    match method.flux_limiter {
        Some(limiter) => {
            Err(conflict(key, ("method.flux_limiter", limiter), "to leave one of them out"))
        }
        None => Ok(()),
    }
}

/// Factor by which a particle may lengthen within a step.
const STRETCH: f64 = 1.25;

/// Maximum length of a particle for which the stencil has enough nodes [cells]; `None` if the shape
/// function does not grow with the particle.
fn longest_particle(method: &Method, dimension: usize) -> Option<f64> {
    let extent = method.shape.extent();
    if extent == DomainExtent::Point {
        return None;
    }
    let deforms = extent == DomainExtent::Current && method.frame == FrameKind::UpdatedLagrangian;
    let room = (most_nodes(dimension) + 1 - method.shape.nodes(1.0)) as f64;
    Some(if deforms { room / STRETCH } else { room })
}

/// Checks that particles with their own positions fit the stencil; those of a lattice always do.
pub(super) fn check_positions(checked: &CheckedScene) -> Result<(), SceneFault> {
    let method = &checked.scene.method;
    let Some(limit) = longest_particle(method, checked.dimension) else { return Ok(()) };
    for (body, own) in checked.scene.bodies.iter().zip(&checked.bodies) {
        let Some(tiling) = &own.tiling else { continue };
        let in_cells =
            tiling.longest().into_iter().zip(&checked.cell_size).map(|(l, cell)| l / cell);
        let longest = in_cells.fold(0.0, f64::max);
        if longest > limit {
            let reason = format!(
                "too few: a particle is {longest:.1} cells long; allowed: up to {limit:.1} with \
                 method.shape = {}",
                serde_json::json!(method.shape)
            );
            return Err(SceneFault::missing(
                join(&join("bodies", &body.name), "positions"),
                reason,
            ));
        }
    }
    Ok(())
}

/// Checks the contact law against dimension and number of bodies.
fn check_contact(scene: &Scene, warnings: &mut Vec<String>) -> Result<(), SceneFault> {
    let Some(contact) = scene.contact else { return Ok(()) };
    let on_line = contact.condition().filter(|_| scene.domain.lower.len() == 1);
    if let Some(normals) = on_line.map(|c| c.normals).filter(|normals| normals.is_plane_only()) {
        let reason = "says nothing: on a line every normal is along it; allowed: to leave it out, \
                      or two dimensions";
        return Err(SceneFault::new("contact.normals", normals, reason));
    }
    if scene.bodies.len() == 1 {
        warnings.push("contact: the scene has one body, which touches no other".to_string());
    } else if on_line.is_some_and(|condition| condition.coefficient.is_some()) {
        warnings.push(format!(
            "contact.type = \"{}\": on a line nothing slides; the same as \"frictionless\"",
            contact.name()
        ));
    }
    Ok(())
}

/// Checks the options of a mid-point step, which has one order of the stress update.
fn check_midpoint(scene: &Scene) -> Result<(), SceneFault> {
    let method = &scene.method;
    if method.stress_update != StressUpdate::Last {
        return Err(conflict(
            ("method.stress_update", method.stress_update),
            ("method.stepping", method.stepping),
            "\"last\", or method.stepping = \"leapfrog\"",
        ));
    }
    let transfer = ("method.transfer", method.transfer);
    if method.energy == EnergyUpdate::Compatible && method.transfer.plan().is_affine() {
        let allowed = "\"textbook\", or another method.transfer";
        return Err(conflict(("method.energy", method.energy), transfer, allowed));
    }
    if method.filter_heat && !method.transfer.plan().filters {
        let allowed = "false, or method.transfer \"pic\", {\"flip_pic\": a}, {\"xpic\": m} or \
                       {\"fmpm\": m}";
        return Err(conflict(("method.filter_heat", true), transfer, allowed));
    }
    let exact = method.energy == EnergyUpdate::Compatible || method.filter_heat;
    if let Some(spreading) = method.heat_spreading.filter(|_| !exact) {
        if method.transfer.plan().is_affine() {
            let allowed = "to leave it out, or another method.transfer";
            return Err(conflict(("method.heat_spreading", spreading), transfer, allowed));
        }
        let energy = ("method.energy", method.energy);
        let allowed = "to leave it out, or method.energy = \"compatible\", or \
                       method.filter_heat = true";
        return Err(conflict(("method.heat_spreading", spreading), energy, allowed));
    }
    match method.edge_mask {
        Some(mask) if !method.transfer.plan().full_mass_matrix => {
            let allowed = "to leave it out, or method.transfer {\"fmpm\": m}";
            Err(conflict(("method.edge_mask", mask), transfer, allowed))
        }
        _ => Ok(()),
    }
}

/// Rejects options that exist only for mid-point steps in a leapfrog step.
fn check_leapfrog(scene: &Scene) -> Result<(), SceneFault> {
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
    if let Some(spreading) = method.heat_spreading {
        return Err(conflict(("method.heat_spreading", spreading), stepping, &allowed));
    }
    if let Some(relaxation) = method.pressure_relaxation {
        return Err(conflict(("method.pressure_relaxation", relaxation), stepping, &allowed));
    }
    match method.edge_mask {
        Some(mask) => Err(conflict(("method.edge_mask", mask), stepping, &allowed)),
        None => Ok(()),
    }
}

/// Fault of a key that excludes another one: paths and values of both, and what is allowed for the
/// first.
fn conflict(
    (path, value): (&str, impl Serialize),
    (other_path, other): (&str, impl Serialize),
    allowed: &str,
) -> SceneFault {
    let other = serde_json::json!(other);
    SceneFault::new(
        path,
        value,
        format!("cannot go with {other_path} = {other}; allowed: {allowed}"),
    )
}
