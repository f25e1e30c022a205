//! Physical quantities of a run beside their exact values: pressure and velocity behind the shock,
//! shock speed, velocity of the free surface; density behind a shock of Noh's problem; length and
//! diameter of a body that has struck a wall.

use super::output::histories::HistoryTable;
use super::output::labels;
use super::output::summary::{MeasuredQuantity, ProfileSummary};
use crate::accuracy::reference::{AlongWave, ImpactReference, ReferenceSolution};
use crate::exact::Plate;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Number of the state behind the first shock in the chain of states.
const SHOCKED: usize = 2;

/// Difference from the exact pressure up to which a particle counts as behind the shock [-].
const PRESSURE_TOLERANCE: f64 = 0.02;

/// Change of the velocity of a free surface in a plane above which the wave has reached it, over the
/// impact speed [-].
const VELOCITY_CHANGE_TOLERANCE: f64 = 0.1;

/// Change of a velocity that is no more than rounding, over the impact speed [-].
const ROUNDING: f64 = 1e-6;

/// Quantities of a run. Without an exact solution of an impact, they end with the largest pressure,
/// tension and speed of the last profile.
pub fn quantities(
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    profiles: &[ProfileSummary],
    tables: &[&ParticleTable],
    histories: Option<&HistoryTable>,
) -> Vec<MeasuredQuantity> {
    let impact = match reference {
        Some(all @ ReferenceSolution::Impact(impact)) => Some((all, impact)),
        _ => None,
    };
    let mut all = impact.map_or_else(Vec::new, |(reference, impact)| {
        behind_shock(scene, reference, impact, profiles, tables)
    });
    if all.is_empty() {
        all.extend(shock_density(profiles));
        let last = tables.last();
        all.extend(last.map(|table| struck_body(scene, table)).unwrap_or_default());
        all.extend(last.map(|table| extremes(table)).unwrap_or_default());
    }
    if let Some((reference, impact)) =
        impact.filter(|(_, i)| scene.face_is_free(i.target, !i.impact.mirrored))
    {
        let found = match scene.dimension {
            1 => histories.and_then(|all| free_surface(all, impact.impact.speed)),
            _ => plane_free_surface(scene, reference, impact, tables),
        };
        all.extend(found.map(|mut velocity| {
            let exact = impact.solution.target_rear.at(velocity.time);
            velocity.exact = exact.map(|point| point.u);
            velocity
        }));
    }
    all
}

/// State behind the target's shock in the last profile that has a plateau.
fn behind_shock(
    scene: &CheckedScene,
    reference: &ReferenceSolution,
    impact: &ImpactReference,
    profiles: &[ProfileSummary],
    tables: &[&ParticleTable],
) -> Vec<MeasuredQuantity> {
    let last = profiles.iter().zip(tables).rev();
    let found =
        last.filter_map(|(profile, table)| Some((profile.error("plateau")?, profile, table)));
    let Some((plateau, profile, table)) = found.into_iter().next() else { return Vec::new() };
    let chain = &impact.chain;
    let Some(state) = chain.states.iter().find(|state| state.number == SHOCKED) else {
        return Vec::new();
    };
    let time = profile.time;
    let one = |name: &str, unit: &str, value: f64, exact: f64| MeasuredQuantity {
        name: name.into(),
        unit: unit.into(),
        time,
        value,
        exact: Some(exact),
    };
    let mut all = vec![one(labels::PRESSURE, "Pa", state.p * (1.0 + plateau), state.p)];
    // along the flyer's motion, with the target at rest
    let way = if impact.impact.mirrored { -1.0 } else { 1.0 };
    let rest = impact.impact.target.velocity;
    let velocity = match scene.dimension {
        1 => velocity_near(table, state.p),
        _ => velocity_along(&reference.particles_along(scene, table), state.p),
    };
    if let Some(velocity) = velocity {
        let name = match rest {
            0.0 => labels::PARTICLE_VELOCITY,
            _ => labels::RELATIVE_VELOCITY,
        };
        all.push(one(name, "m/s", way * (velocity - rest), state.u));
    }
    let shock = chain.waves.iter().find(|w| w.to == SHOCKED && w.plate == Plate::Target);
    let travelled = time - impact.impact.contact_time;
    if let Some(shock) = shock
        && let Some(off) = profile.error("shock_position_cells")
        && travelled > 0.0
    {
        let exact = shock.lagrangian_speed;
        let behind = off * scene.cell_size[0] / travelled;
        all.push(one(labels::SHOCK_SPEED, "m/s", exact + behind, exact));
    }
    all
}

