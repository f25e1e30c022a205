//! Equations of state that are linear in the specific internal energy.

/// Coefficients of p = reference_pressure + gruneisen_rho * e at one volume ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPressure {
    /// Part of the pressure that does not depend on the energy, f(J) [Pa].
    pub reference_pressure: f64,
    /// dp/de at fixed volume, g(J) = Gamma rho [kg/m3].
    pub gruneisen_rho: f64,
}

/// Equation of state p(J, e), linear in the energy.
///
/// `jacobian` is J = V/V0 [-]; `energy` is per unit mass [J/kg]; pressure is positive in
/// compression [Pa].
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// Coefficients of p = f(J) + g(J) e.
    fn linear(&self, jacobian: f64) -> LinearPressure;

    /// Square of the isentropic sound speed, c^2 = (dp/drho)_s [m2/s2]; not positive outside the
    /// range of the model.
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64;

    /// Lowest pressure that the material carries [Pa]; it replaces a lower f(J) + g(J) e.
    fn least_pressure(&self) -> f64 {
        f64::NEG_INFINITY
    }

    /// `pressure` of the linear form, limited to the lowest that the material carries [Pa].
    #[inline(always)]
    fn clamp_tension(&self, pressure: f64) -> f64 {
        // max() would discard NaN
        if pressure < self.least_pressure() { self.least_pressure() } else { pressure }
    }

    /// Reason why a state is outside the range of the model, if it is.
    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str>;

    /// Pressure [Pa].
    fn pressure(&self, jacobian: f64, energy: f64) -> f64 {
        let LinearPressure { reference_pressure, gruneisen_rho } = self.linear(jacobian);
        self.clamp_tension(reference_pressure + gruneisen_rho * energy)
    }

    /// Specific internal energy at which the material has `pressure` [J/kg].
    fn energy_at(&self, jacobian: f64, pressure: f64) -> f64 {
        let LinearPressure { reference_pressure, gruneisen_rho } = self.linear(jacobian);
        (pressure - reference_pressure) / gruneisen_rho
    }
}
