//! Materials and bodies: names, places, and how many particles fill them.

use std::collections::{HashMap, HashSet};

use serde_json::json;

use crate::material::Lame;
use crate::motion::Motion;

use super::super::conform::join;
use super::super::errors::{Fault, suggest};
use super::super::model::{Body, Eos, Scene};
use super::domain::MOST;
use super::{check_box, check_length, check_printable, motion};

/// Bodies nearer than this touch, and may overlap by it [cells].
pub(super) const TOUCHING: f64 = 1e-9;

/// What follows for a body from its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedBody {
    /// Its material, as an index into the scene's materials in their order by name.
    pub material: usize,
    /// Velocity at the start [m/s], D numbers; zeros where it differs from place to place.
    pub velocity: Vec<f64>,
    /// Velocity at the start where it differs from place to place.
    pub motion: Option<Motion>,
    /// No particle is faster at the start [m/s].
    pub top_speed: f64,
    /// Particles in each direction: length over cell size times particles a cell, rounded. They
    /// tile the body: each is as long as the body over this number.
    pub lattice: Vec<usize>,
    /// Particles in all.
    pub particles: u64,
}

pub(super) fn check(
    scene: &Scene,
    cell_size: &[f64],
    warnings: &mut Vec<String>,
) -> Result<Vec<CheckedBody>, Fault> {
    check_materials(scene)?;
    let materials: Vec<_> = scene.materials.keys().map(String::as_str).collect();
    let index: HashMap<_, _> = materials.iter().enumerate().map(|(i, &name)| (name, i)).collect();
    let mut names = HashSet::new();
    let mut checked = Vec::with_capacity(scene.bodies.len());
    for (i, body) in scene.bodies.iter().enumerate() {
        let path = format!("bodies[{i}].name");
        check_printable(&path, &body.name)?;
        if !names.insert(body.name.as_str()) {
            let reason = "another body has this name; allowed: a name of its own";
            return Err(Fault::new(path, &body.name, reason));
        }
        let path = join("bodies", &body.name);
        let Some(&material) = index.get(body.material.as_str()) else {
            let reason =
                format!("no such material{}", suggest(&body.material, materials.iter().copied()));
            return Err(Fault::new(join(&path, "material"), &body.material, reason));
        };
        checked.push(check_body(scene, body, &path, material, cell_size)?);
    }
    check_overlap(scene, cell_size)?;
    let used: HashSet<_> = checked.iter().map(|body| body.material).collect();
    for (i, name) in materials.iter().enumerate() {
        if !used.contains(&i) {
            warnings.push(format!("{}: no body is of this material", join("materials", name)));
        }
    }
    Ok(checked)
}

fn check_materials(scene: &Scene) -> Result<(), Fault> {
    for (name, material) in &scene.materials {
        check_printable("materials", name)?;
        if let Eos::MieGruneisen { c0, .. } = material.eos
            && !(material.density * c0 * c0).is_normal()
        {
            let path = join(&join("materials", name), "density");
            let reason = format!(
                "density * c0^2 with eos.c0 = {c0} is no finite stiffness; allowed: SI units, \
                 kg/m3 and m/s"
            );
            return Err(Fault::new(path, material.density, reason));
        }
        if let Eos::LinearElastic { youngs_modulus, poissons_ratio }
        | Eos::NeoHookean { youngs_modulus, poissons_ratio } = material.eos
            && !(Lame::new(youngs_modulus, poissons_ratio).longitudinal() / material.density)
                .is_normal()
        {
            let path = join(&join("materials", name), "eos.youngs_modulus");
            let reason = format!(
                "no finite stiffness over density = {}; allowed: SI units, Pa and kg/m3",
                json!(material.density)
            );
            return Err(Fault::new(path, youngs_modulus, reason));
        }
    }
    Ok(())
}

