//! Particles to grid: each sum runs over own rows and ghosts in canonical order, so that all
//! patches that hold a node get the same bits for it.

use super::{MOST_NODES, Stepper, with_width};
use crate::patch::Patch;
use crate::transfer::{Scheme, add, cut};

impl Stepper {
    /// All sums of a patch at new places of its rows, with or without the force, and the lumped
    /// velocity and acceleration from them.
    pub(super) fn scatter(&self, patch: &mut Patch<1>, force: bool) {
        self.find_weights(patch);
        self.scatter_rows(patch, force);
        self.divide_by_mass(patch);
        self.start_series(patch);
    }

    /// Whether the scheme needs the mass matrix.
    pub(super) fn needs_matrix(&self) -> bool {
        match self.scheme {
            Scheme::Series { order, .. } => order > 1 || self.compatible,
            Scheme::Blend(_) => self.compatible,
            Scheme::Affine => false,
        }
    }

    /// Mass and momentum of the nodes, the mass matrix and the filled volume where the scheme
    /// needs them, and with `force` the internal force f_i = sum_p (p + q) V G_i (pressure is
    /// positive in compression, so it pushes along the gradient): all in one pass over the rows.
    pub(super) fn scatter_rows(&self, patch: &mut Patch<1>, force: bool) {
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper, force: bool) {
            match (s.needs_matrix(), s.columns.affine) {
                (true, None) => s.scatter_width::<K, true, false>(patch, force),
                (false, None) => s.scatter_width::<K, false, false>(patch, force),
                (true, Some(_)) => s.scatter_width::<K, true, true>(patch, force),
                (false, Some(_)) => s.scatter_width::<K, false, true>(patch, force),
            }
        }
        with_width!(patch.stencils.width, go(patch, self, force));
    }

    fn scatter_width<const K: usize, const MATRIX: bool, const AFFINE: bool>(
        &self,
        patch: &mut Patch<1>,
        force: bool,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        for field in [f.mass, f.lumped, f.acceleration, f.scratch].into_iter().chain(f.remainder) {
            patch.nodes.fields[field].fill(0.0);
        }
        if MATRIX {
            patch.band.clear(patch.nodes.nodes.count(), K);
        }
        // the field leaves the list while the others are written
        let mut volume = self.edge_mask.map(|_| std::mem::take(&mut patch.nodes.fields[f.volume]));
        if let Some(volume) = &mut volume {
            volume.fill(0.0);
        }
        let rows = patch.block.rows();
        let column = |k: usize| &patch.block.columns[k][..rows];
        let (mass, velocity, length) = (column(c.mass), column(c.velocity), column(c.length));
        let stress = column(c.stress_volume);
        let affine = c.affine.filter(|_| AFFINE).map(|a| (column(a), column(c.fraction)));
        let lower = patch.nodes.nodes.lower[0];
        let [nodal_mass, momentum, nodal_force] =
            patch.nodes.fields_mut([f.mass, f.lumped, f.acceleration]);
        for run in &patch.runs {
            for r in run.clone() {
                let (first, n, g) = patch.stencils.row::<K>(r);
                let m = mass[r];
                let mv = m * velocity[r];
                add(nodal_mass, first, n.map(|n| n * m));
                match affine {
                    None => add(momentum, first, n.map(|n| n * mv)),
                    Some((affine, fraction)) => {
                        // m N (v + C (x_i - x_p))
                        let offset = (first as i64 + lower - patch.block.cells[r][0] as i64) as f64
                            - fraction[r];
                        let mc = m * affine[r] * self.cell;
                        let terms: [f64; K] =
                            std::array::from_fn(|k| n[k] * (mv + mc * (offset + k as f64)));
                        add(momentum, first, terms);
                    }
                }
                if MATRIX {
                    patch.band.add(first, m, n);
                }
                if let Some(volume) = &mut volume {
                    add(volume, first, n.map(|n| n * length[r]));
                }
                if force {
                    add(nodal_force, first, g.map(|g| g * stress[r]));
                }
            }
        }
        if MATRIX {
            patch.band.finish();
        }
        if let Some(volume) = volume {
            patch.nodes.fields[f.volume] = volume;
        }
    }

    /// Lumped velocity and acceleration of the owned nodes from their sums; those too small to
    /// matter are cut to zero.
    pub(super) fn divide_by_mass(&self, patch: &mut Patch<1>) {
        let f = &self.fields;
        let [mass, inverse, lumped, acceleration] =
            patch.nodes.fields_mut([f.mass, f.inverse, f.lumped, f.acceleration]);
        inverse.fill(0.0);
        let still = self.still_speed;
        let slow = self.still_acceleration;
        for i in patch.active.clone() {
            inverse[i] = if mass[i] > self.empty_mass { 1.0 / mass[i] } else { 0.0 };
            lumped[i] = cut(lumped[i] * inverse[i], still);
            acceleration[i] = cut(acceleration[i] * inverse[i], slow);
        }
    }
}
