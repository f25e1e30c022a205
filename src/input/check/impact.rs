//! Impacts that compress a material beyond the limit of its Hugoniot.
//!
//! Behind a shock with the particle velocity up into material at rest, 1 - rho0/rho = up/(c0 + s
//! up), which is always below 1/s (Meyers 1994, eq. 4.9 with Us = c0 + s up). The common pressure
//! of two bodies is that at which their particle velocities add up to the impact speed. Initial
//! pressures and reflected waves are neglected. An ideal gas has no such limit, and a body that
//! strikes one is not checked.

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use crate::scene::CheckedScene;
use crate::scene::Eos;

/// Maximum compression of an impact, both by itself and over s [-].
const MOST_COMPRESSION: f64 = 0.95;

/// Linear Hugoniot P = rho0 (c0 + s up) up.
#[derive(Clone, Copy)]
struct LinearHugoniot {
    rho0: f64,
    c0: f64,
    s: f64,
}

impl LinearHugoniot {
    fn pressure(&self, up: f64) -> f64 {
        self.rho0 * (self.c0 + self.s * up) * up
    }

    fn particle_velocity(&self, pressure: f64) -> f64 {
        let q = pressure / self.rho0;
        2.0 * q / (self.c0 + (self.c0 * self.c0 + 4.0 * self.s * q).sqrt())
    }

    fn most_compression(&self) -> f64 {
        MOST_COMPRESSION.min(MOST_COMPRESSION / self.s)
    }

    /// Particle velocity at the limit [m/s].
    fn most_particle_velocity(&self) -> f64 {
        let chi = self.most_compression();
        chi * self.c0 / (1.0 - self.s * chi)
    }
}

/// Impact of a body on another body or a wall.
struct ScoredImpact<'a> {
    body: usize,
    /// Index of the other body; `None`: a rigid wall.
    other: Option<usize>,
    name: &'a str,
    speed: f64,
    gap: f64,
}

/// Checks that a scene that smooths impacts has one that starts at once, on a line.
pub(super) fn check_smoothing(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(cells) = checked.scene.impact_smoothing else { return Ok(()) };
    let count = checked.bodies.len();
    let mut pairs = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
    if checked.dimension == 1 && pairs.any(|(a, b)| checked.strikes(a, b)) {
        return Ok(());
    }
    let reason = "there is no impact that it can smooth; allowed: to leave it out, or one dimension and \
                  two bodies that touch and approach each other";
    Err(SceneFault::new("impact_smoothing", cells, reason))
}

/// Checks every impact before the end of the run against the limit; warns of gaps between bodies.
pub(super) fn check(checked: &mut CheckedScene) -> Result<(), Faults> {
    let mut warnings = Vec::new();
    let mut faults = Faults::default();
    for impact in impacts(checked) {
        let &ScoredImpact { body, other, speed, gap, .. } = &impact;
        if speed <= 0.0 || gap.max(0.0) / speed > checked.scene.time.end {
            continue;
        }
        faults.take(check_impact(checked, &impact));
        if let Some(other) = other
            && checked.velocity_fields() == 1
            && gap > checked.tolerance(0)
        {
            let [a, b] = [body, other].map(|i| join("bodies", &checked.scene.bodies[i].name));
            warnings.push(format!(
                "{a}, {b}: a gap of {gap:e} m closes during the run; without contact they meet \
                 through the grid, a cell or two early"
            ));
        }
    }
    checked.warnings.extend(warnings);
    faults.ok_or_faults(())
}

