//! Warnings about values that are allowed but rarely meant: wrong units, bodies of few cells, runs
//! that are too short or too long.

use std::collections::HashMap;

use super::tension;
use crate::input::paths::join;
use crate::material::constitutive;
use crate::scene::CheckedScene;

/// Least density of a material with a stiffness of its own, such as a metal [kg/m3]; foams are above.
const LEAST_DENSITY: f64 = 20.0;

/// Largest density of a material [kg/m3]; osmium has 22 600.
const LARGEST_DENSITY: f64 = 3e4;

/// Size of an atom, below which no material is a continuum [m].
const LEAST_CELL: f64 = 1e-10;

/// Diameter of the Earth [m].
const LARGEST_DOMAIN: f64 = 1.3e7;

/// Sound speed above which a material is stiff, so that its density and speeds are in SI [m/s].
const STIFF: f64 = 300.0;

/// Least number of cells across a body in which a wave is resolved.
const LEAST_CELLS: f64 = 8.0;

/// Impact speed above which a shock forms, over the sound speed [-].
const SHOCK: f64 = 0.02;

/// Largest speed of a stiff body: meteoroids meet the Earth at 72 km/s [m/s].
const LARGEST_SPEED: f64 = 7.5e4;

/// Speed at which stiff bodies meet below which no shock is worth a run, over the sound speed [-].
const LEAST_SPEED: f64 = 1e-3;

/// Least share of a body that a wave crosses in a run [-].
const LEAST_CROSSED: f64 = 0.01;

/// Number of steps above which a run is long.
const LONG_RUN: f64 = 1e7;

/// Particle-steps per second of one core, for an estimate of a run's time, in one and two
/// dimensions.
const PACE: [f64; 2] = [1e7, 2e6];

/// Warnings of a checked scene, one line each.
pub(super) fn warnings(checked: &CheckedScene) -> Vec<String> {
    // a table is costly to build, and many bodies may have one material
    let mut known: HashMap<(&str, u64), f64> = HashMap::new();
    let speeds: Vec<f64> = (0..checked.bodies.len())
        .map(|i| {
            let body = &checked.scene.bodies[i];
            let model = || constitutive::build(checked.material_of(i));
            let state = (body.material.as_str(), body.pressure.to_bits());
            *known.entry(state).or_insert_with(|| model().sound_speed_at(body.pressure))
        })
        .collect();
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    let mut all = densities(checked, &speeds);
    all.extend(bodies(checked));
    all.extend(viscosity(checked, &speeds));
    all.extend(velocities(checked, &speeds));
    all.extend(no_impact(checked));
    all.extend(duration(checked, fastest));
    all.extend(lengths(checked));
    all.extend(tension::warnings(checked, &speeds));
    all
}

/// Cells smaller than atoms and domains larger than planets.
fn lengths(checked: &CheckedScene) -> Vec<String> {
    let domain = &checked.scene.domain;
    let extents = domain.upper.iter().zip(&domain.lower).map(|(upper, lower)| upper - lower);
    let largest = extents.fold(0.0, f64::max);
    let smallest = checked.cell_size.iter().copied().fold(f64::INFINITY, f64::min);
    let small = (smallest < LEAST_CELL)
        .then(|| format!("domain.cell_size = {smallest:e}: smaller than an atom; the unit is m"));
    let large = (largest > LARGEST_DOMAIN).then(|| {
        format!(
            "domain.upper: the domain is {largest:e} m long, longer than the Earth; the unit is m"
        )
    });
    small.into_iter().chain(large).collect()
}

/// Densities of stiff materials that are no density in kg/m3.
fn densities(checked: &CheckedScene, speeds: &[f64]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for (body, &speed) in checked.scene.bodies.iter().zip(speeds) {
        let material = &checked.scene.materials[&body.material];
        let density = material.density;
        let least = if material.eos.is_gas() { 0.0 } else { LEAST_DENSITY };
        let plausible = (least..=LARGEST_DENSITY).contains(&density);
        let text = format!(
            "{} = {density}: no solid or liquid has this density; the unit is kg/m3",
            join(&join("materials", &body.material), "density")
        );
        if speed > STIFF && !plausible && !all.contains(&text) {
            all.push(text);
        }
    }
    all
}

/// Bodies with few cells across, unless a plan has predicted the error of these cells. Elastic solids are left out, and directions in which a body fills
/// the domain.
fn bodies(checked: &CheckedScene) -> Vec<String> {
    if checked.scene.output.plan.is_some() {
        return Vec::new();
    }
    let cells = |i: usize| {
        let body = &checked.bodies[i];
        let across = |a: usize| (body.upper[a] - body.lower[a]) / checked.cell_size[a];
        let fills = |a: &usize| across(*a) > checked.cells[*a] as f64 - 0.5;
        (0..checked.dimension).filter(|a| !fills(a)).map(across).fold(f64::INFINITY, f64::min)
    };
    let few = fluids(checked).filter(|&i| cells(i) < LEAST_CELLS - 1e-6);
    few.map(|i| {
        format!(
            "{}: {:.1} cells across. At least {LEAST_CELLS} cells are needed to resolve a wave; \
             reduce domain.cell_size",
            join("bodies", &checked.scene.bodies[i].name),
            cells(i)
        )
    })
    .collect()
}

