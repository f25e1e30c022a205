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
        self.scatter_motion(patch);
        if force {
            self.scatter_force(patch);
        }
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

    /// Mass and momentum of the nodes, and the mass matrix and filled volume where the scheme
    /// needs them.
    pub(super) fn scatter_motion(&self, patch: &mut Patch<1>) {
        let f = &self.fields;
        for field in [f.mass, f.lumped, f.acceleration, f.scratch] {
            patch.nodes.fields[field].fill(0.0);
        }
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper) {
            s.scatter_mass_momentum::<K>(patch);
            if s.needs_matrix() {
                s.scatter_matrix::<K>(patch);
            }
            if s.edge_mask.is_some() {
                s.scatter_volume::<K>(patch);
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    fn scatter_mass_momentum<const K: usize>(&self, patch: &mut Patch<1>) {
        let (c, f) = (&self.columns, &self.fields);
        let rows = patch.block.rows();
        let (mass, velocity) =
            (&patch.block.columns[c.mass][..rows], &patch.block.columns[c.velocity][..rows]);
        let lower = patch.nodes.nodes.lower[0];
        let [nodal_mass, momentum] = patch.nodes.fields_mut([f.mass, f.lumped]);
        let affine = c
            .affine
            .map(|a| (&patch.block.columns[a][..rows], &patch.block.columns[c.fraction][..rows]));
        for run in &patch.runs {
            for r in run.clone() {
                let (first, n, _) = patch.stencils.row::<K>(r);
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
            }
        }
    }

    fn scatter_matrix<const K: usize>(&self, patch: &mut Patch<1>) {
        let rows = patch.block.rows();
        let mass = &patch.block.columns[self.columns.mass][..rows];
        let nodes = patch.nodes.nodes.count();
        patch.band.clear(nodes, K);
        for run in &patch.runs {
            for r in run.clone() {
                let (first, n, _) = patch.stencils.row::<K>(r);
                patch.band.add(first, mass[r], n);
            }
        }
        patch.band.finish();
    }

    fn scatter_volume<const K: usize>(&self, patch: &mut Patch<1>) {
        let rows = patch.block.rows();
        let length = &patch.block.columns[self.columns.length][..rows];
        let volume = &mut patch.nodes.fields[self.fields.volume];
        volume.fill(0.0);
        for run in &patch.runs {
            for r in run.clone() {
                let (first, n, _) = patch.stencils.row::<K>(r);
                add(volume, first, n.map(|n| n * length[r]));
            }
        }
    }

    /// Internal force f_i = sum_p (p + q) V G_i (pressure is positive in compression, so it
    /// pushes along the gradient).
    pub(super) fn scatter_force(&self, patch: &mut Patch<1>) {
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper) {
            let rows = patch.block.rows();
            let stress = &patch.block.columns[s.columns.stress_volume][..rows];
            let force = &mut patch.nodes.fields[s.fields.acceleration];
            for run in &patch.runs {
                for r in run.clone() {
                    let (first, _, g) = patch.stencils.row::<K>(r);
                    add(force, first, g.map(|g| g * stress[r]));
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
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
