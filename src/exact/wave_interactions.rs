//! The solution of Burghardt (2010): a chain of impedance matches, in which each rarefaction is
//! treated as a shock that runs back along the Hugoniot.
//!
//! Frame: flyer [-L, 0] at +U, target [0, inf) at rest, contact at t = 0. The Hugoniot of a
//! material about (u0, P = 0) is P = rho0 (C0 + S w) w, with w = u - u0 for right-going and u0 - u
//! for left-going waves. States: 0 target, 1 flyer, even numbers at the interface, odd numbers at
//! the flyer's free rear. Source: Burghardt (2010), Shock wave propagation verification test of the
//! Uintah MPM code, section 2; its eq. 3 lacks rho0.
//!
//! Wave speeds are Lagrangian (relative to the undeformed material). They follow from the chord of
//! the curve between the two states: C0 + S (ua + ub - 2 u0). Compressions follow from the mass
//! jump across each wave. The solution holds until a later wave in the target overtakes an earlier
//! one ([`Chain::valid_until`]). It neglects the change of entropy, which is cubic in the strength
//! of the shock.

use super::{ExactError, Plate, Profile, ProfilePoint, finite, positive};
use crate::material::MieGruneisen;

/// Kind of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveKind {
    /// Pressure rises across it.
    Shock,
    /// Pressure falls across it.
    Rarefaction,
}

/// A state of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainState {
    /// Number of the state in Burghardt (2010).
    pub number: usize,
    /// Pressure [Pa].
    pub p: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Density in the flyer [kg/m3]; `None` if the flyer is never in this state.
    pub rho_flyer: Option<f64>,
    /// Density in the target [kg/m3]; `None` if the target is never in this state.
    pub rho_target: Option<f64>,
}

/// A wave of the chain, a straight line in the x-t diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainWave {
    /// Plate in which the wave runs.
    pub plate: Plate,
    /// Shock or rarefaction.
    pub kind: WaveKind,
    /// Number of the state ahead.
    pub from: usize,
    /// Number of the state behind.
    pub to: usize,
    /// Speed relative to the undeformed material [m/s], positive.
    pub lagrangian_speed: f64,
    /// Whether the wave runs towards -x.
    pub leftward: bool,
    /// Time [s] and position [m] of its start.
    pub start: [f64; 2],
    /// Time [s] and position [m] of its end; `None` in the target, where the wave continues.
    pub end: Option<[f64; 2]>,
    /// Speed in space, dx/dt [m/s].
    pub velocity: f64,
}

/// The chain of wave interactions, with rarefactions treated as shocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// States, sorted by number.
    pub states: Vec<ChainState>,
    /// Waves, sorted by the time of their start.
    pub waves: Vec<ChainWave>,
    /// Whether the plates separate: the pressure of state 4 would be negative, since state 3 has
    /// u < 0 (softer flyer). State 4 then belongs to the target alone, at P = 0, and the flyer
    /// stays in state 3.
    pub separates: bool,
    /// Time of separation of the plates [s].
    pub separation_time: Option<f64>,
    /// Time at which a later wave of the target overtakes an earlier one [s].
    pub valid_until: f64,
    /// Density of the target at rest [kg/m3].
    target_density: f64,
    /// Corner points of the interface's path: time [s], position [m]. After separation the path is
    /// that of the target's face.
    interface: Vec<[f64; 2]>,
}

/// Pressure of the right-going Hugoniot about (`u0`, 0) at velocity `u` [Pa].
pub fn hugoniot_right(m: &MieGruneisen, u0: f64, u: f64) -> f64 {
    m.rho0 * (m.c0 + m.s * (u - u0)) * (u - u0)
}

/// Pressure of the left-going Hugoniot about (`u0`, 0) at velocity `u` [Pa].
pub fn hugoniot_left(m: &MieGruneisen, u0: f64, u: f64) -> f64 {
    hugoniot_right(m, -u0, -u)
}

/// The velocity u0 about which the right-going Hugoniot passes through (`u`, `p`) [m/s].
pub fn centre_right(m: &MieGruneisen, p: f64, u: f64) -> f64 {
    u - velocity_jump(m, p)
}

/// The velocity u0 about which the left-going Hugoniot passes through (`u`, `p`) [m/s].
pub fn centre_left(m: &MieGruneisen, p: f64, u: f64) -> f64 {
    u + velocity_jump(m, p)
}

/// The positive root w of P = rho0 (C0 + S w) w [m/s].
pub(super) fn velocity_jump(m: &MieGruneisen, p: f64) -> f64 {
    let b = m.rho0 * m.c0;
    2.0 * p / (b + (b * b + 4.0 * m.rho0 * m.s * p).sqrt())
}

