//! States and times of the true solution that need no wave tracking: release along isentropes.
//!
//! The frame is that of [`super::wave_interactions`]. State 2 is the impedance match. In state 3
//! the flyer is released to P = 0 along its isentrope through state 2. In state 4 the target's
//! release isentrope through state 2 meets the flyer's recompression from state 3, which follows
//! the same isentrope as long as it has not steepened into a shock. Later states follow in the same
//! way. Unlike the waves of the chain, these waves spread: head and tail run at the sound speeds on
//! their two sides.

use super::isentrope::to_pressure;
use super::wave::{WaveState, density, shocked, sound_speed};
use super::wave_interactions::{check, impedance_match};
use super::{ExactError, Plate};
use crate::material::MieGruneisen;

/// A state of the true solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseState {
    /// Number of the state in Burghardt (2010).
    pub number: usize,
    /// Velocity (in the frame of the target at rest) [m/s].
    pub u: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Density in the flyer [kg/m3].
    pub rho_flyer: Option<f64>,
    /// Density in the target [kg/m3].
    pub rho_target: Option<f64>,
    /// Specific internal energy in the flyer [J/kg].
    pub e_flyer: Option<f64>,
    /// Specific internal energy in the target [J/kg].
    pub e_target: Option<f64>,
}

/// States, speeds and times of the true solution. Speeds are Lagrangian (relative to the undeformed
/// material); times count from contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Release {
    /// States 2, 3, 4 and so on, up to the requested number; fewer if the plates separate or come
    /// to rest.
    pub states: Vec<ReleaseState>,
    /// Whether the plates separate within the requested states (softer flyer: at state 4).
    pub separates: bool,
    /// Shock speed in the flyer [m/s].
    pub flyer_shock: f64,
    /// Shock speed in the target [m/s].
    pub target_shock: f64,
    /// Speed of the fan's head in the flyer [m/s].
    pub flyer_head: f64,
    /// Speed of the fan's tail in the flyer [m/s].
    pub flyer_tail: f64,
    /// Speed of the fan's head in the target [m/s].
    pub target_head: f64,
    /// Speed of the fan's tail in the target [m/s].
    pub target_tail: f64,
    /// Time at which the shock reaches the flyer's rear [s].
    pub rear_time: f64,
    /// Time at which the head of the fan returns to the interface [s].
    pub head_time: f64,
    /// Time at which the head of the fan catches the target's shock [s]; infinite if it never does.
    pub catch_up_time: f64,
    /// Distance of the catch-up from the contact position [m].
    pub catch_up_place: f64,
}

impl Release {
    /// The times, and the states up to the number `last_state`, of an impact at `speed` [m/s] of a
    /// flyer of `thickness` [m].
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
    ) -> Result<Release, ExactError> {
        check(&flyer, &target, speed, thickness)?;
        let u2 = impedance_match(&flyer, &target, speed);
        let flyer_2 = WaveState { u: u2, ..shocked(&flyer, speed - u2) };
        let target_2 = shocked(&target, u2);
        let named = |number, flyer_state: Option<&WaveState>, target_state: Option<&WaveState>| {
            let any = flyer_state.or(target_state).copied().unwrap_or_default();
            ReleaseState {
                number,
                u: any.u,
                p: any.p,
                rho_flyer: flyer_state.map(|s| density(&flyer, s)),
                rho_target: target_state.map(|s| density(&target, s)),
                e_flyer: flyer_state.map(|s| s.e),
                e_target: target_state.map(|s| s.e),
            }
        };
        let mut states = vec![named(2, Some(&flyer_2), Some(&target_2))];
        let (mut in_flyer, mut in_target) = (flyer_2, target_2);
        let mut separates = false;
        let mut target_tail = f64::NAN;
        for number in (3..=last_state.max(4)).step_by(2) {
            let free = to_pressure(&flyer, in_flyer, 1.0, 0.0)?;
            states.push(named(number, Some(&free), None));
            let unloaded = to_pressure(&target, in_target, 1.0, 0.0)?;
            // both curves are steep at P = 0: if they cross below it, the plates separate, however
            // deep in tension the crossing lies
            let zf = flyer.rho0 * sound_speed(&flyer, &free);
            let zt = target.rho0 * sound_speed(&target, &unloaded);
            let crossing = (free.u - unloaded.u) / (1.0 / zf + 1.0 / zt);
            let part = crossing < -1e-9 * target_2.p;
            if part {
                separates = true;
                in_target = unloaded;
                states.push(named(number + 1, None, Some(&in_target)));
            } else {
                let (a, b) = meet(&flyer, &target, free, in_target)?;
                (in_flyer, in_target) = (a, b);
                states.push(named(number + 1, Some(&a), Some(&b)));
            }
            if number == 3 {
                target_tail = sound_speed(&target, &in_target);
            }
            if part || in_target.p < 1e-9 * target_2.p {
                break;
            }
        }
        states.retain(|s| s.number <= last_state.max(4));
        let flyer_shock = flyer.c0 + flyer.s * (speed - u2);
        let target_shock = target.c0 + target.s * u2;
        let flyer_head = sound_speed(&flyer, &flyer_2);
        let target_head = sound_speed(&target, &target_2);
        let rear_time = thickness / flyer_shock;
        let head_time = rear_time + thickness / flyer_head;
        let gain = target_head - target_shock;
        let catch_up_time = if gain > 0.0 { head_time * target_head / gain } else { f64::INFINITY };
        Ok(Release {
            separates,
            flyer_shock,
            target_shock,
            flyer_head,
            flyer_tail: sound_speed(&flyer, &to_pressure(&flyer, flyer_2, 1.0, 0.0)?),
            target_head,
            target_tail,
            rear_time,
            head_time,
            catch_up_time,
            catch_up_place: target_shock * catch_up_time,
            states,
        })
    }

    /// The state with the `number` of Burghardt (2010).
    pub fn state(&self, number: usize) -> Option<&ReleaseState> {
        self.states.iter().find(|s| s.number == number)
    }

    /// Density [kg/m3] and specific internal energy [J/kg] of state 2 in one of the plates.
    pub fn plateau(&self, plate: Plate) -> (f64, f64) {
        let s = &self.states[0];
        let (rho, e) = match plate {
            Plate::Flyer => (s.rho_flyer, s.e_flyer),
            Plate::Target => (s.rho_target, s.e_target),
        };
        (rho.unwrap_or(f64::NAN), e.unwrap_or(f64::NAN))
    }
}

