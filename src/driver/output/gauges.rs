//! Readings of gauges from their histories: peaks, arrivals, pull-back and spall strength, impulse.

use serde::{Deserialize, Serialize};

use super::histories::HistoryTable;
use crate::accuracy::estimate::ReadingEstimate;

/// A value that is read from the history of a gauge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GaugeReading {
    /// Name of the gauge.
    pub gauge: String,
    /// Quantity in words.
    pub quantity: String,
    /// SI unit of the value.
    pub unit: String,
    /// Value, in the unit of the field `unit`.
    pub value: f64,
    /// Time of the value \[s\]; absent where the value has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

/// Share of the greatest change of a velocity at which a wave counts as arrived [-].
const ARRIVAL: f64 = 0.5;

/// Change of a velocity that is no more than rounding, over its greatest magnitude [-].
const ROUNDING: f64 = 1e-9;

/// Share of the pull-back by which the velocity must rise again [-]; a smaller rise is noise.
const REBOUND: f64 = 0.05;

/// Distance from the peak, over the greatest change of velocity, up to which a velocity belongs to the
/// plateau that the peak is part of [-].
const PLATEAU: f64 = 0.05;

/// The state from which the velocity of a free surface is interpreted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// Density at rest [kg/m3].
    pub density: f64,
    /// Bulk sound speed at rest [m/s].
    pub sound_speed: f64,
}

impl SurfaceMaterial {
    /// Spall strength per pull-back 1/2 rho0 c0 [Pa s/m].
    pub fn strength_per_velocity(&self) -> f64 {
        0.5 * self.density * self.sound_speed
    }
}

/// Readings of a point: the greatest pressure and tension, the greatest change of velocity, and the
/// arrival of the first wave, at which the velocity along x has changed by half of that, interpolated
/// between rows; the plateau, the median of the velocities around the peak that differ from it by less
/// than 5 % of the change. For a free surface of a material also the pull-back, the fall of the velocity
/// between its plateau and the minimum before it rises again, and the spall strength 1/2 rho0 c0 times
/// that (Novikov, Divnov & Ivanov 1966).
pub fn point_readings(
    histories: &HistoryTable,
    gauge: &str,
    surface: Option<SurfaceMaterial>,
) -> Vec<GaugeReading> {
    let column = |name: &str| histories.column(name);
    let named = |what: &str| column(&format!("{gauge}_{what}"));
    let velocity = named("velocity").or_else(|| named("velocity_x"));
    let Some((times, velocity)) = column("time").zip(velocity) else { return Vec::new() };
    let reading = |quantity: &str, unit: &str, value: f64, time: Option<f64>| GaugeReading {
        gauge: gauge.into(),
        quantity: quantity.into(),
        unit: unit.into(),
        value,
        time,
    };
    let mut all = Vec::new();
    if let Some(pressure) = named("pressure") {
        for (quantity, sign) in [("peak pressure", 1.0), ("peak tension", -1.0)] {
            let peak = greatest(times, pressure, |p| sign * p).filter(|peak| peak.1 > 0.0);
            all.extend(peak.map(|(k, value)| reading(quantity, "Pa", value, Some(times[k]))));
        }
    }
    let Some(&start) = velocity.iter().find(|u| u.is_finite()) else { return all };
    let fastest = velocity.iter().filter(|u| u.is_finite()).fold(0.0, |m: f64, u| m.max(u.abs()));
    let peak = greatest(times, velocity, |u| (u - start).abs());
    let Some((peak, change)) = peak.filter(|peak| peak.1 > ROUNDING * fastest) else { return all };
    all.push(reading("peak velocity", "m/s", velocity[peak], Some(times[peak])));
    let share = |k: usize| (velocity[k] - start).abs() / change;
    let reached = (0..=peak).find(|&k| share(k) >= ARRIVAL);
    all.extend(reached.map(|k| {
        let time = match k.checked_sub(1).filter(|&before| share(before).is_finite()) {
            Some(before) => {
                let part = (ARRIVAL - share(before)) / (share(k) - share(before));
                times[before] + part * (times[k] - times[before])
            }
            None => times[k],
        };
        reading("arrival", "s", time, None)
    }));
    let plateau = plateau(velocity, change, peak);
    all.push(reading("plateau velocity", "m/s", plateau, None));
    if let Some((surface, at)) = surface.zip(pull_back(velocity, start, peak)) {
        let fall = (plateau - velocity[at]).abs();
        all.push(reading("pull-back", "m/s", fall, Some(times[at])));
        let strength = surface.strength_per_velocity() * fall;
        all.push(reading("spall strength", "Pa", strength, None));
    }
    all
}

/// Row and value of the greatest of `of` the values; NaN is left out.
fn greatest(times: &[f64], values: &[f64], of: impl Fn(f64) -> f64) -> Option<(usize, f64)> {
    let known = values.iter().take(times.len()).map(|&v| of(v)).enumerate();
    // among equals the first
    known.filter(|(_, v)| !v.is_nan()).reduce(|best, one| if one.1 > best.1 { one } else { best })
}