fn check_body(
    scene: &Scene,
    body: &Body,
    path: &str,
    material: usize,
    cell_size: &[f64],
) -> Result<CheckedBody, Fault> {
    let dimension = cell_size.len();
    let below = |key: &str| format!("{path}.{key}");
    let extent = &body.extent;
    check_length(&below("box.lower"), &extent.lower, dimension)?;
    check_length(&below("box.upper"), &extent.upper, dimension)?;
    check_length(&below("particles_per_cell"), &body.particles_per_cell, dimension)?;
    let velocity = body.velocity.clone().unwrap_or_else(|| vec![0.0; dimension]);
    check_length(&below("velocity"), &velocity, dimension)?;
    check_box(&below("box"), &extent.lower, &extent.upper)?;
    let domain = &scene.domain;
    for (d, size) in cell_size.iter().enumerate() {
        let tolerance = TOUCHING * size;
        let (lower, upper) = (domain.lower[d], domain.upper[d]);
        let outside = if extent.lower[d] < lower - tolerance {
            Some(("box.lower", &extent.lower))
        } else if extent.upper[d] > upper + tolerance {
            Some(("box.upper", &extent.upper))
        } else {
            None
        };
        if let Some((key, corner)) = outside {
            let reason = format!(
                "outside of the domain; allowed: {lower} to {upper} (domain.lower, domain.upper)"
            );
            return Err(Fault::new(below(key), corner, reason));
        }
    }
    check_pressure(scene, body, &below("pressure"))?;
    let motion = motion::check_field(scene, body, path, dimension)?;
    let top_speed = match &motion {
        Some(motion) => motion.top_speed(&extent.lower, &extent.upper),
        None => norm(&velocity),
    };
    let lattice = lattice(body, path, cell_size)?;
    let particles = lattice.iter().map(|&n| n as u64).product();
    Ok(CheckedBody { material, velocity, motion, top_speed, lattice, particles })
}

/// Length of a vector; exact along an axis.
fn norm(v: &[f64]) -> f64 {
    match v {
        [x] => x.abs(),
        _ => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}

/// A pressure that the material bears at its density.
fn check_pressure(scene: &Scene, body: &Body, path: &str) -> Result<(), Fault> {
    let material = &scene.materials[&body.material];
    let (least, why) = match material.eos {
        Eos::MieGruneisen { c0, gamma0, .. } => (
            -material.density * c0 * c0 / (2.0 * gamma0),
            "the tension -density c0^2/(2 gamma0) that Mie-Grueneisen can bear",
        ),
        Eos::IdealGas { .. } => (0.0, "since an ideal gas bears no tension"),
        Eos::LinearElastic { .. } | Eos::NeoHookean { .. } if body.pressure == 0.0 => return Ok(()),
        Eos::LinearElastic { .. } | Eos::NeoHookean { .. } => {
            let reason = "an elastic body starts without stress; allowed: 0";
            return Err(Fault::new(path, body.pressure, reason));
        }
    };
    if body.pressure >= least {
        return Ok(());
    }
    Err(Fault::new(path, body.pressure, format!("allowed: at least {}, {why}", json!(least))))
}

/// Particles in each direction.
fn lattice(body: &Body, path: &str, cell_size: &[f64]) -> Result<Vec<usize>, Fault> {
    let extent = &body.extent;
    let mut total = 1.0;
    let mut lattice = Vec::with_capacity(cell_size.len());
    for (d, size) in cell_size.iter().enumerate() {
        let cells = (extent.upper[d] - extent.lower[d]) / size;
        let count = (cells * body.particles_per_cell[d] as f64).round();
        if count < 1.0 {
            let reason = format!(
                "no particle: the body is {cells:?} cells long, less than half a particle's size; \
                 allowed: a longer box, a smaller domain.cell_size or more particles_per_cell"
            );
            return Err(Fault::new(format!("{path}.box"), extent, reason));
        }
        total *= count;
        if total > MOST {
            let reason = format!(
                "{total:e} particles; allowed: at most {MOST:e} in all, and what the machine's \
                 memory holds"
            );
            let path = format!("{path}.particles_per_cell");
            return Err(Fault::new(path, &body.particles_per_cell, reason));
        }
        lattice.push(count as usize);
    }
    Ok(lattice)
}

/// Bodies may touch, but not overlap: in order of x, each is held against those that begin
/// before it ends.
fn check_overlap(scene: &Scene, cell_size: &[f64]) -> Result<(), Fault> {
    let mut order: Vec<&Body> = scene.bodies.iter().collect();
    order.sort_by(|a, b| a.extent.lower[0].total_cmp(&b.extent.lower[0]));
    let overlap = |a: &Body, b: &Body| {
        cell_size.iter().enumerate().all(|(d, size)| {
            let upper = a.extent.upper[d].min(b.extent.upper[d]);
            upper - a.extent.lower[d].max(b.extent.lower[d]) > TOUCHING * size
        })
    };
    for (i, body) in order.iter().enumerate() {
        let rest = order[i + 1..].iter();
        for other in rest.take_while(|other| other.extent.lower[0] < body.extent.upper[0]) {
            if overlap(body, other) {
                let reason = format!(
                    "overlaps {} = {}; allowed: boxes that touch at most",
                    join(&join("bodies", &body.name), "box"),
                    json!(body.extent)
                );
                let path = join(&join("bodies", &other.name), "box");
                return Err(Fault::new(path, &other.extent, reason));
            }
        }
    }
    Ok(())
}