/// Velocity [m/s] at which the right-going Hugoniot of `target` about (0, 0) meets the left-going
/// Hugoniot of `flyer` about (`speed`, 0).
pub(super) fn impedance_match(flyer: &MieGruneisen, target: &MieGruneisen, speed: f64) -> f64 {
    let a = target.rho0 * target.s - flyer.rho0 * flyer.s;
    let b = target.rho0 * target.c0 + flyer.rho0 * (flyer.c0 + 2.0 * flyer.s * speed);
    let c = flyer.rho0 * speed * (flyer.c0 + flyer.s * speed);
    2.0 * c / (b + (b * b + 4.0 * a * c).sqrt())
}

/// Refuses constants and impacts outside of the range of the equation of state.
pub(super) fn check(
    flyer: &MieGruneisen,
    target: &MieGruneisen,
    speed: f64,
    thickness: f64,
) -> Result<(), ExactError> {
    positive("the speed of impact", speed)?;
    positive("the flyer's thickness", thickness)?;
    for m in [flyer, target] {
        positive("rho0", m.rho0)?;
        positive("c0", m.c0)?;
        positive("s", m.s)?;
        finite("gamma0", m.gamma0)?;
    }
    let u = impedance_match(flyer, target, speed);
    for (m, w) in [(flyer, speed - u), (target, u)] {
        let chi = w / (m.c0 + m.s * w);
        if !(chi < 0.95 && chi * m.s < 0.95) {
            return Err(ExactError::State {
                what: "the impact compresses past 0.95 or 0.95/s",
                chi,
            });
        }
    }
    Ok(())
}

impl Chain {
    /// The chain up to the state number `last_state`, at least 2, of an impact at `speed` [m/s] of
    /// a flyer of `thickness` [m]. It ends earlier if the plates separate or come to rest.
    ///
    /// # Errors
    ///
    /// If a constant is out of range, or if a material cannot reach a state.
    pub fn new(
        flyer: MieGruneisen,
        target: MieGruneisen,
        speed: f64,
        thickness: f64,
        last_state: usize,
    ) -> Result<Chain, ExactError> {
        check(&flyer, &target, speed, thickness)?;
        let mut chain = Chain {
            states: vec![
                ChainState {
                    number: 0,
                    p: 0.0,
                    u: 0.0,
                    rho_flyer: None,
                    rho_target: Some(target.rho0),
                },
                ChainState {
                    number: 1,
                    p: 0.0,
                    u: speed,
                    rho_flyer: Some(flyer.rho0),
                    rho_target: None,
                },
            ],
            waves: Vec::new(),
            separates: false,
            separation_time: None,
            valid_until: f64::INFINITY,
            target_density: target.rho0,
            interface: vec![[0.0, 0.0]],
        };
        let mut t = 0.0;
        let (mut face, mut rear) = (0.0, -thickness); // positions of the flyer's faces
        let (mut ahead_u, mut ahead_chi) = (0.0, 0.0); // state of the target ahead of the next wave
        let mut flyer_u = speed;
        for number in (2..=last_state.max(2)).step_by(2) {
            let parts = flyer_u < 0.0;
            let u = if parts { 0.0 } else { impedance_match(&flyer, &target, flyer_u) };
            // the wave into the target
            let kind = if u > ahead_u { WaveKind::Shock } else { WaveKind::Rarefaction };
            let w = target.c0 + target.s * (u + ahead_u);
            let ahead = if number == 2 { 0 } else { number - 2 };
            let velocity = ahead_u + (1.0 - ahead_chi) * w;
            chain.push(ChainWave {
                plate: Plate::Target,
                kind,
                from: ahead,
                to: number,
                lagrangian_speed: w,
                leftward: false,
                start: [t, face],
                end: None,
                velocity,
            });
            ahead_chi += (u - ahead_u) / w;
            ahead_u = u;
            let p = hugoniot_right(&target, 0.0, u);
            let rho_target = Some(target.rho0 / (1.0 - ahead_chi));
            if parts {
                chain.separates = true;
                chain.separation_time = Some(t);
                chain.states.push(ChainState { number, p, u, rho_flyer: None, rho_target });
                break;
            }
            // the shock back through the flyer, and its reflection from the free rear as a
            // rarefaction
            let up = flyer_u - u;
            let w = flyer.c0 + flyer.s * up;
            let chi = up / w;
            let rho_flyer = Some(flyer.rho0 / (1.0 - chi));
            chain.states.push(ChainState { number, p, u, rho_flyer, rho_target });
            if up <= 1e-12 * speed {
                break; // both plates have come to rest: the materials are equal
            }
            let (t_rear, t_face) = (t + thickness / w, t + 2.0 * thickness / w);
            let (rear_then, face_then) = (rear + flyer_u * (t_rear - t), face + u * (t_face - t));
            chain.push(ChainWave {
                plate: Plate::Flyer,
                kind: WaveKind::Shock,
                from: number - 1,
                to: number,
                lagrangian_speed: w,
                leftward: true,
                start: [t, face],
                end: Some([t_rear, rear_then]),
                velocity: flyer_u - w,
            });
            if number == last_state.max(2) {
                break;
            }
            // symmetric about state 2, 4, ...: the rarefaction cancels the shock's jump
            let mut next_u = u - up;
            if next_u.abs() <= 1e-12 * speed {
                next_u = 0.0;
            }
            chain.states.push(ChainState {
                number: number + 1,
                p: 0.0,
                u: next_u,
                rho_flyer: Some(flyer.rho0),
                rho_target: None,
            });
            chain.push(ChainWave {
                plate: Plate::Flyer,
                kind: WaveKind::Rarefaction,
                from: number,
                to: number + 1,
                lagrangian_speed: w,
                leftward: false,
                start: [t_rear, rear_then],
                end: Some([t_face, face_then]),
                velocity: u + (1.0 - chi) * w,
            });
            rear = rear_then + next_u * (t_face - t_rear);
            (t, face, flyer_u) = (t_face, face_then, next_u);
            chain.interface.push([t, face]);
            if number + 1 >= last_state {
                break;
            }
        }
        chain.find_overtaking();
        Ok(chain)
    }

