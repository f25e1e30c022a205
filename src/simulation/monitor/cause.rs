//! Most likely cause of an alarm, as text: a guess from the scene, and worded as a guess.

use super::Alarm;
use crate::scene::{CheckedScene, Eos, Limiter};
use crate::shape::{Basis, DomainExtent};

/// Likely cause of `alarm` and a remedy; `what` describes the state of the particle.
pub fn likely_cause(scene: &CheckedScene, alarm: Alarm, what: &str) -> String {
    let all = &scene.scene;
    if what.contains("leaves the domain") {
        return "the domain is too small for what moves in it; a larger domain, or a side \
                \"outflow\""
            .into();
    }
    if what.contains("stretched over") || what.contains("torn apart") {
        return expansion(scene);
    }
    let limit = scene.courant_limit();
    if all.time.courant > limit {
        return format!(
            "time.courant = {} is above {limit}, up to which this scheme was measured to be stable",
            all.time.courant
        );
    }
    if pulled(scene, what) {
        return "the tension exceeds the range of the equation of state; set eos.tension_cutoff or \
                failure, or contact if the bodies are to separate"
            .into();
    }
    if all.artificial_viscosity.is_none() {
        return "no artificial_viscosity: nothing widens a shock to what the cells resolve".into();
    }
    let few = scene
        .bodies
        .iter()
        .any(|b| b.tiling.is_none() && cells_of(scene, b) > b.particles as f64 * 0.75);
    let hats = all.method.shape.basis() == Basis::Hat;
    let long = all.method.transfer.plan().is_sharp();
    if few && hats && long {
        return "one particle a cell leaves modes of a long filter on hat functions undamped; \
                two or more a cell, or quadratic B-splines"
            .into();
    }
    if all.method.shape.extent() == DomainExtent::Undeformed && long {
        return "a long filter on particles of undeformed size; fewer particles a cell, \
                method.edge_mask, or cpdi_bspline_quadratic"
            .into();
    }
    match alarm {
        Alarm::Crowding => "particles have clumped: the shape function does not hold them apart; \
                            more cells, or a shape function of higher order"
            .into(),
        Alarm::Speed
            if all
                .artificial_viscosity
                .is_some_and(|v| v.limiter == Some(Limiter::Christensen)) =>
        {
            "a node with little material, or a scheme that is not stable here; method.edge_mask, \
             more artificial_viscosity, or a smaller time.courant"
                .into()
        }
        _ => {
            "the scheme is not stable here; a smaller time.courant, more artificial_viscosity, or \
              a shape function of higher order"
                .into()
        }
    }
}

/// Reason why a particle is longer than the stencil of its shape function, and a remedy.
fn expansion(scene: &CheckedScene) -> String {
    let limit = match (scene.scene.method.domain_limit, scene.dimension) {
        (Some(_), _) => "a smaller method.domain_limit",
        (None, 1) => "method.domain_limit 4",
        (None, _) => "method.domain_limit 1",
    };
    format!(
        "the material expands freely, as a gas does into empty space: the finer the cells, the \
         more cells a particle comes to fill; method.frame \"total_lagrangian\", {limit}, an \
         \"outflow\" nearer to the body, or more particles per cell"
    )
}

/// Whether a fluid without a tension limit is in tension.
fn pulled(scene: &CheckedScene, what: &str) -> bool {
    let unlimited =
        |eos: &Eos| matches!(eos, Eos::MieGruneisen(solid) if solid.tension_cutoff.is_none());
    let any = (0..scene.bodies.len()).any(|i| unlimited(&scene.material_of(i).eos));
    any && (what.contains("pressure -") || what.contains("tension"))
}

/// Number of cells that a body fills.
fn cells_of(scene: &CheckedScene, body: &crate::scene::CheckedBody) -> f64 {
    let along = |a: usize| (body.upper[a] - body.lower[a]) / scene.cell_size[a];
    (0..scene.dimension).map(along).product()
}
