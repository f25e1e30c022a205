//! Exact Riemann solution for two ideal gases, whose gammas may differ.
//!
//! Source: Toro (2009), Riemann Solvers and Numerical Methods for Fluid Dynamics, ch. 4. The
//! pressure between the waves is the root of f_L(p) + f_R(p) + u_R - u_L = 0 (eq. 4.5), with f from
//! eq. 4.6 for a shock and from eq. 4.7 for a fan; sampling follows its section 4.5. Each gas keeps
//! its own gamma through its own wave. Gases that would leave a vacuum (eq. 4.40) are refused.

use super::{ExactError, Profile, ProfilePoint, finite, positive};

/// State of the gas on one side of the diaphragm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasState {
    /// Density [kg/m3].
    pub rho: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Ratio of specific heats [-].
    pub gamma: f64,
}

impl GasState {
    /// Sound speed [m/s].
    pub fn sound_speed(&self) -> f64 {
        (self.gamma * self.p / self.rho).sqrt()
    }

    fn check(&self) -> Result<(), ExactError> {
        positive("a gas's density", self.rho)?;
        positive("a gas's pressure", self.p)?;
        finite("a gas's velocity", self.u)?;
        if self.gamma > 1.0 && self.gamma.is_finite() {
            Ok(())
        } else {
            Err(ExactError::Number { name: "gamma", value: self.gamma, allowed: "above 1" })
        }
    }

    /// Velocity change through the wave that brings this gas to the pressure `p` [m/s], and its
    /// derivative by p.
    fn change(&self, p: f64) -> (f64, f64) {
        let (g, c) = (self.gamma, self.sound_speed());
        if p > self.p {
            let a = 2.0 / ((g + 1.0) * self.rho);
            let b = (g - 1.0) / (g + 1.0) * self.p;
            let q = (a / (p + b)).sqrt();
            ((p - self.p) * q, q * (1.0 - 0.5 * (p - self.p) / (p + b)))
        } else {
            let z = (g - 1.0) / (2.0 * g);
            let ratio = p / self.p;
            (2.0 * c / (g - 1.0) * (ratio.powf(z) - 1.0), ratio.powf(z - 1.0) / (self.rho * c))
        }
    }

    /// Density behind the wave that brings this gas to the pressure `p` [kg/m3].
    fn density_behind(&self, p: f64) -> f64 {
        let (g, ratio) = (self.gamma, p / self.p);
        if p > self.p {
            let k = (g - 1.0) / (g + 1.0);
            self.rho * (ratio + k) / (k * ratio + 1.0)
        } else {
            self.rho * ratio.powf(1.0 / g)
        }
    }

    fn point(&self, x: f64) -> ProfilePoint {
        let e = self.p / ((self.gamma - 1.0) * self.rho);
        ProfilePoint { x, p: self.p, u: self.u, rho: self.rho, e }
    }
}

/// One of the two outer waves; speeds are signed and relative to fixed space [m/s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GasWave {
    /// A shock.
    Shock {
        /// Speed of the shock [m/s].
        speed: f64,
    },
    /// A rarefaction fan.
    Fan {
        /// Speed of its outer edge [m/s].
        head: f64,
        /// Speed of its inner edge [m/s].
        tail: f64,
    },
}

/// Solution of a Riemann problem: two outer waves and a contact between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiemannSolution {
    /// The gas left of the diaphragm.
    pub left_state: GasState,
    /// The gas right of the diaphragm.
    pub right_state: GasState,
    /// Pressure between the outer waves [Pa].
    pub p_star: f64,
    /// Velocity between the outer waves, which is the velocity of the contact [m/s].
    pub u_star: f64,
    /// Density left of the contact [kg/m3].
    pub rho_star_left: f64,
    /// Density right of the contact [kg/m3].
    pub rho_star_right: f64,
    /// The wave into the left gas.
    pub left: GasWave,
    /// The wave into the right gas.
    pub right: GasWave,
}

/// Number of straight pieces that represent a fan.
const FAN_PIECES: usize = 256;

