//! A simple wave: a piston whose velocity changes smoothly sends it into material at rest.
//!
//! All states lie on the isentrope through the state ahead, and each state travels unchanged along
//! its characteristic. Towards +x, with V(tau) the velocity of the piston and X(tau) its position:
//!
//! ```text
//! u = V(tau),  du = C dchi,  dp = rho0 C^2 dchi      C(u): the Lagrangian sound speed, rho c/rho0
//! x = X(tau) + (u + c) (t - tau),  c = C (1 - chi)
//! steepens to a shock at  t = min over tau of tau + C/(C'(u) V'(tau))  where that is above tau
//! ```
//!
//! (Courant & Friedrichs 1948, section 40.) The solution holds until the wave steepens or reaches
//! the body's other face. For a wave towards -x all velocities change sign. Pistons that pull cause
//! rarefactions, which never steepen if the material stiffens under compression.

use super::isentrope::to_velocity;
use super::wave::{WaveState, at_rest, density, sound_speed};
use super::{ExactError, Landmarks, Profile, ProfilePoint, finite, positive};
use crate::material::MieGruneisen;

/// Number of points of a profile within the wave.
const POINTS: usize = 4000;

/// Motion of a piston: velocity [m/s], displacement since time 0 [m] and acceleration [m/s2] at a
/// time [s].
pub trait Drive {
    /// Velocity [m/s].
    fn velocity(&self, t: f64) -> f64;
    /// Displacement since time 0 [m].
    fn way(&self, t: f64) -> f64;
    /// Acceleration [m/s2].
    fn acceleration(&self, t: f64) -> f64;
    /// Times at which a derivative jumps [s].
    fn kinks(&self) -> Vec<f64>;
}

/// A simple wave in a body that is undisturbed ahead of it.
pub struct SimpleWaveSolution<P> {
    material: MieGruneisen,
    piston: P,
    /// +1 if the wave runs towards +x.
    direction: f64,
    /// Piston face and opposite face at time 0 [m].
    faces: [f64; 2],
    /// Time at which the wave steepens to a shock [s]; infinite if it never does.
    pub steepens: f64,
    /// Time until which the solution holds [s].
    pub valid_until: f64,
    /// Greatest pressure caused by the piston until then [Pa]; the least one if the piston only
    /// pulls.
    pub p: f64,
}

impl<P: Drive> SimpleWaveSolution<P> {
    /// A body from `lower` to `upper` [m] that moves at the piston's velocity at time 0. The piston
    /// is on its lower or its upper side. The wave is evaluated until `end` [s].
    ///
    /// # Errors
    ///
    /// If a number is out of range, or if the material cannot reach a velocity of the piston.
    pub fn new(
        material: MieGruneisen,
        lower: f64,
        upper: f64,
        piston_on_lower_side: bool,
        piston: P,
        end: f64,
    ) -> Result<Self, ExactError> {
        finite("the body's lower face", lower)?;
        let thickness = positive("the body's thickness", upper - lower)?;
        positive("the end", end)?;
        let direction = if piston_on_lower_side { 1.0 } else { -1.0 };
        let faces = if piston_on_lower_side { [lower, upper] } else { [upper, lower] };
        let arrives = thickness / material.c0;
        let mut wave = SimpleWaveSolution {
            material,
            piston,
            direction,
            faces,
            steepens: f64::INFINITY,
            valid_until: arrives,
            p: 0.0,
        };
        let mut state = wave.ahead();
        for tau in wave.departures(end.min(arrives)) {
            state = wave.state(state, tau)?;
            if state.p.abs() > wave.p.abs() {
                wave.p = state.p;
            }
            let growth = wave.speed_slope(&state)? * direction * wave.piston.acceleration(tau);
            if growth > 0.0 {
                wave.steepens = wave.steepens.min(tau + sound_speed(&material, &state) / growth);
            }
        }
        wave.valid_until = arrives.min(wave.steepens);
        Ok(wave)
    }

    fn ahead(&self) -> WaveState {
        at_rest(self.piston.velocity(0.0))
    }

