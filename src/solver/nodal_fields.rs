//! Nodal fields of a patch.
//!
//! This module does not depend on materials or messages.

/// Indices of the nodal fields in a patch's arrays. A vector takes D consecutive fields; its index
/// is that of the first.
///
/// Fields that a scheme does not need have no array: their index is past the end.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Lumped mass m_i [kg].
    pub mass: usize,
    /// Inverse mass 1/m_i, 0 at nodes without mass [1/kg].
    pub inverse: usize,
    /// Lumped velocity vL [m/s], a vector; momentum during the sum over particles.
    pub lumped_velocity: usize,
    /// Velocity at the start of the step, v [m/s], a vector; without a filter the lumped velocity
    /// itself.
    pub velocity: usize,
    /// Velocity at the end of the step, v' [m/s], a vector.
    pub velocity_star: usize,
    /// Acceleration b [m/s2], a vector; internal force during the sum over particles.
    pub acceleration: usize,
    /// Velocity whose gradient does the work, w [m/s], a vector.
    pub work: usize,
    /// Last term of the filter's series, K^(k-1) vL [m/s], a vector; only with a filter.
    pub filter_residual: Option<usize>,
    /// Last term of the series of the force, which is applied to the nodes [m/s2], a vector; with a
    /// filter and a wall with friction.
    pub force_residual: Option<usize>,
    /// Scratch for products: as many consecutive fields as vectors are multiplied at a time.
    pub scratch: usize,
    /// Number of scratch fields.
    pub scratches: usize,
    /// First terms of the series of force and work, a vector.
    pub first: usize,
    /// Fraction of the node's volume filled with material [-], with an edge mask.
    pub volume: usize,
    /// 1 at nodes that the edge mask removes, 0 elsewhere, with an edge mask.
    pub edge: usize,
    /// Relaxation: summed weights and their inverse, projected pressure, and the first term of its
    /// series, which later holds the last term.
    pub relaxation: [usize; 4],
    /// Mean volume ratio of the relaxation, if its weights are relative to the current volume.
    pub relaxed_ratio: Option<usize>,
    /// Heat of friction [J/kg], with frictional contact or a wall with friction.
    pub heat: Option<usize>,
    /// Fields of the flux limiter, if the scene has it.
    pub limiter: Option<LimiterFields>,
    /// Number of fields.
    pub count: usize,
}

/// Fields of the flux limiter on a line.
#[derive(Clone, Debug)]
pub struct LimiterFields {
    /// Number of nodes on each side whose values bound a node's.
    pub neighbours: usize,
    /// Last term of the series of the force, then the series without its last term [m/s2].
    pub series: usize,
    /// Mean of the stress p + q [Pa].
    pub stress: usize,
    /// 1 at nodes near a free surface, else 0.
    pub edge: usize,
    /// First term of the series of the work [m/s].
    pub work: usize,
    /// Mean and half difference of the shares of positive and negative fluxes, of force and
    /// velocity [-].
    pub shares: [[usize; 2]; 2],
}

/// Nodal fields that a scheme needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    /// Number of vector series that a filter evaluates together; 0 without a filter.
    pub series: usize,
    /// Edge mask.
    pub masked: bool,
    /// Pressure relaxation.
    pub relaxed: bool,
    /// Pressure relaxation with weights relative to the current volume.
    pub relaxes_ratio: bool,
    /// Friction.
    pub has_friction: bool,
    /// A wall with friction.
    pub has_wall_friction: bool,
    /// Flux limiter: number of nodes on each side whose values bound a node's.
    pub limiter: Option<usize>,
}

impl Fields {
    /// Indices of the fields in `dimension` directions.
    pub fn new(dimension: usize, wanted: Wanted) -> Self {
        let Wanted {
            series,
            masked,
            relaxed,
            relaxes_ratio,
            has_friction: rubs,
            has_wall_friction,
            limiter,
        } = wanted;
        let filtered = series > 0;
        let mut count = 0;
        let mut add = |n: usize, wanted: bool| {
            let at = if wanted { count } else { usize::MAX / 2 };
            count += if wanted { n } else { 0 };
            at
        };
        let [mass, inverse] = [1; 2].map(|n| add(n, true));
        let scratches = (series * dimension).max(1);
        let scratch = add(scratches, true);
        let [lumped, velocity_star, acceleration, work, first] =
            [dimension; 5].map(|n| add(n, true));
        let velocity = if filtered { add(dimension, true) } else { lumped };
        let remainder = filtered.then(|| add(dimension, true));
        let force_residual = (filtered && has_wall_friction).then(|| add(dimension, true));
        let volume = add(1, masked);
        let edge = add(1, masked);
        let r = add(4, relaxed);
        let relaxed_ratio = relaxes_ratio.then(|| add(1, true));
        let heat = rubs.then(|| add(1, true));
        let limiter = limiter.map(|neighbours| LimiterFields {
            neighbours,
            series: add(1, true),
            stress: add(1, true),
            edge: add(1, true),
            work: add(1, true),
            shares: [[0; 2]; 2].map(|pair| pair.map(|_| add(1, true))),
        });
        Fields {
            mass,
            inverse,
            lumped_velocity: lumped,
            velocity,
            velocity_star,
            acceleration,
            work,
            filter_residual: remainder,
            force_residual,
            scratch,
            scratches,
            first,
            volume,
            edge,
            relaxed_ratio,
            relaxation: [r, r + 1, r + 2, r + 3],
            heat,
            limiter,
            count,
        }
    }

    /// Last terms of the series of a filter, vectors.
    pub fn residuals(&self) -> impl Iterator<Item = usize> {
        self.filter_residual.into_iter().chain(self.force_residual)
    }

    /// Adds consecutive fields, and returns the index of the first.
    pub fn add(&mut self, fields: usize) -> usize {
        let first = self.count;
        self.count += fields;
        first
    }
}
