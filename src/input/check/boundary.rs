//! Checks of the sides of the domain and their combinations.

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use crate::scene::{CheckedScene, Course, Geometry, Scene, Side};

pub(super) fn check(scene: &Scene, faults: &mut Faults) {
    if faults.concern("boundary") {
        return;
    }
    faults.take(check_at_axis(scene));
    let Some(boundary) = &scene.boundary else { return };
    let y = [("boundary.y_lower", &boundary.y_lower), ("boundary.y_upper", &boundary.y_upper)];
    let x = [("boundary.x_lower", &boundary.x_lower), ("boundary.x_upper", &boundary.x_upper)];
    let beside = y.iter().filter_map(|(path, side)| Some((*path, side.as_ref()?)));
    for (path, side) in x.into_iter().chain(beside.clone()) {
        if let Some(course) = side.course() {
            let path = format!("{path}.{}", side.name());
            faults.take(check_course(&path, side.name(), &course));
        }
    }
    if scene.domain.lower.len() == 1 {
        for (path, side) in beside {
            let reason = "a side along y, but domain.lower has 1 number, which is the dimension of \
                          the scene; allowed: boundary.x_lower and boundary.x_upper";
            faults.add(SceneFault::new(path, side, reason));
        }
        for (path, side) in x.into_iter().filter(|(_, s)| s.properties().resists_sliding()) {
            let reason = "holds what slides along it, but domain.lower has 1 number, which is the \
                          dimension of the scene; allowed: \"wall\"";
            faults.add(SceneFault::new(path, side, reason));
        }
    }
    let on_axis = scene.domain.geometry == Geometry::Axisymmetric;
    if on_axis && let Some((path, side)) = x.into_iter().find(|(_, side)| is_periodic(side)) {
        let reason = "joins radii, which domain.geometry = \"axisymmetric\" has along x; allowed: \
                      any other side";
        faults.add(SceneFault::new(path, side, reason));
    }
    let x_sides = [&boundary.x_lower, &boundary.x_upper];
    faults.take(check_axis(["boundary.x_lower", "boundary.x_upper"], x_sides));
    let y_sides = y.map(|(_, side)| side.clone().unwrap_or_default());
    faults.take(check_axis(y.map(|(path, _)| path), y_sides.each_ref()));
}

/// Checks that the axis is a plane of symmetry.
fn check_at_axis(scene: &Scene) -> Result<(), SceneFault> {
    let at_axis = scene.domain.geometry == Geometry::Axisymmetric && scene.domain.lower[0] == 0.0;
    let inner = scene.boundary.clone().unwrap_or_default().x_lower;
    if at_axis && !inner.properties().symmetric {
        let reason = "stands on the axis of domain.geometry = \"axisymmetric\"; allowed: \
                      \"symmetry\", or domain.lower[0] above 0";
        return Err(SceneFault::new("boundary.x_lower", inner, reason));
    }
    Ok(())
}

fn is_periodic(side: &Side) -> bool {
    side.properties().is_periodic()
}

/// Checks the two sides of one direction.
fn check_axis([path, other_path]: [&str; 2], [lower, upper]: [&Side; 2]) -> Result<(), SceneFault> {
    let other = serde_json::json!(upper);
    let periodic = [lower, upper].map(is_periodic);
    if periodic[0] != periodic[1] {
        // the fault is the periodic side without a partner, at either end
        let (path, side, other_path, other) = match periodic[0] {
            true => (path, lower, other_path, upper),
            false => (other_path, upper, path, lower),
        };
        let reason = format!(
            "cannot stand opposite {other_path} = {}; allowed: \"periodic\" on both sides or on \
             neither",
            serde_json::json!(other)
        );
        return Err(SceneFault::new(path, side, reason));
    }
    match (lower.properties().rigid_velocity, upper.properties().rigid_velocity) {
        (Some(a), Some(b)) if a != b => {
            let reason = format!(
                "cannot stand opposite {other_path} = {other}, since the grid travels with a \
                 piston; allowed: the same velocity on both sides (a wall and a plane of symmetry \
                 are at rest), \"free\", \"outflow\", \
                 \"transmitting\" or a pressure"
            );
            Err(SceneFault::new(path, lower, reason))
        }
        _ => Ok(()),
    }
}