impl RiemannSolution {
    /// Solves the Riemann problem of the gases `left` and `right` of a diaphragm that bursts.
    ///
    /// ```
    /// use flyer_mpm::exact::riemann::{GasState, RiemannSolution};
    ///
    /// let left = GasState { rho: 1.0, u: 0.0, p: 1.0, gamma: 1.4 };
    /// let right = GasState { rho: 0.125, u: 0.0, p: 0.1, gamma: 1.4 };
    /// let sod = RiemannSolution::solve(left, right)?;
    /// assert!((sod.p_star - 0.303130).abs() < 1e-6);
    /// assert!((sod.u_star - 0.927453).abs() < 1e-6);
    /// # Ok::<(), flyer_mpm::exact::ExactError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a state is not that of a gas, or if the gases separate so fast that a vacuum opens.
    pub fn solve(left: GasState, right: GasState) -> Result<RiemannSolution, ExactError> {
        left.check()?;
        right.check()?;
        let limit = 2.0 * left.sound_speed() / (left.gamma - 1.0)
            + 2.0 * right.sound_speed() / (right.gamma - 1.0);
        let difference = right.u - left.u;
        if difference >= limit {
            return Err(ExactError::Vacuum { difference, limit });
        }
        // the sum rises with p and is concave, so Newton's method from below the root never
        // overshoots; the bracket is halved wherever a step would leave it
        let sum = |p: f64| {
            let ((fl, dl), (fr, dr)) = (left.change(p), right.change(p));
            (fl + fr + difference, dl + dr)
        };
        let (mut low, mut high) = (0.0, left.p.max(right.p));
        while sum(high).0 < 0.0 {
            low = high;
            high *= 2.0;
        }
        let mut p = 0.5 * (low + high);
        for _ in 0..200 {
            let (f, slope) = sum(p);
            if f < 0.0 {
                low = p;
            } else {
                high = p;
            }
            let mut next = p - f / slope;
            if !(next > low && next < high) {
                next = 0.5 * (low + high);
            }
            let done = (next - p).abs() <= 1e-15 * p;
            p = next;
            if done {
                break;
            }
        }
        let u = 0.5 * (left.u + right.u + right.change(p).0 - left.change(p).0);
        let wave = |gas: &GasState, side: f64| {
            let (g, c) = (gas.gamma, gas.sound_speed());
            if p > gas.p {
                let mach = ((g + 1.0) / (2.0 * g) * p / gas.p + (g - 1.0) / (2.0 * g)).sqrt();
                GasWave::Shock { speed: gas.u + side * c * mach }
            } else {
                let c_star = c * (p / gas.p).powf((g - 1.0) / (2.0 * g));
                GasWave::Fan { head: gas.u + side * c, tail: u + side * c_star }
            }
        };
        Ok(RiemannSolution {
            left_state: left,
            right_state: right,
            p_star: p,
            u_star: u,
            rho_star_left: left.density_behind(p),
            rho_star_right: right.density_behind(p),
            left: wave(&left, -1.0),
            right: wave(&right, 1.0),
        })
    }

    /// The gas at x/t = `xi` [m/s], with x measured from the diaphragm.
    pub fn sample(&self, xi: f64) -> GasState {
        let (gas, wave, rho_star, side) = if xi < self.u_star {
            (self.left_state, self.left, self.rho_star_left, -1.0)
        } else {
            (self.right_state, self.right, self.rho_star_right, 1.0)
        };
        let star = GasState { rho: rho_star, u: self.u_star, p: self.p_star, ..gas };
        match wave {
            GasWave::Shock { speed } if side * xi > side * speed => gas,
            GasWave::Fan { head, .. } if side * xi > side * head => gas,
            GasWave::Fan { tail, .. } if side * xi > side * tail => within_fan(&gas, xi, side),
            _ => star,
        }
    }

    /// The profile from `lower` to `upper` [m] at the time `t` > 0 [s] after a diaphragm at
    /// `diaphragm` [m] bursts; each fan is represented by many straight pieces.
    pub fn profile(&self, diaphragm: f64, t: f64, lower: f64, upper: f64) -> Profile {
        let mut points = Vec::new();
        let mut push = |gas: GasState, speed: f64| points.push(gas.point(diaphragm + speed * t));
        let (l, r) = (self.left_state, self.right_state);
        let star_l = GasState { rho: self.rho_star_left, u: self.u_star, p: self.p_star, ..l };
        let star_r = GasState { rho: self.rho_star_right, u: self.u_star, p: self.p_star, ..r };
        let piece =
            |from: f64, to: f64, k: usize| from + (to - from) * k as f64 / FAN_PIECES as f64;
        // far enough away that the ends are cut off below
        let far = 2.0 * (upper - lower + (diaphragm - lower).abs() + (upper - diaphragm).abs()) / t;
        push(l, -far);
        match self.left {
            GasWave::Shock { speed } => {
                push(l, speed);
                push(star_l, speed);
            }
            GasWave::Fan { head, tail } => {
                for k in 0..=FAN_PIECES {
                    let xi = piece(head, tail, k);
                    push(within_fan(&l, xi, -1.0), xi);
                }
            }
        }
        push(star_l, self.u_star);
        push(star_r, self.u_star);
        match self.right {
            GasWave::Shock { speed } => {
                push(star_r, speed);
                push(r, speed);
            }
            GasWave::Fan { head, tail } => {
                for k in 0..=FAN_PIECES {
                    let xi = piece(tail, head, k);
                    push(within_fan(&r, xi, 1.0), xi);
                }
            }
        }
        push(r, far);
        Profile { points }.between(lower, upper)
    }
}