/// Median velocity of the particles whose pressure is close to `pressure` [Pa].
fn velocity_near(table: &ParticleTable, pressure: f64) -> Option<f64> {
    let values = table.column("pressure")?.iter().zip(table.column("velocity")?);
    let near = values.filter(|(p, _)| is_near(**p, pressure));
    median(near.map(|(_, u)| *u).collect())
}

/// Median velocity along a wave of the particles whose pressure is close to `pressure` [Pa].
fn velocity_along(particles: &[AlongWave], pressure: f64) -> Option<f64> {
    median(particles.iter().filter(|q| is_near(q.p, pressure)).map(|q| q.u).collect())
}

/// Whether a pressure is close enough to `exact` to be behind the shock.
fn is_near(pressure: f64, exact: f64) -> bool {
    (pressure / exact - 1.0).abs() < PRESSURE_TOLERANCE
}

/// The upper one of the two middle values, if their number is even; `None` without values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Mean velocity along the waves of the particles at the rear of the target, in a plane, in the last
/// profile. `None` before a wave has reached it, and after releases from the edges have.
fn plane_free_surface(
    scene: &CheckedScene,
    reference: &ReferenceSolution,
    impact: &ImpactReference,
    tables: &[&ParticleTable],
) -> Option<MeasuredQuantity> {
    let (last, table) = tables.iter().enumerate().next_back()?;
    if reference.edge_release_has_come(scene, last) {
        return None;
    }
    let velocity = rear_velocity(
        &reference.particles_along(scene, table),
        impact.impact.mirrored,
        scene.cell_size[0],
    )?;
    let change = (velocity - impact.impact.target.velocity).abs();
    (change > VELOCITY_CHANGE_TOLERANCE * impact.impact.speed).then(|| MeasuredQuantity {
        name: labels::FREE_SURFACE.into(),
        unit: "m/s".into(),
        time: table.time,
        value: velocity,
        exact: None,
    })
}

/// Mean velocity [m/s] of the particles within `cell` [m] of the foremost one; `mirrored`: the waves
/// run to smaller x.
fn rear_velocity(particles: &[AlongWave], mirrored: bool, cell: f64) -> Option<f64> {
    let way = if mirrored { -1.0 } else { 1.0 };
    let front = particles.iter().map(|q| way * q.x).max_by(f64::total_cmp)?;
    let near = particles.iter().filter(|q| way * q.x > front - cell);
    let (count, sum) = near.fold((0.0, 0.0), |(n, sum), q| (n + 1.0, sum + q.u));
    Some(sum / count)
}

/// Density behind the shock of Noh's problem in the last profile that has it.
fn shock_density(profiles: &[ProfileSummary]) -> Option<MeasuredQuantity> {
    profiles.iter().rev().find_map(|profile| {
        let (mean, error) = (profile.error("mean_density")?, profile.error("mean_density_error")?);
        Some(MeasuredQuantity {
            name: labels::DENSITY.into(),
            unit: "kg/m3".into(),
            time: profile.time,
            value: mean,
            exact: Some(mean / (1.0 + error)),
        })
    })
}

/// Length along its motion, and in axial symmetry the diameter, of a body that is alone in a plane
/// and moves along y or x into a rigid side, such as a Taylor bar.
fn struck_body(scene: &CheckedScene, table: &ParticleTable) -> Vec<MeasuredQuantity> {
    let ([body], 2) = (&scene.bodies[..], scene.dimension) else { return Vec::new() };
    let sides = scene.side_properties::<2>();
    let struck = |a: usize| {
        let side = &sides[a][usize::from(body.velocity[a] > 0.0)];
        body.velocity[a] != 0.0 && side.is_rigid()
    };
    let moves = |a: &usize| body.velocity[1 - a] == 0.0 && struck(*a);
    let Some(along) = (0..2).find(moves).filter(|_| scene.has_solids()) else { return Vec::new() };
    let Some(length) = extent(table, along) else { return Vec::new() };
    let one = |name: &str, value: f64| MeasuredQuantity {
        name: name.into(),
        unit: "m".into(),
        time: table.time,
        value,
        exact: None,
    };
    let mut all = vec![one(labels::LENGTH, length[1] - length[0])];
    if let Some(radius) = extent(table, 0).filter(|_| scene.axisymmetric() && along == 1) {
        all.push(one(labels::DIAMETER, 2.0 * radius[1]));
    }
    all
}

/// Least and greatest coordinate in direction `a` of the particles, with their parallelograms [m].
fn extent(table: &ParticleTable, a: usize) -> Option<[f64; 2]> {
    let places = table.column(["x", "y"][a])?.iter().zip(&table.half_edges);
    let ends = places.map(|(x, edges)| {
        let half = edges[0][a].abs() + edges[1][a].abs();
        [x - half, x + half]
    });
    ends.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])])
}