/// Median of the velocities around row `peak` [m/s]; `change` is the change of velocity there [m/s].
fn plateau(velocity: &[f64], change: f64, peak: usize) -> f64 {
    let near = |u: &f64| (u - velocity[peak]).abs() < PLATEAU * change;
    let before = velocity[..peak].iter().rev().take_while(|u| near(u));
    let mut all: Vec<f64> =
        before.chain(velocity[peak..].iter().take_while(|u| near(u))).copied().collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// Row of the minimum after the peak in row `peak` before the velocity rises again; velocities count
/// from `start` in the direction of the peak.
fn pull_back(velocity: &[f64], start: f64, peak: usize) -> Option<usize> {
    let sign = (velocity[peak] - start).signum();
    let along = |k: usize| sign * (velocity[k] - start);
    let mut lowest = peak;
    for k in peak..velocity.len() {
        if along(k) < along(lowest) {
            lowest = k;
        }
        let fall = along(peak) - along(lowest);
        if fall > REBOUND * along(peak) && along(k) - along(lowest) > REBOUND * fall {
            return Some(lowest);
        }
    }
    None
}

/// Readings of a plane: the impulse that has crossed it, which is the change of the momentum beyond.
pub fn plane_readings(histories: &HistoryTable, gauge: &str) -> Vec<GaugeReading> {
    let momentum = histories.column(&format!("{gauge}_momentum"));
    let ends = momentum.and_then(|all| Some((all.first()?, all.last()?)));
    let time = histories.column("time").and_then(|all| all.last().copied());
    let impulse = ends.map(|(first, last)| GaugeReading {
        gauge: gauge.into(),
        quantity: "impulse".into(),
        unit: "N s".into(),
        value: last - first,
        time,
    });
    impulse.into_iter().collect()
}

/// The readings as lines of a report, with their `errors` where these are estimated.
pub fn report(readings: &[GaugeReading], errors: &[ReadingEstimate]) -> String {
    let line = |r: &GaugeReading| {
        let at = r.time.map_or(String::new(), |time| format!(" at {time:.4e} s"));
        let error = errors.iter().find(|e| (&e.gauge, &e.quantity) == (&r.gauge, &r.quantity));
        let half_width = error.and_then(|error| error.value.half_width);
        let error = half_width.map_or(String::new(), |w| format!(" +- {w:.1e} (guess)"));
        format!("  {}: {} {:.5e} {}{error}{at}\n", r.gauge, r.quantity, r.value, r.unit)
    };
    readings.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[[f64; 3]]) -> HistoryTable {
        let mut table =
            HistoryTable::new([("time", "s"), ("rear_velocity", "m/s"), ("rear_pressure", "Pa")]);
        rows.iter().for_each(|row| table.push(row));
        table
    }

    /// A surface at -20 m/s that is accelerated to 180 m/s, pulled back to 100 m/s, and rises again.
    #[test]
    fn a_free_surface_has_arrival_peak_and_pull_back() {
        let u = [-20.0, -20.0, 30.0, 180.0, 180.0, 150.0, 100.0, 120.0, 110.0];
        let rows: Vec<[f64; 3]> =
            u.iter().enumerate().map(|(k, &u)| [k as f64, u, 1e9 - 1e9 * k as f64]).collect();
        let surface = SurfaceMaterial { density: 2700.0, sound_speed: 5000.0 };
        let all = point_readings(&table(&rows), "rear", Some(surface));
        let of = |name: &str| {
            let reading = all.iter().find(|r| r.quantity == name).unwrap();
            (reading.value, reading.time)
        };
        assert_eq!(of("peak velocity"), (180.0, Some(3.0)));
        // half of the change of 200 m/s is reached at 80 m/s, a third of the way from row 2 to 3
        assert!((of("arrival").0 - (2.0 + 1.0 / 3.0)).abs() < 1e-12);
        assert_eq!(of("plateau velocity"), (180.0, None));
        assert_eq!(of("pull-back"), (80.0, Some(6.0)));
        assert_eq!(of("spall strength"), (0.5 * 2700.0 * 5000.0 * 80.0, None));
        assert_eq!(of("peak pressure"), (1e9, Some(0.0)));
        assert_eq!(of("peak tension"), (7e9, Some(8.0)));
        // in the other direction
        let turned: Vec<[f64; 3]> = rows.iter().map(|r| [r[0], -r[1], r[2]]).collect();
        let turned = point_readings(&table(&turned), "rear", Some(surface));
        assert!(turned.iter().any(|r| r.quantity == "pull-back" && r.value == 80.0));
        let text = report(&all, &[]);
        assert!(text.contains("rear: pull-back 8.00000e1 m/s at 6.0000e0 s"), "{text}");
    }

    #[test]
    fn a_fall_without_a_rise_is_no_pull_back() {
        let falls = [[0.0, 0.0, 0.0], [1.0, 100.0, 0.0], [2.0, 50.0, 0.0], [3.0, 20.0, 0.0]];
        let surface = SurfaceMaterial { density: 1.0, sound_speed: 1.0 };
        let all = point_readings(&table(&falls), "rear", Some(surface));
        assert!(all.iter().all(|r| r.quantity != "pull-back"), "{all:?}");
        // a surface at rest has neither peak nor arrival
        let rest = [[0.0, 5.0, f64::NAN], [1.0, 5.0, f64::NAN]];
        assert!(point_readings(&table(&rest), "rear", None).is_empty());
    }

    #[test]
    fn impulse_is_the_change_of_momentum() {
        let mut table = HistoryTable::new([("time", "s"), ("a_momentum", "kg m/s")]);
        table.push(&[0.0, 2.0]);
        table.push(&[1.0, 5.5]);
        let all = plane_readings(&table, "a");
        assert_eq!((all[0].value, all[0].time), (3.5, Some(1.0)));
    }
}
