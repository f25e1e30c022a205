//! Products of an explosive: the equation of Jones, Wilkins and Lee.
//!
//! With V = v/v0 = J and E0 the energy of detonation per initial volume, carried by the material
//! from the start, e = E0/rho0:
//!
//! ```text
//! p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w rho0 e/V
//! ```
//!
//! Source: Lee, Hornig & Kury (1968), UCRL-50422; Dobratz & Crawford (1985), LLNL Explosives
//! Handbook, UCRL-52997. [`Jwl::detonation`] is the state of Chapman and Jouguet: the Rayleigh line
//! that touches the products' Hugoniot, so D^2 = v0^2 p/(v0 - v) is least.
//!
//! Programmed burn ([`Burning`]) multiplies the pressure by the burnt fraction F: p = F p_jwl,
//! Wilkins (1999), Computer Simulation of Dynamic Phenomena, section 5. The material ahead of the
//! front has no stiffness: it is not meant to be struck before it burns. Its sound speed is the
//! speed of detonation until all is burnt, so that no step passes the front by.

use super::{EosPoint, EquationOfState, HistoryEos, Linear};

/// Products of an explosive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jwl {
    /// Density of the explosive [kg/m3].
    pub rho0: f64,
    /// A [Pa].
    pub a: f64,
    /// B [Pa].
    pub b: f64,
    /// R1 [-].
    pub r1: f64,
    /// R2 [-].
    pub r2: f64,
    /// Omega, the Grueneisen coefficient of the products [-].
    pub omega: f64,
    /// Energy of detonation per initial volume E0 [J/m3].
    pub energy: f64,
}

/// A detonation that sustains itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detonation {
    /// Its speed D [m/s].
    pub speed: f64,
    /// Pressure behind it [Pa].
    pub pressure: f64,
    /// Volume ratio behind it [-].
    pub jacobian: f64,
    /// Specific internal energy behind it [J/kg].
    pub energy: f64,
}

impl Jwl {
    /// The specific internal energy at the start, E0/rho0 [J/kg].
    pub fn first_energy(&self) -> f64 {
        self.energy / self.rho0
    }

    /// The part of the pressure without the energy, and its derivative by V [Pa].
    #[inline(always)]
    fn cold(&self, v: f64) -> [f64; 2] {
        let term = |a: f64, r: f64| {
            let (exp, share) = (a * (-r * v).exp(), self.omega / (r * v));
            [exp * (1.0 - share), exp * (share / v - r * (1.0 - share))]
        };
        let ([p, dp], [q, dq]) = (term(self.a, self.r1), term(self.b, self.r2));
        [p + q, dp + dq]
    }

    /// Pressure of the products on their Hugoniot from the unburnt explosive at p = 0 [Pa].
    fn hugoniot(&self, v: f64) -> f64 {
        let [cold, _] = self.cold(v);
        (cold + self.omega * self.energy / v) / (1.0 - 0.5 * self.omega * (1.0 - v) / v)
    }

    /// The state of Chapman and Jouguet, by golden sections of p/(1 - V); V is between 1/2 and 1.
    pub fn detonation(&self) -> Detonation {
        let rate = |v: f64| self.hugoniot(v) / (1.0 - v);
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.5, 0.999);
        while high - low > 1e-9 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if rate(a) < rate(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let v = 0.5 * (low + high);
        let p = self.hugoniot(v);
        Detonation {
            speed: (rate(v) / self.rho0).sqrt(),
            pressure: p,
            jacobian: v,
            energy: self.first_energy() + 0.5 * p * (1.0 - v) / self.rho0,
        }
    }
}

impl EquationOfState for Jwl {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> Linear {
        let [cold, _] = self.cold(jacobian);
        Linear { cold, energy_factor: self.omega * self.rho0 / jacobian }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let v = jacobian;
        let [cold, slope] = self.cold(v);
        // w rho0 e/V = p - cold
        v * v / self.rho0 * ((pressure - cold) / v + self.omega * pressure / v - slope)
    }

    #[inline(always)]
    fn fault(&self, _jacobian: f64, pressure: f64) -> Option<&'static str> {
        (pressure < 0.0).then_some("products of an explosive under tension, which they cannot bear")
    }

    fn energy_at(&self, _jacobian: f64, _pressure: f64) -> f64 {
        self.first_energy()
    }
}

