//! Physical quantities of a run beside their exact values: pressure and velocity behind the shock,
//! shock speed, velocity of the free surface.

use super::output::histories::HistoryTable;
use super::output::summary::{MeasuredQuantity, ProfileSummary};
use crate::accuracy::reference::{ImpactReference, ReferenceSolution};
use crate::exact::Plate;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Number of the state behind the first shock in the chain of states.
const SHOCKED: usize = 2;

/// Difference from the exact pressure up to which a particle counts as behind the shock [-].
const NEAR: f64 = 0.02;

/// Change of a velocity that is no more than rounding, over the impact speed [-].
const ROUNDING: f64 = 1e-6;

/// Quantities of a run on a line; empty in a plane. Without an exact solution of an impact, they are
/// the largest pressure, tension and speed of the last profile.
pub fn quantities(
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    profiles: &[ProfileSummary],
    tables: &[&ParticleTable],
    histories: Option<&HistoryTable>,
) -> Vec<MeasuredQuantity> {
    if scene.dimension > 1 {
        return Vec::new();
    }
    let impact = match reference {
        Some(ReferenceSolution::Impact(impact)) => Some(impact),
        _ => None,
    };
    let mut all =
        impact.map_or_else(Vec::new, |impact| behind_shock(scene, impact, profiles, tables));
    if all.is_empty() {
        all = tables.last().map(|table| extremes(table)).unwrap_or_default();
    }
    if let Some(impact) = impact.filter(|i| scene.face_is_free(i.target, !i.impact.mirrored)) {
        all.extend(histories.and_then(|all| free_surface(all, impact.impact.speed)).map(
            |mut velocity| {
                let exact = impact.solution.target_rear.at(velocity.time);
                velocity.exact = exact.map(|point| point.u);
                velocity
            },
        ));
    }
    all
}

/// State behind the target's shock in the last profile that has a plateau.
fn behind_shock(
    scene: &CheckedScene,
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
    let mut all = vec![one("pressure behind shock", "Pa", state.p * (1.0 + plateau), state.p)];
    // along the flyer's motion, with the target at rest
    let way = if impact.impact.mirrored { -1.0 } else { 1.0 };
    let rest = impact.impact.target.velocity;
    if let Some(velocity) = velocity_near(table, state.p) {
        let name = match rest {
            0.0 => "particle velocity",
            _ => "velocity relative to target",
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
        all.push(one("mean shock speed", "m/s", exact + behind, exact));
    }
    all
}

/// Median velocity of the particles whose pressure is close to `pressure` [Pa].
fn velocity_near(table: &ParticleTable, pressure: f64) -> Option<f64> {
    let values = table.column("pressure")?.iter().zip(table.column("velocity")?);
    let near = values.filter(|(p, _)| (*p / pressure - 1.0).abs() < NEAR);
    let mut near: Vec<f64> = near.map(|(_, u)| *u).collect();
    near.sort_by(f64::total_cmp);
    near.get(near.len() / 2).copied()
}

/// Largest pressure, tension and speed of a profile; a tension below [`NEAR`] of the pressure is
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
    let tension = tension.filter(|t| *t > 0.0 && *t > NEAR * pressure.unwrap_or(0.0));
    let speed = largest("velocity", f64::abs);
    let all = [
        one("largest pressure", "Pa", pressure.filter(|p| *p > 0.0)),
        one("largest tension", "Pa", tension),
        one("largest speed", "m/s", speed),
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
        name: "free-surface velocity".into(),
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
    fn the_free_surface_is_told_at_its_largest_change() {
        let columns = [("time", "s"), ("free_surface_velocity", "m/s")];
        let mut histories = HistoryTable::new(columns);
        for row in [[0.0, 300.0], [1e-6, 300.0 + 1e-9], [2e-6, -120.0], [3e-6, 250.0]] {
            histories.push(&row);
        }
        let told = free_surface(&histories, 500.0).unwrap();
        assert_eq!((told.time, told.value), (2e-6, -120.0));
        assert!(free_surface(&histories.first(2), 500.0).is_none());
    }
}