    fn push(&mut self, wave: ChainWave) {
        self.waves.push(wave);
    }

    /// Waves of the target, in the order of their start.
    fn target_waves(&self) -> impl Iterator<Item = &ChainWave> {
        self.waves.iter().filter(|w| w.plate == Plate::Target)
    }

    fn find_overtaking(&mut self) {
        let waves: Vec<_> = self.target_waves().collect();
        let mut first = f64::INFINITY;
        for (a, b) in waves.iter().zip(waves.iter().skip(1)) {
            let gain = b.lagrangian_speed - a.lagrangian_speed;
            if gain > 0.0 {
                let delay = b.start[0] - a.start[0];
                first = first.min(b.start[0] + a.lagrangian_speed * delay / gain);
            }
        }
        self.valid_until = first;
    }

    /// Position of the interface at time `t` [m]; after separation, of the target's face.
    pub fn interface_position(&self, t: f64) -> f64 {
        let k = self.interface.partition_point(|b| b[0] <= t).max(1) - 1;
        let [from, x] = self.interface[k];
        // during leg k the interface is in state 2 k + 2
        let state =
            self.states.get(2 * k + 2).or_else(|| self.states.iter().rfind(|s| s.number % 2 == 0));
        x + state.map_or(0.0, |s| s.u) * (t - from)
    }

    /// The black line of Burghardt (2010): the state in the target at time `t` [s], constant
    /// between the waves that have entered it. It extends from the interface past the shock, by the
    /// distance that the shock has run. The energy follows from the jump conditions. `None` outside
    /// of 0 < t <= `valid_until`.
    pub fn shock_profile(&self, t: f64) -> Option<Profile> {
        if !(t > 0.0 && t <= self.valid_until) {
            return None;
        }
        let mut points = Vec::new();
        let mut at = ProfilePoint { rho: self.target_density, ..ProfilePoint::default() };
        let mut place = None; // Lagrangian and Eulerian position of the previous wave
        for wave in self.target_waves().take_while(|w| w.start[0] < t) {
            let lagrangian = wave.lagrangian_speed * (t - wave.start[0]);
            let x = match place {
                None => lagrangian,
                Some((l, x)) => x - (l - lagrangian) * self.target_density / at.rho,
            };
            if place.is_none() {
                points.push(ProfilePoint { x: 2.0 * x, ..at });
            }
            place = Some((lagrangian, x));
            points.push(ProfilePoint { x, ..at });
            let Some(behind) = self.states.iter().find(|s| s.number == wave.to) else { break };
            let rho = behind.rho_target.unwrap_or(at.rho);
            let work = 0.5 * (at.p + behind.p) * (1.0 / at.rho - 1.0 / rho);
            at = ProfilePoint { x, p: behind.p, u: behind.u, rho, e: at.e + work };
            points.push(at);
        }
        let (l, x) = place?;
        points.push(ProfilePoint { x: x - l * self.target_density / at.rho, ..at });
        points.reverse();
        Some(Profile { points })
    }
}

#[cfg(test)]
mod tests;
