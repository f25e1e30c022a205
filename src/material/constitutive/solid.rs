//! Stress and work of particles of an elastic solid.

use crate::material::{Deformation, ElasticSolid, Symmetric};

/// Deformation of particles.
#[derive(Clone, Copy)]
pub enum Strain<'a> {
    /// One dimension: J.
    Line(&'a [f64]),
    /// Plane strain.
    Plane(PlaneStrain<'a>),
    /// Axisymmetry: F in the plane, and J, which includes the hoop stretch.
    Axis(PlaneStrain<'a>, &'a [f64]),
}

/// F in a plane, extrapolated from its columns by the time `ahead`: (1 + ahead L) F.
#[derive(Clone, Copy)]
pub struct PlaneStrain<'a> {
    /// F by rows: xx, xy, yx, yy [-].
    pub deformation: [&'a [f64]; 4],
    /// Velocity gradient L by rows [1/s].
    pub gradient: [&'a [f64]; 4],
    /// Time of the extrapolation [s].
    pub ahead: f64,
}

impl PlaneStrain<'_> {
    #[inline(always)]
    fn at(&self, r: usize) -> Deformation {
        let (l, f) = (self.gradient.map(|l| l[r]), self.deformation.map(|f| f[r]));
        let plane = std::array::from_fn(|k| {
            let (a, b) = (k / 2, k % 2);
            f[k] + self.ahead * (l[2 * a] * f[b] + l[2 * a + 1] * f[2 + b])
        });
        Deformation { plane, across: 1.0 }
    }
}

impl Strain<'_> {
    /// F of particle `r`.
    #[inline(always)]
    fn at(&self, r: usize) -> Deformation {
        match self {
            Strain::Line(jacobian) => Deformation::uniaxial(jacobian[r]),
            Strain::Plane(plane) => plane.at(r),
            Strain::Axis(plane, jacobian) => {
                let flat = plane.at(r);
                Deformation { across: jacobian[r] / flat.area_ratio(), ..flat }
            }
        }
    }
}

/// Columns of a symmetric tensor in the unit of the tensor, with one entry per particle; only those
/// that a scene needs.
pub struct TensorColumns<'a> {
    /// Component xx, in the unit of the tensor.
    pub xx: &'a mut [f64],
    /// Components yy and xy, in the unit of the tensor; `None` in one dimension.
    pub plane: Option<[&'a mut [f64]; 2]>,
    /// Component zz, across the plane, in the unit of the tensor; with axial symmetry only.
    pub across: Option<&'a mut [f64]>,
}

impl TensorColumns<'_> {
    /// Sets particle `r` to `scale` times `tensor`, in the unit of the product.
    #[inline(always)]
    pub fn set(&mut self, r: usize, tensor: &Symmetric, scale: f64) {
        self.xx[r] = scale * tensor.xx;
        if let Some([yy, xy]) = &mut self.plane {
            yy[r] = scale * tensor.yy;
            xy[r] = scale * tensor.xy;
        }
        if let Some(zz) = &mut self.across {
            zz[r] = scale * tensor.zz;
        }
    }
}

/// Elastic solid, as called by the step.
pub trait SolidModel: Send + Sync {
    /// Sets minus the Cauchy stress times the volume [J], positive in compression like (p + q) V of
    /// a fluid; `volume0` is the volume at F = 1 [m3].
    fn stress_volume(&self, strain: Strain<'_>, volume0: &[f64], out: TensorColumns<'_>);

    /// Sets the work of the stress along the straight path from one strain to another [J], by the
    /// mid-point rule: V0 tau_h : (F' - F) F_h^-1 with F_h = (F + F')/2.
    fn work(&self, before: Strain<'_>, after: Strain<'_>, volume0: &[f64], work: &mut [f64]);

