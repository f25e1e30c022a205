//! Particles to grid: each sum runs over own rows and ghosts in canonical order, so that all
//! patches that hold a node get the same bits for it.

use super::{MOST_NODES, Stepper, with_width};
use crate::effects::Effect;
use crate::solver::clock::spend;
use crate::solver::patch::Patch;
use crate::solver::transfer::{Scheme, cut, lines};

impl<const D: usize> Stepper<D> {
    /// All sums of a patch at new places of its rows, with or without the force, and the lumped
    /// velocity and acceleration from them in a step of `dt`, with the forces at `time` [s].
    pub(super) fn scatter(&self, patch: &mut Patch<D>, force: bool, time: f64, dt: f64) {
        let anew = self.find_weights(patch);
        self.scatter_rows(patch, force, anew);
        if force {
            self.push_at_sides(patch, time, dt);
        }
        if let Some(contact) = &self.contact {
            spend(Effect::Contact, patch, |p| self.find_contact(p, contact, dt, force));
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

    /// Mass and momentum of the nodes, the mass matrix and the filled volume where the scheme
    /// needs them, and with `force` the internal force f_i = sum_p (p + q) V G_i (pressure is
    /// positive in compression, so it pushes along the gradient): all in one pass over the rows.
    /// Where the weights are not `anew`, mass, matrix and volume are those of the last step.
    pub(super) fn scatter_rows(&self, patch: &mut Patch<D>, force: bool, anew: bool) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            force: bool,
            anew: bool,
        ) {
            if !anew && s.columns.affine.is_none() && s.contact.is_none() {
                return s.scatter_moving::<K>(patch, force);
            }
            match (s.needs_matrix(), s.columns.affine) {
                (true, None) => s.scatter_width::<K, true, false>(patch, force),
                (false, None) => s.scatter_width::<K, false, false>(patch, force),
                (true, Some(_)) => s.scatter_width::<K, true, true>(patch, force),
                (false, Some(_)) => s.scatter_width::<K, false, true>(patch, force),
            }
        }
        self.turn_images(patch);
        let tensor = self.tensor_stress();
        with_width!(patch.stencils.width, go(patch, self, force && !tensor, anew));
        if force && tensor {
            self.scatter_stress(patch);
        }
        if force {
            self.turn_forces(patch);
            self.scatter_body_force(patch);
            self.scatter_inertia(patch);
        }
    }

    fn scatter_width<const K: usize, const MATRIX: bool, const AFFINE: bool>(
        &self,
        patch: &mut Patch<D>,
        force: bool,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let scalars = [f.mass].into_iter().chain(f.scratch..f.scratch + f.scratches);
        let vectors = [f.lumped, f.acceleration].into_iter().chain(f.remainder);
        let components = vectors.flat_map(|v| v..v + D);
        for field in scalars.chain(components) {
            patch.nodes.fields[field].fill(0.0);
        }
        if MATRIX {
            let nodes = patch.nodes.layers * patch.nodes.nodes.count();
            patch.band.clear(nodes, K, D, patch.nodes.nodes.extent(0));
        }
        // fields leave the list while the others are read and written
        let mut take = |k: usize| std::mem::take(&mut patch.nodes.fields[k]);
        let mut masses = take(f.mass);
        let mut momenta: [Vec<f64>; D] = std::array::from_fn(|a| take(f.lumped + a));
        let mut forces: [Vec<f64>; D] = std::array::from_fn(|a| take(f.acceleration + a));
        let mut volumes = self.edge_mask.map(|_| take(f.volume));
        // of one length, so that a window is looked up once for all of them
        let nodes = masses.len();
        let nodal_mass = &mut masses[..];
        let momentum = &mut momenta.each_mut().map(|field| &mut field[..nodes]);
        let nodal_force = &mut forces.each_mut().map(|field| &mut field[..nodes]);
        let mut volume = volumes.as_mut().map(|field| &mut field[..nodes]);
        if let Some(volume) = &mut volume {
            volume.fill(0.0);
        }
        let rows = patch.block.rows();
        let column = |k: usize| &patch.block.columns[k][..rows];
        let vector = |k: usize| -> [&[f64]; D] { std::array::from_fn(|a| column(k + a)) };
        let (mass, velocity) = (column(c.mass), vector(c.velocity));
        let stress = column(c.stress_volume);
        let filled = c.filled.map_or(&[][..], column);
        let affine = c.affine.filter(|_| AFFINE);
        for run in &patch.runs {
            for (r, row) in run.clone().zip(patch.stencils.rows::<K, D>(run.clone())) {
                let m = mass[r];
                row.add(nodal_mass, row.values, |n| n * m);
                match affine {
                    None => {
                        for a in 0..D {
                            let mv = m * velocity[a][r];
                            row.add(momentum[a], row.values, |n| n * mv);
                        }
                    }
                    Some(affine) => {
                        // m N (v + C (x_i - x_p))
                        let offset = self.offset(patch, r, row.first);
                        for a in 0..D {
                            let mv = m * velocity[a][r];
                            let mc: [f64; D] = std::array::from_fn(|b| {
                                m * column(affine + D * a + b)[r] * self.cell[b]
                            });
                            for line in 0..const { lines(K, D) } {
                                let across = if D == 1 {
                                    mv
                                } else {
                                    mv + mc[D - 1] * (offset[D - 1] + line as f64)
                                };
                                let n = &row.values[line];
                                let at = row.first + line * row.stride;
                                for k in 0..K {
                                    momentum[a][at + k] +=
                                        n[k] * (across + mc[0] * (offset[0] + k as f64));
                                }
                            }
                        }
                    }
                }
                if MATRIX {
                    patch.band.add(&row, m);
                }
                if let Some(volume) = &mut volume {
                    let filled = filled[r];
                    row.add(volume, row.values, |n| n * filled);
                }
                if force {
                    let s = stress[r];
                    for a in 0..D {
                        row.add(nodal_force[a], row.gradient(a), |g| g * s);
                    }
                    // what moves a node outward strains the material about the axis
                    if D > 1 && self.axisymmetric {
                        let hoop = s / self.radius(patch, r);
                        row.add(nodal_force[0], row.values, |n| n * hoop);
                    }
                }
            }
        }
        if MATRIX {
            patch.band.finish();
        }
        let fields = &mut patch.nodes.fields;
        fields[f.mass] = masses;
        for (a, (momentum, force)) in momenta.into_iter().zip(forces).enumerate() {
            fields[f.lumped + a] = momentum;
            fields[f.acceleration + a] = force;
        }
        if let Some(volume) = volumes {
            fields[f.volume] = volume;
        }
    }

