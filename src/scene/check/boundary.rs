//! Sides of the domain that cannot stand opposite each other.

use super::super::errors::Fault;
use super::super::model::{Course, Geometry, Scene, Side, Transfer};
use super::CheckedScene;

/// A rigid side of the domain: a plane of symmetry, a wall or a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Whether it stands at the upper end of x.
    pub upper: bool,
    /// Where it stands at the start [m].
    pub position: f64,
    /// Its velocity along x at the start [m/s].
    pub velocity: f64,
}

/// A side that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Piston {
    /// Whether it stands at the upper end of x.
    pub upper: bool,
    /// Its velocity along x over time [m/s].
    pub course: Course,
}

impl Wall {
    /// Path of the key that sets it.
    pub(super) fn path(&self) -> &'static str {
        if self.upper { "boundary.x_upper" } else { "boundary.x_lower" }
    }
}

impl CheckedScene {
    /// The rigid sides of the domain, the lower one first.
    pub fn walls(&self) -> Vec<Wall> {
        let Some(boundary) = &self.scene.boundary else { return Vec::new() };
        let domain = &self.scene.domain;
        let wall = |side: &Side, position, upper| {
            side.rigid_velocity().map(|velocity| Wall { upper, position, velocity })
        };
        let lower = wall(&boundary.x_lower, domain.lower[0], false);
        let upper = wall(&boundary.x_upper, domain.upper[0], true);
        lower.into_iter().chain(upper).collect()
    }

    /// The rigid side that body `i` touches and moves into, if there is one.
    pub fn wall_struck_by(&self, i: usize) -> Option<Wall> {
        self.walls()
            .into_iter()
            .find(|w| self.gap_to(w, i) <= self.tolerance(0) && self.closing_speed(w, i) > 0.0)
    }

    /// The piston that body `i` touches, if there is one.
    pub fn piston_at(&self, i: usize) -> Option<Piston> {
        let boundary = self.scene.boundary.as_ref()?;
        let ends = [(&boundary.x_lower, false), (&boundary.x_upper, true)];
        let domain = &self.scene.domain;
        ends.into_iter().find_map(|(side, upper)| {
            let Side::Velocity(course) = side else { return None };
            let position = if upper { domain.upper[0] } else { domain.lower[0] };
            let wall = Wall { upper, position, velocity: course.at(0.0) };
            let touches = self.gap_to(&wall, i) <= self.tolerance(0);
            touches.then(|| Piston { upper, course: course.clone() })
        })
    }

    /// Distance from body `i` to a wall [m].
    pub(super) fn gap_to(&self, wall: &Wall, i: usize) -> f64 {
        let extent = &self.bodies[i];
        if wall.upper { wall.position - extent.upper[0] } else { extent.lower[0] - wall.position }
    }

    /// Speed at which body `i` and a wall come together [m/s].
    pub fn closing_speed(&self, wall: &Wall, i: usize) -> f64 {
        let relative = self.bodies[i].velocity[0] - wall.velocity;
        if wall.upper { relative } else { -relative }
    }
}

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let at_axis = scene.domain.geometry == Geometry::Axisymmetric && scene.domain.lower[0] == 0.0;
    let inner = scene.boundary.as_ref().map_or(Side::Free, |b| b.x_lower.clone());
    if at_axis && inner != Side::Symmetry {
        let reason = "stands on the axis of domain.geometry = \"axisymmetric\"; allowed: \
                      \"symmetry\", or domain.lower[0] above 0";
        return Err(Fault::new("boundary.x_lower", inner, reason));
    }
    let Some(boundary) = &scene.boundary else { return Ok(()) };
    let y = [("boundary.y_lower", &boundary.y_lower), ("boundary.y_upper", &boundary.y_upper)];
    let x = [("boundary.x_lower", &boundary.x_lower), ("boundary.x_upper", &boundary.x_upper)];
    let beside = y.iter().filter_map(|(path, side)| Some((*path, side.as_ref()?)));
    for (path, side) in x.into_iter().chain(beside) {
        match side {
            Side::Velocity(v) => check_course(&format!("{path}.velocity"), "velocity", v)?,
            Side::Pressure(p) => check_course(&format!("{path}.pressure"), "pressure", p)?,
            _ => {}
        }
    }
    if scene.domain.lower.len() == 1 {
        for (path, side) in y {
            if let Some(side) = side {
                let reason = "a side along y, but domain.lower has 1 number, which is the \
                              dimension of the scene; allowed: boundary.x_lower and \
                              boundary.x_upper";
                return Err(Fault::new(path, side, reason));
            }
        }
        for (path, side) in x {
            if matches!(side, Side::NoSlip | Side::Friction(_)) {
                let reason = "holds what slides along it, but domain.lower has 1 number, which is \
                              the dimension of the scene; allowed: \"wall\"";
                return Err(Fault::new(path, side, reason));
            }
        }
    }
    let on_axis = scene.domain.geometry == Geometry::Axisymmetric;
    if on_axis && (boundary.x_lower == Side::Periodic || boundary.x_upper == Side::Periodic) {
        let reason = "joins radii, which domain.geometry = \"axisymmetric\" has along x; allowed: \
                      any other side";
        let lower = boundary.x_lower == Side::Periodic;
        let (path, side) = if lower { x[0] } else { x[1] };
        return Err(Fault::new(path, side, reason));
    }
    check_axis(["boundary.x_lower", "boundary.x_upper"], [&boundary.x_lower, &boundary.x_upper])?;
    check_axis(y.map(|(path, _)| path), y.map(|(_, side)| side.as_ref().unwrap_or(&Side::Free)))
}