/// Products that come to be as the explosive burns; its history is the burnt fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burning {
    /// The products.
    pub products: Jwl,
    /// Speed of the burning front [m/s].
    pub detonation_velocity: f64,
}

impl HistoryEos for Burning {
    fn reference_density(&self) -> f64 {
        self.products.rho0
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64) {
        let Linear { cold, energy_factor } = self.products.linear(jacobian);
        let whole = cold + energy_factor * energy;
        let c2 = self.products.sound_speed_squared(jacobian, whole);
        // of p = F p_jwl: the work done on it is F's share of that on the products
        let share = energy_factor * whole / self.products.rho0;
        let c2 =
            history * (c2 - (1.0 - history) * jacobian * jacobian / self.products.rho0 * share);
        let ahead = self.detonation_velocity * self.detonation_velocity;
        let point = EosPoint {
            pressure: history * whole,
            energy_slope: history * energy_factor,
            sound_speed_squared: if history < 1.0 { c2.max(ahead) } else { c2 },
        };
        (point, history)
    }

    fn first_history(&self) -> Option<f64> {
        Some(0.0)
    }

    fn fault(&self, jacobian: f64, _: f64, history: f64, pressure: f64) -> Option<&'static str> {
        if history > 0.0 {
            EquationOfState::fault(&self.products, jacobian, pressure)
        } else {
            None
        }
    }

    fn energy_at(&self, _pressure: f64) -> f64 {
        self.products.first_energy()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    /// TNT: Dobratz & Crawford (1985).
    pub const TNT: Jwl = Jwl {
        rho0: 1630.0,
        a: 371.2e9,
        b: 3.231e9,
        r1: 4.15,
        r2: 0.95,
        omega: 0.30,
        energy: 7.0e9,
    };

    #[test]
    fn derivatives() {
        let e = TNT.first_energy();
        let states =
            [[0.6, 1.2 * e, 0.0], [1.0, e, 0.0], [3.0, 0.5 * e, 0.0], [20.0, 0.2 * e, 0.0]];
        check_derivatives(&TNT, &states, 1e-6);
        let burning = Burning { products: TNT, detonation_velocity: 1.0 };
        let burnt = states.map(|[j, e, _]| [[j, e, 0.3], [j, e, 1.0]]);
        check_derivatives(&burning, burnt.as_flattened(), 1e-6);
    }

    #[test]
    fn tnt_detonates_as_its_handbook_says() {
        // D = 6930 m/s, 21 GPa
        let cj = TNT.detonation();
        assert!((cj.speed / 6930.0 - 1.0).abs() < 5e-3, "{cj:?}");
        assert!((cj.pressure / 21e9 - 1.0).abs() < 1e-2, "{cj:?}");
        // it runs at the speed of sound behind it, relative to the products
        let c = TNT.sound_speed_squared(cj.jacobian, cj.pressure).sqrt();
        assert!((c / (cj.speed * cj.jacobian) - 1.0).abs() < 1e-4, "{c} {cj:?}");
        assert!((TNT.pressure(cj.jacobian, cj.energy) / cj.pressure - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_isentrope_has_its_closed_form() {
        // p_s = A exp(-R1 V) + B exp(-R2 V) + C V^-(1 + w)
        let form = |c: f64, v: f64| {
            TNT.a * (-TNT.r1 * v).exp() + TNT.b * (-TNT.r2 * v).exp() + c * v.powf(-1.0 - TNT.omega)
        };
        let start = TNT.pressure(1.0, TNT.first_energy());
        let c = start - form(0.0, 1.0);
        let (mut v, mut e, n) = (1.0, TNT.first_energy(), 20000);
        for _ in 0..n {
            let dv = 4.0 / f64::from(n);
            let p = TNT.pressure(v, e);
            e -= TNT.pressure(v + 0.5 * dv, e - 0.5 * p * dv / 1630.0) * dv / 1630.0;
            v += dv;
        }
        assert!((TNT.pressure(v, e) / form(c, v) - 1.0).abs() < 1e-6);
    }
}