    /// Times up to `end` at which characteristics leave the piston, including those of kinks [s].
    fn departures(&self, end: f64) -> Vec<f64> {
        let even = (0..=POINTS).map(|k| end * k as f64 / POINTS as f64);
        let mut times: Vec<f64> = even
            .chain(self.piston.kinks().into_iter().filter(|t| (0.0..=end).contains(t)))
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The state that leaves the piston at `tau`; `near` is another state on the isentrope.
    fn state(&self, near: WaveState, tau: f64) -> Result<WaveState, ExactError> {
        to_velocity(&self.material, near, self.direction, self.piston.velocity(tau))
    }

    /// |dC/du| on the isentrope, by finite differences.
    fn speed_slope(&self, state: &WaveState) -> Result<f64, ExactError> {
        let h = 1e-4 * self.material.c0;
        let at = |u: f64| {
            let state = to_velocity(&self.material, *state, self.direction, u)?;
            Ok(sound_speed(&self.material, &state))
        };
        let (more, less) = (at(state.u + self.direction * h)?, at(state.u - self.direction * h)?);
        Ok((more - less) / (2.0 * h))
    }

    /// The whole body at time `t` [s]; `None` before 0 and after
    /// [`SimpleWaveSolution::valid_until`].
    pub fn profile(&self, t: f64) -> Option<Profile> {
        if !(0.0..=self.valid_until).contains(&t) {
            return None;
        }
        let m = &self.material;
        let mut state = self.ahead();
        let mut points = Vec::new();
        let far = self.faces[1] + state.u * t;
        points.push(ProfilePoint { x: far, u: state.u, rho: m.rho0, ..ProfilePoint::default() });
        for tau in self.departures(t) {
            state = self.state(state, tau).ok()?;
            let c = sound_speed(m, &state) * (1.0 - state.chi);
            let x =
                self.faces[0] + self.piston.way(tau) + (state.u + self.direction * c) * (t - tau);
            points.push(ProfilePoint {
                x,
                p: state.p,
                u: state.u,
                rho: density(m, &state),
                e: state.e,
            });
        }
        // the points run from the other face to the piston, against the direction of the wave
        if self.direction > 0.0 {
            points.reverse();
        }
        Some(Profile { points })
    }

    /// Features for the scoring at time `t` [s]; `None` where the profile is `None`, and at t = 0.
    pub fn landmarks(&self, t: f64) -> Option<Landmarks> {
        if !(t > 0.0 && t <= self.valid_until) {
            return None;
        }
        let now = self.state(self.ahead(), t).ok()?;
        Some(Landmarks {
            direction: self.direction,
            interface: self.faces[0] + self.piston.way(t),
            far_end: self.faces[1] + self.piston.velocity(0.0) * t,
            shock: None,
            plateau: None,
            p2: self.p.abs(),
            rho2: density(&self.material, &now),
            e2: now.e,
            rho2_flyer: f64::NAN,
            e2_flyer: f64::NAN,
            second_plateau: None,
            p4: None,
            behind_shock: now.p,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::COPPER;

    /// The velocity changes from one value to another along half a cosine in 0.5 us.
    #[derive(Clone, Copy)]
    struct Swing {
        from: f64,
        change: f64,
    }

    const RATE: f64 = std::f64::consts::PI / 5e-7;

    impl Drive for Swing {
        fn velocity(&self, t: f64) -> f64 {
            self.from + 0.5 * self.change * (1.0 - (RATE * t.min(5e-7)).cos())
        }

        fn way(&self, t: f64) -> f64 {
            let during = t.min(5e-7);
            let swing = 0.5 * self.change * (during - (RATE * during).sin() / RATE);
            self.from * t + swing + self.change * (t - during)
        }

        fn acceleration(&self, t: f64) -> f64 {
            0.5 * self.change * RATE * (RATE * t.min(5e-7)).sin()
        }

        fn kinks(&self) -> Vec<f64> {
            vec![0.0, 5e-7]
        }
    }

    fn swing(from: f64, to: f64) -> Swing {
        Swing { from, change: to - from }
    }

    /// Mass between the faces, and the momentum that the piston has given.
    fn sums(profile: &Profile, still: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for w in profile.points.windows(2) {
            let h = 0.5 * (w[1].x - w[0].x);
            sums[0] += h * (w[0].rho + w[1].rho);
            sums[1] += h * (w[0].rho * (w[0].u - still) + w[1].rho * (w[1].u - still));
        }
        sums
    }

    /// Conservation of mass and momentum ties the profile to the piston's pressure.
    #[test]
    fn mass_and_momentum_are_kept() {
        for (lower_side, course) in
            [(true, swing(0.0, 200.0)), (false, swing(30.0, -120.0)), (true, swing(0.0, -50.0))]
        {
            let still = course.from;
            let (end, n) = (8e-7, 400);
            let wave =
                SimpleWaveSolution::new(COPPER, 1e-3, 6e-3, lower_side, course, end).unwrap();
            let impulse: f64 = (0..n)
                .map(|k| {
                    let t = end * (f64::from(k) + 0.5) / f64::from(n);
                    let profile = wave.profile(t).unwrap();
                    let at = if lower_side { 0 } else { profile.points.len() - 1 };
                    wave.direction * profile.points[at].p * end / f64::from(n)
                })
                .sum();
            let profile = wave.profile(end).unwrap();
            assert!(profile.points.windows(2).all(|w| w[1].x >= w[0].x));
            let [mass, momentum] = sums(&profile, still);
            assert!((mass / (COPPER.rho0 * 5e-3) - 1.0).abs() < 1e-7, "{mass}");
            assert!((momentum / impulse - 1.0).abs() < 1e-5, "{momentum} {impulse}");
        }
    }

    #[test]
    fn it_steepens_when_characteristics_cross() {
        let wave =
            SimpleWaveSolution::new(COPPER, 0.0, 1e-2, true, swing(0.0, 200.0), 5e-7).unwrap();
        let far = SimpleWaveSolution { valid_until: f64::INFINITY, ..wave };
        let crosses = |t: f64| {
            let points = far.profile(t).unwrap().points;
            points.windows(2).any(|w| w[1].x < w[0].x)
        };
        assert!(far.steepens > 2e-6 && far.steepens < 3e-6, "{}", far.steepens);
        assert!(!crosses(0.99 * far.steepens) && crosses(1.01 * far.steepens));
        let pulled =
            SimpleWaveSolution::new(COPPER, 0.0, 1e-2, true, swing(0.0, -50.0), 5e-7).unwrap();
        assert!(pulled.p < 0.0 && pulled.steepens > 1e-5, "{}", pulled.steepens);
    }
}