/// The two sides along one direction.
fn check_axis([path, other_path]: [&str; 2], [lower, upper]: [&Side; 2]) -> Result<(), Fault> {
    let other = serde_json::json!(upper);
    let periodic = [lower, upper].map(|side| *side == Side::Periodic);
    if periodic[0] != periodic[1] {
        // the side that lacks its partner is the fault, whichever end it stands at
        let (path, side, other_path, other) = match periodic[0] {
            true => (path, lower, other_path, upper),
            false => (other_path, upper, path, lower),
        };
        let reason = format!(
            "cannot stand opposite {other_path} = {}; allowed: \"periodic\" on both sides or on \
             neither",
            serde_json::json!(other)
        );
        return Err(Fault::new(path, side, reason));
    }
    match (lower.rigid_course(), upper.rigid_course()) {
        (Some(a), Some(b)) if a != b => {
            let reason = format!(
                "cannot stand opposite {other_path} = {other}, since the grid travels with a \
                 piston; allowed: the same velocity on both sides (a wall and a plane of symmetry \
                 are at rest), \"free\", \"outflow\", \
                 \"transmitting\" or a pressure"
            );
            Err(Fault::new(path, lower, reason))
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

/// A transmitting side stands for more of the material that touches it.
pub(super) fn check_transmitting(checked: &mut CheckedScene) -> Result<(), Fault> {
    let sides = checked.sides::<2>();
    for (a, end) in (0..checked.dimension).flat_map(|a| [(a, 0), (a, 1)]) {
        if sides[a][end] == Side::Transmitting && !is_touched(checked, a, end) {
            let reason = "stands for more of the material that touches it, but no body does; \
                          allowed: \"outflow\", or a body up to this side";
            return Err(Fault::new(PATHS[a][end], &sides[a][end], reason));
        }
    }
    let method = &checked.scene.method;
    let sharp = matches!(method.transfer, Transfer::Fmpm(order) if order > 2);
    if checked.transmits() && sharp && method.edge_mask.is_none() {
        checked.warnings.push(
            "boundary: the full mass matrix of \"fmpm\" beyond order 2 magnifies the force of a \
             side \"transmitting\" where a particle about to leave fills little of a node, which \
             may become unstable; method.edge_mask leaves those nodes out"
                .to_string(),
        );
    }
    Ok(())
}

/// The times of a course ascend, and its file has been read.
fn check_course(path: &str, quantity: &str, course: &Course) -> Result<(), Fault> {
    match course {
        Course::Constant(_) | Course::Ramp(_) => Ok(()),
        Course::Series(points) => {
            let later = |pair: &[[f64; 2]]| pair[0][0] < pair[1][0];
            let Some(k) = points.windows(2).position(|pair| !later(pair)) else { return Ok(()) };
            let reason =
                "the time is not after that of the pair before; allowed: times that ascend";
            Err(Fault::new(format!("{path}[{}]", k + 1), points[k + 1], reason))
        }
        Course::File(_) => {
            let reason = format!(
                "is read with the scene's own file alone; allowed: to name it there, a \
                 {quantity}, pairs of time and {quantity}, or a ramp"
            );
            Err(Fault::new(path, course, reason))
        }
    }
}

/// A pressure presses on a body.
pub(super) fn check_loads(checked: &mut CheckedScene) -> Result<(), Fault> {
    let sides = checked.sides::<2>();
    for (a, end) in (0..checked.dimension).flat_map(|a| [(a, 0), (a, 1)]) {
        let Side::Pressure(load) = &sides[a][end] else { continue };
        let path = format!("{}.pressure", PATHS[a][end]);
        if !is_touched(checked, a, end) {
            let reason = "presses on what touches this side, but no body does; allowed: \"free\", \
                          or a body up to this side";
            return Err(Fault::new(path, load, reason));
        }
        if checked.scene.reference.is_some() {
            let reason = "is not in any exact solution; allowed: a scene without reference, or \
                          another side";
            return Err(Fault::new(path, load, reason));
        }
    }
    let method = &checked.scene.method;
    let sharp = matches!(method.transfer, Transfer::Fmpm(order) if order > 2);
    if checked.is_loaded() && sharp && method.edge_mask.is_none() {
        checked.warnings.push(
            "boundary: the full mass matrix of \"fmpm\" beyond order 2 magnifies the force of a \
             pressure where a particle fills little of a node, which may become unstable; \
             method.edge_mask leaves those nodes out"
                .to_string(),
        );
    }
    Ok(())
}