    /// Distance of a row from the axis at the place of its weights [m]; of an image beyond the axis
    /// or a wall about it that of the row itself, negative, since what pushes the row outward
    /// pushes its image inward.
    #[inline(always)]
    pub(super) fn radius(&self, patch: &Patch<D>, row: usize) -> f64 {
        if let Some(radius) = self.columns.radius {
            return patch.block.columns[radius][row];
        }
        let fraction = patch.block.columns[self.columns.fraction][row];
        let cell = patch.block.cells[row][0];
        let (lower, edge) = (self.lower[0], self.cell[0]);
        let at = lower + (f64::from(cell) + fraction) * edge;
        match i64::from(cell) {
            beyond if beyond < 0 => at - 2.0 * lower,
            beyond if beyond >= self.cells[0] => at - 2.0 * (lower + self.cells[0] as f64 * edge),
            _ => at,
        }
    }

    /// Where the window of `row` from node `first` on starts, seen from the row [cells].
    #[inline(always)]
    pub(super) fn offset(&self, patch: &Patch<D>, row: usize, first: usize) -> [f64; D] {
        let (nodes, cell) = (&patch.nodes.nodes, patch.block.cells[row]);
        let stride = patch.stencils.stride;
        let first = if patch.nodes.layers > 1 { first % nodes.count() } else { first };
        std::array::from_fn(|a| {
            let at = match (D, a) {
                (1, _) => first,
                (_, 0) => first % stride,
                _ => first / stride,
            };
            let fraction = patch.block.columns[self.columns.fraction + a][row];
            (at as i64 + nodes.lower[a] - i64::from(cell[a])) as f64 - fraction
        })
    }

    /// Lumped velocity and acceleration of the owned nodes from their sums; those too small to
    /// matter are cut to zero.
    pub(super) fn divide_by_mass(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        patch.nodes.fields[f.inverse].fill(0.0);
        let (still, slow) = (self.still_speed, self.still_acceleration);
        for line in &patch.active_lines {
            let [mass, inverse] = patch.nodes.fields_mut([f.mass, f.inverse]);
            for i in line.clone() {
                inverse[i] = if mass[i] > self.empty_mass { 1.0 / mass[i] } else { 0.0 };
            }
            for a in 0..D {
                let [inverse, lumped, acceleration] =
                    patch.nodes.fields_mut([f.inverse, f.lumped + a, f.acceleration + a]);
                for i in line.clone() {
                    lumped[i] = cut(lumped[i] * inverse[i], still);
                    acceleration[i] = cut(acceleration[i] * inverse[i], slow);
                }
            }
        }
        if self.contact.is_some() {
            self.join_sums(patch);
        }
        self.find_edge(patch);
    }
}