/// Shocks without viscosity.
fn viscosity(checked: &CheckedScene, speeds: &[f64]) -> Option<String> {
    if checked.scene.artificial_viscosity.is_some() {
        return None;
    }
    let slowest = speeds.iter().copied().fold(f64::INFINITY, f64::min);
    let speed = closing_speed(checked);
    (speed > 0.0 && speed > SHOCK * slowest).then(|| {
        format!(
            "artificial_viscosity: absent, but bodies meet at {speed:.0} m/s and the lowest sound \
             speed is {slowest:.0} m/s. The shock will oscillate. If the scene has neither method \
             nor artificial_viscosity, the program chooses both"
        )
    })
}

/// Speeds of stiff bodies that are no speed in m/s.
fn velocities(checked: &CheckedScene, speeds: &[f64]) -> Option<String> {
    let slowest = speeds.iter().copied().fold(f64::INFINITY, f64::min);
    let has_gas = fluids(checked).any(|i| checked.material_of(i).eos.is_gas());
    if slowest <= STIFF || has_gas {
        return None;
    }
    let (closing, top) = (closing_speed(checked), top_speed(checked));
    if top > LARGEST_SPEED {
        return Some(format!(
            "bodies: a speed of {top:e} m/s; nothing strikes the Earth at more than 72 km/s; the \
             unit is m/s"
        ));
    }
    (closing > 0.0 && closing < LEAST_SPEED * slowest).then(|| {
        format!(
            "bodies: they meet at {closing} m/s, less than a thousandth of the sound speed \
             {slowest:.0} m/s; no shock forms; the unit is m/s"
        )
    })
}

/// Bodies that nothing sets in motion, or that only move away from each other.
fn no_impact(checked: &CheckedScene) -> Option<String> {
    let (scene, bodies) = (&checked.scene, &checked.bodies);
    let is_driven = scene.body_force.is_some()
        || checked.has_side(|side| side.moves_grid || side.pressure.is_some())
        || bodies.iter().any(|body| body.motion.is_some())
        || scene.bodies.iter().any(|body| body.pressure != scene.bodies[0].pressure)
        || scene.materials.values().any(|m| m.eos.burn().is_some())
        || scene.materials.values().any(|m| m.thermal.is_some_and(|t| t.conductivity.is_some()));
    if is_driven {
        return None;
    }
    let is_still = bodies.iter().all(|body| body.velocity.iter().all(|v| *v == 0.0));
    let meets_side = checked.has_side(|side| side.acts_on_material());
    let moves = bodies.iter().any(|body| body.velocity != bodies[0].velocity);
    if is_still || !(moves || meets_side) {
        return Some("bodies: none moves relative to another, and nothing drives them".into());
    }
    // elastic solids have no shocks, and in a plane bodies may enclose each other
    let is_compared = checked.dimension == 1 && fluids(checked).count() == bodies.len();
    (is_compared && !meets_side && closing_speed(checked) <= 0.0)
        .then(|| "bodies: none moves towards another, so that there is no impact".into())
}

/// Largest speed at which two bodies approach each other along an axis on which they stand apart or
/// touch [m/s]. Elastic solids are left out, since no shock forms in rubber.
fn closing_speed(checked: &CheckedScene) -> f64 {
    let bodies: Vec<_> = fluids(checked).map(|i| &checked.bodies[i]).collect();
    let mut fastest = 0.0_f64;
    for a in 0..checked.dimension {
        let mut sorted = bodies.clone();
        sorted.sort_by(|p, q| p.lower[a].total_cmp(&q.lower[a]));
        // least velocity of the bodies from number k on
        let mut least = vec![f64::INFINITY; sorted.len() + 1];
        for k in (0..sorted.len()).rev() {
            least[k] = least[k + 1].min(sorted[k].velocity[a]);
        }
        for one in &bodies {
            let beyond = one.upper[a] - checked.tolerance(a);
            let k = sorted.partition_point(|other| other.lower[a] < beyond);
            fastest = fastest.max(one.velocity[a] - least[k]);
        }
    }
    fastest
}

/// Indices of the bodies that are not elastic solids.
fn fluids(checked: &CheckedScene) -> impl Iterator<Item = usize> {
    (0..checked.bodies.len()).filter(|&i| !checked.material_of(i).eos.is_solid())
}

/// A run in which no wave gets far, or that takes very many steps.
fn duration(checked: &CheckedScene, sound_speed: f64) -> Vec<String> {
    let end = checked.scene.time.end;
    let smallest = checked.cell_size.iter().copied().fold(f64::INFINITY, f64::min);
    let steps = end * sound_speed / (checked.scene.time.courant * smallest);
    let longest = checked.bodies.iter().flat_map(|b| b.upper.iter().zip(&b.lower));
    let longest = longest.map(|(upper, lower)| upper - lower).fold(0.0, f64::max);
    let mut all = Vec::new();
    let reach = (sound_speed * end).max(top_speed(checked) * end);
    if reach < LEAST_CROSSED * longest {
        all.push(format!(
            "time.end = {end:e}: the fastest wave crosses only {:.2} % of the longest body by this \
             time; check that times are in s and lengths in m",
            100.0 * reach / longest
        ));
    }
    if steps > LONG_RUN {
        let hours = steps * checked.particles as f64 / PACE[checked.dimension - 1] / 3600.0;
        all.push(format!(
            "time.end = {end:e}: about {steps:.0e} steps, {hours:.1} hours on one core; the unit is s"
        ));
    }
    all
}

fn top_speed(checked: &CheckedScene) -> f64 {
    checked.bodies.iter().map(|body| body.top_speed).fold(0.0, f64::max)
}