const PATHS: [[&str; 2]; 2] =
    [["boundary.x_lower", "boundary.x_upper"], ["boundary.y_lower", "boundary.y_upper"]];

/// Whether a body touches the side at the lower or upper `end` of direction `a`.
fn is_touched(checked: &CheckedScene, a: usize, end: usize) -> bool {
    let domain = &checked.scene.domain;
    checked.bodies.iter().any(|body| match end {
        0 => body.lower[a] - domain.lower[a] <= checked.tolerance(a),
        _ => domain.upper[a] - body.upper[a] <= checked.tolerance(a),
    })
}

/// Checks transmitting sides: each continues the material of a body that must touch it.
pub(super) fn check_transmitting(checked: &mut CheckedScene) -> Result<(), Faults> {
    let sides = checked.sides::<2>();
    let mut faults = Faults::default();
    for (a, end) in (0..checked.dimension).flat_map(|a| [(a, 0), (a, 1)]) {
        if sides[a][end].properties().absorbs_waves && !is_touched(checked, a, end) {
            let reason = "stands for more of the material that touches it, but no body does; \
                          allowed: \"outflow\", or a body up to this side";
            faults.add(SceneFault::new(PATHS[a][end], &sides[a][end], reason));
        }
    }
    let method = &checked.scene.method;
    let sharp = method.transfer.plan().is_sharp();
    if checked.transmits() && sharp && method.edge_mask.is_none() {
        checked.warnings.push(
            "boundary: the full mass matrix of \"fmpm\" beyond order 2 magnifies the force of a \
             side \"transmitting\" where a particle about to leave fills little of a node, which \
             may become unstable; method.edge_mask leaves those nodes out"
                .to_string(),
        );
    }
    faults.ok_or_faults(())
}

/// Checks that the times of a course increase and that its file has been read.
fn check_course(path: &str, quantity: &str, course: &Course) -> Result<(), SceneFault> {
    match course {
        Course::Constant(_) | Course::Ramp(_) => Ok(()),
        Course::Series(points) => {
            let later = |pair: &[[f64; 2]]| pair[0][0] < pair[1][0];
            let Some(k) = points.windows(2).position(|pair| !later(pair)) else { return Ok(()) };
            let reason =
                "the time is not after that of the pair before; allowed: times that ascend";
            Err(SceneFault::new(format!("{path}[{}]", k + 1), points[k + 1], reason))
        }
        Course::File(_) => {
            let reason = format!(
                "is read with the scene's own file alone; allowed: to name it there, a \
                 {quantity}, pairs of time and {quantity}, or a ramp"
            );
            Err(SceneFault::new(path, course, reason))
        }
    }
}

/// Checks that each pressure acts on a body.
pub(super) fn check_loads(checked: &mut CheckedScene) -> Result<(), Faults> {
    let sides = checked.sides::<2>();
    let mut faults = Faults::default();
    for (a, end) in (0..checked.dimension).flat_map(|a| [(a, 0), (a, 1)]) {
        let side = &sides[a][end];
        let Some(load) = side.properties().pressure else { continue };
        let path = format!("{}.{}", PATHS[a][end], side.name());
        if !is_touched(checked, a, end) {
            let reason = "presses on what touches this side, but no body does; allowed: \"free\", \
                          or a body up to this side";
            faults.add(SceneFault::new(path, load, reason));
        } else if checked.scene.reference.is_some() {
            let reason = "is not in any exact solution; allowed: a scene without reference, or \
                          another side";
            faults.add(SceneFault::new(path, load, reason));
        }
    }
    let method = &checked.scene.method;
    let sharp = method.transfer.plan().is_sharp();
    if checked.is_loaded() && sharp && method.edge_mask.is_none() {
        checked.warnings.push(
            "boundary: the full mass matrix of \"fmpm\" beyond order 2 magnifies the force of a \
             pressure where a particle fills little of a node, which may become unstable; \
             method.edge_mask leaves those nodes out"
                .to_string(),
        );
    }
    faults.ok_or_faults(())
}