/// Largest pressure, tension and speed of a profile; a tension below [`PRESSURE_TOLERANCE`] of the pressure is
/// left out.
fn extremes(table: &ParticleTable) -> Vec<MeasuredQuantity> {
    let largest = |column: &str, sign: fn(f64) -> f64| {
        table.column(column)?.iter().copied().map(sign).max_by(f64::total_cmp)
    };
    let one = |name: &str, unit: &str, value: Option<f64>| {
        let (name, unit) = (name.into(), unit.into());
        Some(MeasuredQuantity { name, unit, time: table.time, value: value?, exact: None })
    };
    let pressure = largest("pressure", |p| p);
    let tension = largest("pressure", |p| -p);
    let tension = tension.filter(|t| *t > 0.0 && *t > PRESSURE_TOLERANCE * pressure.unwrap_or(0.0));
    let speed = match table.dimension {
        1 => largest("velocity", f64::abs),
        _ => {
            let components = table.column("velocity_x").zip(table.column("velocity_y"));
            let speeds = components.map(|(u, v)| u.iter().zip(v).map(|(u, v)| u.hypot(*v)));
            speeds.and_then(|speeds| speeds.max_by(f64::total_cmp))
        }
    };
    let all = [
        one(labels::LARGEST_PRESSURE, "Pa", pressure.filter(|p| *p > 0.0)),
        one(labels::LARGEST_TENSION, "Pa", tension),
        one(labels::LARGEST_SPEED, "m/s", speed),
    ];
    all.into_iter().flatten().collect()
}

/// Velocity of the free surface when it differs most from that at the start, in the histories of an
/// impact at `speed` [m/s]; `None` before a wave has reached it.
fn free_surface(histories: &HistoryTable, speed: f64) -> Option<MeasuredQuantity> {
    let [times, velocities] = ["time", "free_surface_velocity"].map(|name| histories.column(name));
    let (times, velocities) = (times?, velocities?);
    let start = *velocities.first()?;
    let change = |u: &f64| (u - start).abs();
    let known =
        times.iter().zip(velocities).filter(|(_, u)| u.is_finite() && change(u) > ROUNDING * speed);
    let (time, value) = known.max_by(|a, b| change(a.1).total_cmp(&change(b.1)))?;
    Some(MeasuredQuantity {
        name: labels::FREE_SURFACE.into(),
        unit: "m/s".into(),
        time: *time,
        value: *value,
        exact: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface that moves at the start, is accelerated and slowed down again.
    #[test]
    fn the_free_surface_is_measured_at_its_largest_change() {
        let columns = [("time", "s"), ("free_surface_velocity", "m/s")];
        let mut histories = HistoryTable::new(columns);
        for row in [[0.0, 300.0], [1e-6, 300.0 + 1e-9], [2e-6, -120.0], [3e-6, 250.0]] {
            histories.push(&row);
        }
        let velocity = free_surface(&histories, 500.0).unwrap();
        assert_eq!((velocity.time, velocity.value), (2e-6, -120.0));
        assert!(free_surface(&histories.first(2), 500.0).is_none());
    }

    /// A wave along +x or -x that has passed half of the particles.
    #[test]
    fn a_plane_wave_has_one_velocity_behind_it_and_one_at_the_rear() {
        let particle = |k: usize| {
            let behind = k < 10;
            let (u, p) = if behind { (600.0 + k as f64, 1e10) } else { (2.0 * k as f64, 1e7) };
            AlongWave { x: k as f64, u, p }
        };
        let particles: Vec<AlongWave> = (0..20).map(particle).collect();
        assert_eq!(velocity_along(&particles, 1e10), Some(605.0));
        assert_eq!(velocity_along(&particles, 1e9), None);
        assert_eq!(rear_velocity(&particles, false, 2.0), Some(37.0));
        assert_eq!(rear_velocity(&particles, true, 3.0), Some(601.0));
        assert_eq!(rear_velocity(&[], false, 1.0), None);
    }

    #[test]
    fn the_density_behind_a_shock_stands_beside_the_exact_one() {
        let profile = |errors: serde_json::Value| ProfileSummary {
            time: 0.6,
            file: String::new(),
            state_sha256: String::new(),
            errors: Some(errors),
            errors_cell_averaged: None,
        };
        let noh = profile(serde_json::json!({"mean_density": 14.0, "mean_density_error": -0.125}));
        let density = shock_density(&[noh, profile(serde_json::json!({"l1": 0.1}))]).unwrap();
        assert_eq!((density.value, density.exact), (14.0, Some(16.0)));
    }
}