/// The intersection of the flyer's left-going isentrope through `free` with the target's
/// right-going isentrope through `behind`: the states of flyer and target. Its pressure lies
/// between 0 and that of `behind`.
fn meet(
    flyer: &MieGruneisen,
    target: &MieGruneisen,
    mut free: WaveState,
    mut behind: WaveState,
) -> Result<(WaveState, WaveState), ExactError> {
    let scale = behind.p;
    // for equal plates rounding may put the intersection slightly below 0
    let slack = 1e-8 * scale;
    let (mut low, mut high) = (0.0, scale);
    for _ in 0..100 {
        let zf = flyer.rho0 * sound_speed(flyer, &free);
        let zt = target.rho0 * sound_speed(target, &behind);
        let mut p = (free.p / zf + behind.p / zt + free.u - behind.u) / (1.0 / zf + 1.0 / zt);
        let done = (p - free.p).abs() + (p - behind.p).abs() <= 1e-14 * scale;
        if done || !p.is_finite() {
            break;
        }
        // Newton's method within a bracket: a strong release has a large curvature far below P = 0
        if p < low - slack || p > high + slack {
            p = 0.5 * (low + high);
        }
        free = to_pressure(flyer, free, -1.0, p)?;
        behind = to_pressure(target, behind, 1.0, p)?;
        // the flyer's velocity decreases with the pressure, the target's increases
        if free.u > behind.u { low = p } else { high = p }
    }
    if (free.u - behind.u).abs() > 1e-8 * behind.u.abs().max(free.u.abs()).max(1.0) {
        return Err(ExactError::State { what: "no state 4 found", chi: behind.chi });
    }
    Ok((free, behind))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};

    #[test]
    fn the_true_states() {
        let release = Release::new(COPPER, ALUMINIUM, 1000.0, 0.5e-3, 6).unwrap();
        let want = [
            (2, 690.935777, 12.144294e9),
            (3, 381.582123, 0.0),
            (4, 265.304053, 4.267375e9),
            (5, 149.025984, 0.0),
            (6, 103.606537, 1.624223e9),
        ];
        assert_eq!(release.states.len(), 5);
        for (s, (number, u, p)) in release.states.iter().zip(want) {
            assert_eq!(s.number, number);
            assert!((s.u - u).abs() < 6e-7, "{number}: u {}", s.u);
            assert!((s.p - p).abs() < 600.0, "{number}: P {}", s.p);
        }
        let (rho, e) = release.plateau(Plate::Target);
        assert!((rho - 3127.380).abs() < 6e-4 && (e - 238_696.0).abs() < 0.6);
        let (rho, e) = release.plateau(Plate::Flyer);
        assert!((rho - 9604.616).abs() < 6e-4 && (e - 47_760.0).abs() < 0.6);
    }

    #[test]
    fn the_true_speeds_and_times() {
        let release = Release::new(COPPER, ALUMINIUM, 1000.0, 0.5e-3, 4).unwrap();
        let close = |a: f64, b: f64, by: f64| assert!((a - b).abs() <= by, "{a} {b}");
        close(release.flyer_head, 4855.239, 6e-4);
        close(release.flyer_tail, 3940.0, 6e-4);
        close(release.target_head, 7207.040, 6e-4);
        close(release.target_tail, 6083.364, 6e-4);
        close(release.target_shock, 6311.163, 6e-4);
        close(release.rear_time, 0.113631e-6, 6e-13);
        close(release.head_time, 0.216613e-6, 6e-13);
        close(release.catch_up_time, 1.742580e-6, 6e-13);
        close(release.catch_up_place, 10.9977e-3, 6e-8);
        let thin = Release::new(COPPER, ALUMINIUM, 1000.0, 0.25e-3, 4).unwrap();
        close(thin.catch_up_time, 0.871290e-6, 6e-13);
        close(thin.catch_up_place, 5.498853e-3, 6e-10);
    }

    #[test]
    fn equal_plates_rest_and_a_softer_flyer_parts() {
        let equal = Release::new(COPPER, COPPER, 1000.0, 0.5e-3, 6).unwrap();
        assert!(!equal.separates);
        let four = equal.state(4).unwrap();
        assert!(four.p.abs() < 1e-2 * 6e3 && (four.u - equal.states[1].u).abs() < 1e-3);
        let soft = Release::new(ALUMINIUM, COPPER, 1500.0, 0.5e-3, 6).unwrap();
        assert!(soft.separates && soft.state(4).unwrap().p == 0.0 && soft.state(5).is_none());
    }
}
