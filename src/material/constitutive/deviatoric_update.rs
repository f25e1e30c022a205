//! What the strength of a material does to rows of particles.

use super::TensorRows;
use crate::material::Symmetric;
use crate::material::strength::{self, Condition, Rate, Strength};

/// Gradient of the velocity of rows.
#[derive(Clone, Copy)]
pub enum RateRows<'a> {
    /// On a line: its one component [1/s].
    Line(&'a [f64]),
    /// In a plane: by rows [1/s].
    Plane([&'a [f64]; 4]),
    /// About an axis: in its plane, and its divergence, which has the strain about the axis in it.
    Axis([&'a [f64]; 4], &'a [f64]),
}

impl RateRows<'_> {
    /// That of row `r`.
    #[inline(always)]
    pub fn at(&self, r: usize) -> Rate {
        match self {
            RateRows::Line(l) => Rate { plane: [l[r], 0.0, 0.0, 0.0], across: 0.0 },
            RateRows::Plane(l) => Rate { plane: l.map(|l| l[r]), across: 0.0 },
            RateRows::Axis(l, divergence) => {
                let plane = l.map(|l| l[r]);
                Rate { plane, across: divergence[r] - (plane[0] + plane[3]) }
            }
        }
    }
}

/// Columns of a deviator: xx, and in a plane yy and xy; what they lack of a trace is across. On a
/// line the other two are alike.
#[derive(Clone, Copy)]
pub struct DeviatorRows<'a> {
    /// Components xx [Pa].
    pub xx: &'a [f64],
    /// Components yy and xy [Pa], in a plane.
    pub plane: Option<[&'a [f64]; 2]>,
}

impl DeviatorRows<'_> {
    /// The deviator of row `r`.
    #[inline(always)]
    pub fn at(&self, r: usize) -> Symmetric {
        let xx = self.xx[r];
        match self.plane {
            None => Symmetric { xx, yy: -0.5 * xx, xy: 0.0, zz: -0.5 * xx },
            Some([yy, xy]) => Symmetric { xx, yy: yy[r], xy: xy[r], zz: -(xx + yy[r]) },
        }
    }
}

/// Rows that shear; see [`Flow::advance`].
pub struct FlowRows<'a> {
    /// Time [s].
    pub dt: f64,
    /// Gradient of the velocity.
    pub rate: RateRows<'a>,
    /// J.
    pub jacobian: &'a [f64],
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// Temperature [K], where a scene has one.
    pub temperature: Option<&'a [f64]>,
    /// Deviator of the stress before.
    pub deviator: DeviatorRows<'a>,
    /// Equivalent plastic strain before [-].
    pub plastic_strain: &'a [f64],
    /// Set to the deviator after [Pa].
    pub deviator_after: TensorRows<'a>,
    /// Set to the equivalent plastic strain after [-].
    pub plastic_strain_after: &'a mut [f64],
    /// Set to the plastic work per volume [J/m3].
    pub plastic_work: &'a mut [f64],
}

/// The strength of a material, as the step sees it.
pub trait Flow: Send + Sync {
    /// Shears rows.
    fn advance(&self, rows: FlowRows<'_>);

    /// Shear modulus of a row [Pa].
    fn shear_modulus(&self, at: &Condition) -> f64;

    /// Yield stress of a row at rest [Pa].
    fn yield_stress(&self, strain: f64, at: &Condition) -> f64;
}

/// The loops over a model of strength.
pub(super) struct Shearing<S>(pub S);

impl<S: Strength> Flow for Shearing<S> {
    fn advance(&self, rows: FlowRows<'_>) {
        let mut out = rows.deviator_after;
        for r in 0..rows.plastic_strain_after.len() {
            let at = Condition {
                compression: 1.0 / rows.jacobian[r],
                pressure: rows.pressure[r],
                temperature: rows.temperature.map_or(f64::NAN, |t| t[r]),
            };
            let (s, strain) = (rows.deviator.at(r), rows.plastic_strain[r]);
            let after = strength::advance(&self.0, &s, strain, &rows.rate.at(r), rows.dt, &at);
            out.set(r, &after.deviator, 1.0);
            rows.plastic_strain_after[r] = after.plastic_strain;
            rows.plastic_work[r] = after.plastic_work;
        }
    }

    fn shear_modulus(&self, at: &Condition) -> f64 {
        self.0.shear_modulus(at)
    }

    fn yield_stress(&self, strain: f64, at: &Condition) -> f64 {
        self.0.yield_stress(strain, 0.0, at)
    }
}
