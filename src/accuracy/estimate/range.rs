//! The range of impacts used to fit the error models, and the inputs of a scene outside of it.
//!
//! Outside of this range an estimate is a guess. The range is part of `laws.json`, written by the
//! program that draws the impacts. All inputs that the draw varies or holds fixed are checked.

use serde::{Deserialize, Serialize};

use super::fitted_schemes::FittedSchemes;
use super::impact_waves::{ImpactWaves, PlateauLeft};
use super::surroundings::surroundings;
use super::within::check;
use crate::scene::CheckedScene;

/// Basis of an estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EstimateBasis {
    /// The inputs are within the range of the fit.
    Calibrated,
    /// The inputs are outside of the range of the fit.
    #[default]
    Guess,
}

/// The range of impacts of the fit and its validation: a flyer on a target at rest, both fluids
/// with a straight Us-up line. Smallest and largest values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedRange {
    /// Density of a material \[kg/m3\].
    pub density: [f64; 2],
    /// Bulk sound speed c0 \[m/s\].
    pub c0: [f64; 2],
    /// Slope s of the Us-up line \[-\].
    pub s: [f64; 2],
    /// Grueneisen coefficient \[-\].
    pub gamma0: [f64; 2],
    /// Impact speed \[m/s\].
    pub speed: [f64; 2],
    /// Thickness of the flyer \[cells\].
    pub flyer_cells: [f64; 2],
    /// Time of a profile over the time at which the release from the rear of the flyer reaches the
    /// interface \[-\].
    pub duration: [f64; 2],
    /// Depth of an arrival position over the distance of the shock at the end of the run \[-\].
    pub place: [f64; 2],
    /// Schemes.
    pub schemes: FittedSchemes,
}

/// Inputs of a scene outside of the range, one line each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutOfRange {
    /// Inputs of the whole scene.
    pub scene: Vec<String>,
    /// One entry per profile.
    pub profiles: Vec<Option<String>>,
    /// One entry per arrival position.
    pub arrivals: Vec<Option<String>>,
}

impl OutOfRange {
    /// Basis of the whole estimate.
    pub fn basis(&self) -> EstimateBasis {
        EstimateBasis::of(self.lines().is_empty())
    }

    /// Basis of profile number `k`.
    pub fn of_profile(&self, k: usize) -> EstimateBasis {
        EstimateBasis::of(self.scene.is_empty() && self.profiles.get(k).is_none_or(Option::is_none))
    }

    /// Basis of arrival number `k`.
    pub fn of_arrival(&self, k: usize) -> EstimateBasis {
        EstimateBasis::of(self.scene.is_empty() && self.arrivals.get(k).is_none_or(Option::is_none))
    }

    /// All lines.
    pub fn lines(&self) -> Vec<String> {
        let each = self.profiles.iter().chain(&self.arrivals).flatten();
        self.scene.iter().chain(each).cloned().collect()
    }
}

impl EstimateBasis {
    fn of(fitted: bool) -> EstimateBasis {
        if fitted { EstimateBasis::Calibrated } else { EstimateBasis::Guess }
    }
}

impl FittedRange {
    /// The inputs of a scene on a line that are outside of the range, for estimates of `body`.
    pub fn outside(&self, scene: &CheckedScene, body: usize) -> OutOfRange {
        let mut found = OutOfRange { scene: self.schemes.outside(scene), ..OutOfRange::default() };
        found.scene.extend(surroundings(scene));
        for line in (0..scene.bodies.len()).flat_map(|b| self.material(scene, b)) {
            // both bodies may have the same material
            if !found.scene.contains(&line) {
                found.scene.push(line);
            }
        }
        let [_, _] = scene.bodies[..] else {
            let count = scene.bodies.len();
            found.scene.push(format!("bodies: {count}: fitted on a flyer and a target"));
            return found;
        };
        if let Err(line) = self.impact(scene, body, &mut found) {
            found.scene.push(line);
        }
        let flyer = &scene.bodies[1 - body];
        let cells = (flyer.upper[0] - flyer.lower[0]) / scene.cell_size[0];
        let what = format!("cells in body {}", scene.scene.bodies[1 - body].name);
        found.scene.extend(check(what, cells, self.flyer_cells));
        found
    }