/// The gas inside its own fan at x/t = `xi` [m/s] (Toro, eqs. 4.56 and 4.63).
fn within_fan(gas: &GasState, xi: f64, side: f64) -> GasState {
    let (g, c) = (gas.gamma, gas.sound_speed());
    let ratio = 2.0 / (g + 1.0) + side * (g - 1.0) / ((g + 1.0) * c) * (xi - gas.u);
    GasState {
        rho: gas.rho * ratio.powf(2.0 / (g - 1.0)),
        u: 2.0 / (g + 1.0) * (0.5 * (g - 1.0) * gas.u + xi - side * c),
        p: gas.p * ratio.powf(2.0 * g / (g - 1.0)),
        gamma: g,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gas(rho: f64, u: f64, p: f64) -> GasState {
        GasState { rho, u, p, gamma: 1.4 }
    }

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    #[test]
    fn sod() {
        let sod = RiemannSolution::solve(gas(1.0, 0.0, 1.0), gas(0.125, 0.0, 0.1)).unwrap();
        close(sod.p_star, 0.303130, 6e-7);
        close(sod.u_star, 0.927453, 6e-7);
        close(sod.rho_star_left, 0.426319, 6e-7);
        close(sod.rho_star_right, 0.265574, 6e-7);
        let GasWave::Shock { speed } = sod.right else { panic!("{:?}", sod.right) };
        close(speed, 1.752156, 6e-7);
    }

    #[test]
    fn toros_other_tests() {
        // Toro, table 4.2: two fans, strong shocks
        let two_fans = RiemannSolution::solve(gas(1.0, -2.0, 0.4), gas(1.0, 2.0, 0.4)).unwrap();
        close(two_fans.p_star, 0.00189, 6e-6);
        let blast = RiemannSolution::solve(gas(1.0, 0.0, 1000.0), gas(1.0, 0.0, 0.01)).unwrap();
        close(blast.p_star, 460.894, 6e-4);
        close(blast.u_star, 19.5975, 6e-5);
        let collision =
            RiemannSolution::solve(gas(5.99924, 19.5975, 460.894), gas(5.99242, -6.19633, 46.0950))
                .unwrap();
        close(collision.p_star, 1691.64, 8e-3);
    }

    #[test]
    fn profile_conserves_mass_momentum_and_energy() {
        let left = GasState { rho: 1.0, u: 0.1, p: 1.0, gamma: 1.4 };
        let right = GasState { rho: 0.4, u: -0.3, p: 0.1, gamma: 5.0 / 3.0 };
        let t = 0.15;
        let profile = RiemannSolution::solve(left, right).unwrap().profile(0.5, t, 0.0, 1.0);
        let integral = |f: &dyn Fn(&ProfilePoint) -> f64| -> f64 {
            let w = profile.points.windows(2);
            w.map(|w| 0.5 * (f(&w[0]) + f(&w[1])) * (w[1].x - w[0].x)).sum()
        };
        let mass = 0.5 * (left.rho + right.rho) + t * (left.rho * left.u - right.rho * right.u);
        close(integral(&|q| q.rho), mass, 1e-5);
        let flux = |g: &GasState| g.rho * g.u * g.u + g.p;
        let momentum =
            0.5 * (left.rho * left.u + right.rho * right.u) + t * (flux(&left) - flux(&right));
        close(integral(&|q| q.rho * q.u), momentum, 1e-5);
        let energy = |g: &GasState| g.p / (g.gamma - 1.0) + 0.5 * g.rho * g.u * g.u;
        let flux = |g: &GasState| g.u * (energy(g) + g.p);
        let want = 0.5 * (energy(&left) + energy(&right)) + t * (flux(&left) - flux(&right));
        close(integral(&|q| q.rho * (q.e + 0.5 * q.u * q.u)), want, 1e-5);
    }

    #[test]
    fn samples_agree_with_the_profile() {
        let sod = RiemannSolution::solve(gas(1.0, 0.0, 1.0), gas(0.125, 0.0, 0.1)).unwrap();
        let profile = sod.profile(0.5, 0.2, 0.0, 1.0);
        assert_eq!(profile.span(), Some((0.0, 1.0)));
        for k in 0..100 {
            let x = 0.005 + 0.01 * k as f64;
            let (a, b) = (sod.sample((x - 0.5) / 0.2), profile.at(x).unwrap());
            close(a.p, b.p, 2e-5);
            close(a.rho, b.rho, 2e-5);
        }
    }

    #[test]
    fn refuses_a_vacuum_and_bad_gases() {
        let err = RiemannSolution::solve(gas(1.0, -10.0, 0.4), gas(1.0, 10.0, 0.4));
        assert!(matches!(err, Err(ExactError::Vacuum { .. })));
        assert!(RiemannSolution::solve(gas(-1.0, 0.0, 0.4), gas(1.0, 0.0, 0.4)).is_err());
        assert!(
            RiemannSolution::solve(
                gas(1.0, 0.0, 0.4),
                GasState { gamma: 1.0, ..gas(1.0, 0.0, 1.0) }
            )
            .is_err()
        );
    }
}
