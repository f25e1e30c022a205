//! Impacts that compress a material past what its Hugoniot holds.
//!
//! Behind a shock that gives the particle velocity up to material at rest,
//! 1 - rho0/rho = up/(c0 + s up), which never passes 1/s (Meyers 1994, eq. 4.9 with
//! Us = c0 + s up). The common pressure of two bodies is that at which their particle velocities
//! add up to the speed of impact. Initial pressures and reflected waves are left out of account;
//! an ideal gas has no such limit, and a body that strikes one is not examined.

use super::super::errors::Fault;
use super::super::model::{Eos, Side};
use super::super::validate::join;
use super::CheckedScene;

/// Compression that no impact may pass, alone and over s [-].
const MOST_COMPRESSION: f64 = 0.95;

/// P = rho0 (c0 + s up) up.
#[derive(Clone, Copy)]
struct Hugoniot {
    rho0: f64,
    c0: f64,
    s: f64,
}

impl Hugoniot {
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

    /// The particle velocity that reaches the limit [m/s].
    fn most_particle_velocity(&self) -> f64 {
        let chi = self.most_compression();
        chi * self.c0 / (1.0 - self.s * chi)
    }
}

/// What a body runs into.
struct Impact<'a> {
    body: usize,
    /// The other body; none: a rigid wall.
    other: Option<usize>,
    name: &'a str,
    speed: f64,
    gap: f64,
}

/// Every impact that happens before the end is held against the limit; bodies with a gap
/// between them are warned of.
pub(super) fn check(checked: &mut CheckedScene) -> Result<(), Fault> {
    let mut warnings = Vec::new();
    for impact in impacts(checked) {
        let &Impact { body, other, speed, gap, .. } = &impact;
        if speed <= 0.0 || gap.max(0.0) / speed > checked.scene.time.end {
            continue;
        }
        check_impact(checked, &impact)?;
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
    Ok(())
}

/// Neighbours along x, and the walls beside the outer ones; only one dimension is built.
fn impacts(checked: &CheckedScene) -> Vec<Impact<'_>> {
    let scene = &checked.scene;
    let bodies = &scene.bodies;
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| checked.bodies[a].lower[0].total_cmp(&checked.bodies[b].lower[0]));
    let pair = |a: usize, b: usize, shift: f64| Impact {
        body: a,
        other: Some(b),
        name: &bodies[b].name,
        speed: checked.bodies[a].velocity[0] - checked.bodies[b].velocity[0],
        gap: checked.bodies[b].lower[0] + shift - checked.bodies[a].upper[0],
    };
    let mut impacts: Vec<_> = order.windows(2).map(|w| pair(w[0], w[1], 0.0)).collect();
    let (first, last) = (order[0], order[order.len() - 1]);
    if scene.boundary.as_ref().is_some_and(|b| b.x_lower == Side::Periodic) {
        impacts.push(pair(last, first, scene.domain.upper[0] - scene.domain.lower[0]));
    }
    for wall in checked.walls() {
        let body = if wall.upper { last } else { first };
        impacts.push(Impact {
            body,
            other: None,
            name: wall.path(),
            speed: checked.closing_speed(&wall, body),
            gap: checked.gap_to(&wall, body),
        });
    }
    impacts
}

fn check_impact(checked: &CheckedScene, impact: &Impact) -> Result<(), Fault> {
    // a curved Hugoniot has a limit of its own, which its fault tells of
    let hugoniot = |i: usize| match checked.material_of(i).eos {
        Eos::MieGruneisen { c0, s, s2: 0.0, .. } => {
            Some(Hugoniot { rho0: checked.material_of(i).density, c0, s })
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
    // the one that reaches its limit at the lesser pressure sets the speed
    let limit = |h: Hugoniot| h.pressure(h.most_particle_velocity());
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
    // a body that no velocity was given to is struck by one that has one
    let moving = match impact.other {
        Some(other) if checked.bodies[impact.body].velocity[0] == 0.0 => other,
        _ => impact.body,
    };
    let against = if moving == impact.body {
        impact.name
    } else {
        checked.scene.bodies[impact.body].name.as_str()
    };
    // a number of hundreds of digits is no help
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
    Err(Fault::new(path, &checked.bodies[moving].velocity, reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALUMINIUM: Hugoniot = Hugoniot { rho0: 2785.0, c0: 5386.0, s: 1.339 };

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
            let h = Hugoniot { s, ..ALUMINIUM };
            let up = h.most_particle_velocity();
            assert!((up / (h.c0 + s * up) / h.most_compression() - 1.0).abs() < 1e-13);
        }
    }
}