    /// Checks the material of a body and its initial state.
    fn material(&self, scene: &CheckedScene, b: usize) -> Vec<String> {
        let (body, material) = (&scene.scene.bodies[b], scene.material_of(b));
        let name = &body.material;
        let mut found = Vec::new();
        let mut not = |is: bool, key: &str| {
            if is {
                found.push(format!("materials.{name}.{key}: not in the fit"));
            }
        };
        not(material.strength.is_some(), "strength");
        not(material.failure.is_some(), "failure");
        not(material.erosion.is_some(), "erosion");
        not(material.thermal.is_some(), "thermal");
        match material.eos.straight(material.density) {
            None => not(true, "eos"),
            Some(m) => {
                let all = [
                    ("density", m.rho0, self.density),
                    ("eos.c0", m.c0, self.c0),
                    ("eos.s", m.s, self.s),
                    ("eos.gamma0", m.gamma0, self.gamma0),
                ];
                let outside = all.iter().filter_map(|(key, v, range)| {
                    check(format!("materials.{name}.{key}"), *v, *range)
                });
                found.extend(outside);
            }
        }
        let own = [
            ("pressure", body.pressure != 0.0),
            ("temperature", body.temperature.is_some()),
            ("velocity_field", body.velocity_field.is_some()),
        ];
        let outside = own.iter().filter(|(_, is)| *is);
        found.extend(outside.map(|(key, _)| format!("bodies.{}.{key}: not in the fit", body.name)));
        found
    }

    /// Checks speed, times and positions of the impact of the other body on `body`. The error is
    /// the line if there is no such impact.
    fn impact(
        &self,
        scene: &CheckedScene,
        body: usize,
        found: &mut OutOfRange,
    ) -> Result<(), String> {
        let named = |b: usize| scene.scene.bodies[b].name.clone();
        let (flyer, target) = (&scene.bodies[1 - body], &scene.bodies[body]);
        if target.top_speed != 0.0 {
            return Err(format!("bodies.{}.velocity: fitted on a target at rest", named(body)));
        }
        let apart = (target.lower[0] - flyer.upper[0]).max(flyer.lower[0] - target.upper[0]);
        if apart > 1e-6 * scene.cell_size[0] {
            return Err("bodies: a gap: fitted on plates that touch".into());
        }
        let speed = flyer.velocity[0] * (target.lower[0] - flyer.lower[0]).signum();
        let velocity = format!("bodies.{}.velocity", named(1 - body));
        if let Some(line) = check(&velocity, speed, self.speed) {
            return Err(line);
        }
        // for other materials, no exact release time is available
        let Some(waves) = ImpactWaves::new(scene, body) else {
            let named = !found.scene.is_empty();
            return if named { Ok(()) } else { Err("bodies: no plain impact".into()) };
        };
        let release = &waves.release;
        let profile = |(k, &t): (usize, &f64)| {
            let what = format!("output.profiles.times[{k}] over {:.4e} s", release.head_time);
            let late = || format!("output.profiles.times[{k}]: the shock has crossed the target");
            let crossed = waves.plateau(t) == PlateauLeft::Unknown;
            check(what, t / release.head_time, self.duration).or_else(|| crossed.then(late))
        };
        found.profiles = scene.profile_times.iter().enumerate().map(profile).collect();
        let at_lower = flyer.lower[0] < target.lower[0];
        let arrivals = scene.scene.error_estimate.iter().flat_map(|e| &e.arrivals);
        let range = [self.place[0] * self.duration[0], self.place[1] * self.duration[1]];
        let arrival = |(k, &at): (usize, &f64)| {
            let depth = if at_lower { at - target.lower[0] } else { target.upper[0] - at };
            let reach = release.target_shock * release.head_time;
            check(format!("error_estimate.arrivals[{k}] over {reach:.4e} m"), depth / reach, range)
        };
        found.arrivals = arrivals.enumerate().map(arrival).collect();
        Ok(())
    }
}