    /// Sets Cauchy stress [Pa], pressure -tr(sigma)/3 [Pa] and sound speed [m/s]. Returns the first
    /// particle whose state is outside the range of the model, and the reason.
    fn refresh(
        &self,
        strain: Strain<'_>,
        stress: TensorColumns<'_>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)>;

    /// Energy that particle `r` of a strain stores per unit mass [J/kg].
    fn stored_energy(&self, strain: Strain<'_>, r: usize) -> f64;

    /// Speed of the fastest wave in the solid at rest [m/s].
    fn sound_speed_at_rest(&self) -> f64;

    /// Shear wave speed in the solid at rest [m/s].
    fn shear_speed_at_rest(&self) -> f64;
}

/// Particle loops over one elastic solid.
pub(super) struct SolidKernel<S>(pub S);

impl<S: ElasticSolid> SolidModel for SolidKernel<S> {
    fn stress_volume(&self, strain: Strain<'_>, volume0: &[f64], mut out: TensorColumns<'_>) {
        for (r, volume0) in volume0.iter().enumerate() {
            out.set(r, &self.0.kirchhoff_stress(&strain.at(r)), -volume0);
        }
    }

    fn work(&self, before: Strain<'_>, after: Strain<'_>, volume0: &[f64], work: &mut [f64]) {
        for (r, work) in work.iter_mut().enumerate() {
            let (from, to) = (before.at(r), after.at(r));
            let middle = from.middle(&to);
            let tau = self.0.kirchhoff_stress(&middle);
            *work = volume0[r] * tau.double_dot(&from.strain_to(&to, &middle));
        }
    }

    fn refresh(
        &self,
        strain: Strain<'_>,
        mut stress: TensorColumns<'_>,
        pressure: &mut [f64],
        sound_speed: &mut [f64],
    ) -> Option<(usize, String)> {
        let mut sound = true;
        for r in 0..pressure.len() {
            let f = strain.at(r);
            let (tau, j) = (self.0.kirchhoff_stress(&f), f.jacobian());
            let c2 = self.0.sound_speed_squared(&f);
            stress.set(r, &tau, 1.0 / j);
            pressure[r] = -tau.trace() / (3.0 * j);
            sound_speed[r] = c2.sqrt();
            // a comparison with NaN is false
            sound &= j > 0.0 && c2 >= 0.0 && pressure[r].abs() < f64::INFINITY;
            sound &= self.0.check_validity(&f).is_none();
        }
        if sound {
            return None;
        }
        (0..pressure.len()).find_map(|r| {
            let f = strain.at(r);
            let (j, p) = (f.jacobian(), pressure[r]);
            let rho = self.0.reference_density() / j;
            let state = format!("density {rho:.6e} kg/m3, pressure {p:.6e} Pa");
            if !j.is_finite() {
                Some((r, format!("its deformation is not a number ({state})")))
            } else if j <= 0.0 || f.area_ratio() <= 0.0 {
                Some((r, format!("it is turned inside out (J = {j:.6e})")))
            } else if let Some(fault) = self.0.check_validity(&f) {
                Some((r, format!("it is {fault} ({state})")))
            } else if !p.is_finite() {
                Some((r, format!("its stress is not a number ({state})")))
            } else if sound_speed[r].is_nan() {
                Some((r, format!("its sound speed is imaginary ({state})")))
            } else {
                None
            }
        })
    }

    fn stored_energy(&self, strain: Strain<'_>, r: usize) -> f64 {
        self.0.stored_energy(&strain.at(r)) / self.0.reference_density()
    }

    fn sound_speed_at_rest(&self) -> f64 {
        self.0.sound_speed_squared(&Deformation::uniaxial(1.0)).sqrt()
    }

    fn shear_speed_at_rest(&self) -> f64 {
        (self.0.shear_modulus() / self.0.reference_density()).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Hencky, Lame};

    const STEEL: SolidKernel<Hencky> =
        SolidKernel(Hencky { rho0: 7800.0, lame: Lame { lambda: 115e9, mu: 77e9 } });

    #[test]
    fn a_state_outside_of_the_model_is_named() {
        let fault_at = |j: f64| {
            let (mut s, mut p, mut c) = ([0.0; 2], [0.0; 2], [0.0; 2]);
            let stress = TensorColumns { xx: &mut s, plane: None, across: None };
            STEEL.refresh(Strain::Line(&[0.9, j]), stress, &mut p, &mut c)
        };
        assert_eq!(fault_at(1.01), None);
        for (j, word) in [(2.9, "no stiffness"), (-0.1, "inside out"), (f64::NAN, "not a number")] {
            let (particle, what) = fault_at(j).unwrap();
            assert_eq!(particle, 1);
            assert!(what.contains(word), "{what}");
        }
    }

    #[test]
    fn pressure_is_the_mean_of_the_stress_in_all_directions() {
        let (mut xx, mut yy, mut xy, mut zz) = ([0.0], [0.0], [0.0], [0.0]);
        let (mut p, mut c) = ([0.0], [0.0]);
        let f = [[1.1], [0.2], [-0.1], [0.8]];
        let deformation = [&f[0][..], &f[1], &f[2], &f[3]];
        let plane = PlaneStrain { deformation, gradient: [&[0.0]; 4], ahead: 0.0 };
        let stress =
            TensorColumns { xx: &mut xx, plane: Some([&mut yy, &mut xy]), across: Some(&mut zz) };
        let jacobian = [1.2 * (1.1 * 0.8 + 0.2 * 0.1)];
        assert_eq!(STEEL.refresh(Strain::Axis(plane, &jacobian), stress, &mut p, &mut c), None);
        assert!(zz[0] > 0.0 && (p[0] + (xx[0] + yy[0] + zz[0]) / 3.0).abs() < 1e-3);
    }

    #[test]
    fn work_of_small_steps_is_the_change_of_stored_energy() {
        let at = |t: f64| [[1.0 + 0.3 * t], [0.5 * t], [-0.2 * t * t], [1.0 - 0.1 * t]];
        let jacobian =
            |t: f64, f: &[[f64; 1]; 4]| [(1.0 + 0.2 * t) * (f[0][0] * f[3][0] - f[1][0] * f[2][0])];
        let error = |steps: usize| {
            let (mut sum, mut stored) = (0.0, 0.0);
            for k in 0..steps {
                let times = [k, k + 1].map(|k| k as f64 / steps as f64);
                let f = times.map(at);
                let j = [jacobian(times[0], &f[0]), jacobian(times[1], &f[1])];
                let strain = |k: usize| {
                    let deformation = [&f[k][0][..], &f[k][1], &f[k][2], &f[k][3]];
                    let plane = PlaneStrain { deformation, gradient: [&[0.0]; 4], ahead: 0.0 };
                    Strain::Axis(plane, &j[k])
                };
                let mut work = [0.0];
                STEEL.work(strain(0), strain(1), &[2.0], &mut work);
                sum += work[0];
                stored = STEEL.stored_energy(strain(1), 0);
            }
            (sum / (2.0 * 7800.0 * stored) - 1.0).abs()
        };
        let order = (error(10) / error(20)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order} {}", error(20));
    }
}