/// Impacts of neighbours along x, and of the outer bodies on walls; one dimension only.
fn impacts(checked: &CheckedScene) -> Vec<ScoredImpact<'_>> {
    let scene = &checked.scene;
    let bodies = &scene.bodies;
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| checked.bodies[a].lower[0].total_cmp(&checked.bodies[b].lower[0]));
    let pair = |a: usize, b: usize, shift: f64| ScoredImpact {
        body: a,
        other: Some(b),
        name: &bodies[b].name,
        speed: checked.bodies[a].velocity[0] - checked.bodies[b].velocity[0],
        gap: checked.bodies[b].lower[0] + shift - checked.bodies[a].upper[0],
    };
    let mut impacts: Vec<_> = order.windows(2).map(|w| pair(w[0], w[1], 0.0)).collect();
    let (first, last) = (order[0], order[order.len() - 1]);
    if scene.boundary.as_ref().is_some_and(|b| b.x_lower.properties().is_periodic()) {
        impacts.push(pair(last, first, scene.domain.upper[0] - scene.domain.lower[0]));
    }
    for wall in checked.walls() {
        let body = if wall.upper { last } else { first };
        impacts.push(ScoredImpact {
            body,
            other: None,
            name: wall.path(),
            speed: checked.closing_speed(&wall, body),
            gap: checked.gap_to(&wall, body),
        });
    }
    impacts
}

fn check_impact(checked: &CheckedScene, impact: &ScoredImpact) -> Result<(), SceneFault> {
    // a curved Hugoniot has its own limit, reported by its own fault
    let hugoniot = |i: usize| match &checked.material_of(i).eos {
        Eos::MieGruneisen(solid) if solid.s2 == 0.0 => {
            let rho0 = checked.material_of(i).density;
            Some(LinearHugoniot { rho0, c0: solid.c0, s: solid.s })
        }
        _ => None,
    };
    let Some(own) = hugoniot(impact.body) else { return Ok(()) };
    let other = match impact.other {
        None => None,
        Some(i) => match hugoniot(i) {
            Some(other) => Some((i, other)),
            None => return Ok(()),
        },
    };
    // the material that reaches its limit at the lower pressure determines the speed
    let limit = |h: LinearHugoniot| h.pressure(h.most_particle_velocity());
    let (weaker, chi, most) = match other {
        None => (impact.body, own.most_compression(), own.most_particle_velocity()),
        Some((i, other)) => {
            let weaker = if limit(own) <= limit(other) { (impact.body, own) } else { (i, other) };
            let pressure = limit(weaker.1);
            let most = own.particle_velocity(pressure) + other.particle_velocity(pressure);
            (weaker.0, weaker.1.most_compression(), most)
        }
    };
    if impact.speed <= most {
        return Ok(());
    }
    // report the velocity of the moving body: a body at rest is struck by the other one
    let moving = match impact.other {
        Some(other) if checked.bodies[impact.body].velocity[0] == 0.0 => other,
        _ => impact.body,
    };
    let against = if moving == impact.body {
        impact.name
    } else {
        checked.scene.bodies[impact.body].name.as_str()
    };
    // hundreds of digits are not helpful
    let speed = match impact.speed {
        speed if speed < 1e9 => format!("{speed}"),
        speed => format!("{speed:e}"),
    };
    let reason = format!(
        "an impact on {against} at {speed} m/s compresses {} past {chi:.4}, the lesser of 0.95 and \
         0.95/s; allowed: at most {most:.0} m/s",
        checked.scene.bodies[weaker].material
    );
    let path = join(&join("bodies", &checked.scene.bodies[moving].name), "velocity");
    Err(SceneFault::new(path, &checked.bodies[moving].velocity, reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALUMINIUM: LinearHugoniot = LinearHugoniot { rho0: 2785.0, c0: 5386.0, s: 1.339 };

    #[test]
    fn particle_velocity_is_the_inverse_of_pressure() {
        for up in [1e-3, 690.9, 2e4] {
            let back = ALUMINIUM.particle_velocity(ALUMINIUM.pressure(up));
            assert!((back / up - 1.0).abs() < 1e-14, "{up}: {back}");
        }
    }

    #[test]
    fn the_limit_is_reached_at_its_particle_velocity() {
        for s in [0.5, 1.0, 1.339] {
            let h = LinearHugoniot { s, ..ALUMINIUM };
            let up = h.most_particle_velocity();
            assert!((up / (h.c0 + s * up) / h.most_compression() - 1.0).abs() < 1e-13);
        }
    }
}
