//! Sides that press on the surface of what touched them at the start.
//!
//! ```text
//! A_i = sum V G_i.n,  f_i = -n p(t) A_i      of nodes that particles of the surface reach
//! ```
//!
//! sum V G_i is the surface of what the particles fill, in the quadrature of the internal force: a
//! body under the same pressure is at rest to rounding. The particles that ended at the side are
//! marked, and take the load with them.

use super::{MOST_NODES, Stepper, with_width};
use crate::solver::particles::load_bit;
use crate::solver::patch::Patch;

impl<const D: usize> Stepper<D> {
    /// The volumes of the own rows at volume ratio `jacobian` (a column).
    pub(super) fn find_loaded_volume(&self, patch: &mut Patch<D>, jacobian: usize) {
        let Some(load) = self.columns.load else { return };
        let n = patch.block.own();
        let mut volume = std::mem::take(&mut patch.block.columns[load.volume]);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j) = (column(self.columns.volume0), column(jacobian));
        volume.clear();
        volume.extend((0..n).map(|r| volume0[r] * j[r]));
        patch.block.columns[load.volume] = volume;
    }

    /// Adds the force of `pressure` [Pa] at the lower or upper `end` of direction `axis`.
    pub(super) fn press(&self, patch: &mut Patch<D>, axis: usize, end: usize, pressure: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            axis: usize,
            end: usize,
            pressure: f64,
        ) {
            let Some([low, high]) = s.loaded_cells(patch, axis, end) else { return };
            let outward = if end == 0 { -1.0 } else { 1.0 };
            // nodes that a marked row may reach, and rows that may reach those
            let reach = K as i64 + 1;
            let Some(boxes) = s.start_side(patch, axis, low - reach, high + reach + 1, 2) else {
                return;
            };
            let near = low - 2 * reach..=high + 2 * reach;
            s.sum_surface::<K>(patch, axis, end, outward, |cell| near.contains(&cell));
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    let at = layer * patch.nodes.nodes.count() + patch.nodes.nodes.flat(index);
                    let value = |k: usize| patch.nodes.fields[k][at];
                    let (area, touched) = (value(s.fields.side), value(s.fields.side + 1));
                    // a surface that looks inward is the body's other end
                    if area <= 0.0 || touched <= 0.0 || value(s.fields.mass) <= s.empty_mass {
                        continue;
                    }
                    let along = -outward * pressure * area;
                    let force = std::array::from_fn(|a| if a == axis { along } else { 0.0 });
                    s.push(patch, at, index, force, false);
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, self, axis, end, pressure));
    }

    /// Whether a side presses on a row.
    fn is_loaded(&self, patch: &Patch<D>, row: usize, axis: usize, end: usize) -> bool {
        let load = self.columns.load.expect("a loaded side has the columns");
        patch.block.columns[load.mark][row] as u8 & load_bit(axis, end) != 0
    }

    /// The least and the greatest cell along `axis` of the rows that a side presses on.
    fn loaded_cells(&self, patch: &Patch<D>, axis: usize, end: usize) -> Option<[i64; 2]> {
        let rows = patch.runs.iter().cloned().flatten();
        let cells = rows
            .filter(|&r| self.is_loaded(patch, r, axis, end))
            .map(|r| i64::from(patch.block.cells[r][axis]));
        cells.fold(None, |range: Option<[i64; 2]>, cell| {
            let [low, high] = range.unwrap_or([cell, cell]);
            Some([low.min(cell), high.max(cell)])
        })
    }

    /// Sums over the rows near a side: the surface sum V G.n, and sum m N of the marked ones.
    fn sum_surface<const K: usize>(
        &self,
        patch: &mut Patch<D>,
        axis: usize,
        end: usize,
        outward: f64,
        near: impl Fn(i64) -> bool,
    ) {
        let load = self.columns.load.expect("a loaded side has the columns");
        let first = self.fields.side;
        let [mut area, mut touched] =
            [0, 1].map(|k| std::mem::take(&mut patch.nodes.fields[first + k]));
        for r in patch.runs.iter().cloned().flatten() {
            if !near(i64::from(patch.block.cells[r][axis])) {
                continue;
            }
            let row = patch.stencils.row::<K, D>(r);
            let volume = outward * patch.block.columns[load.volume][r];
            row.add(&mut area, row.gradient(axis), |g| g * volume);
            if self.axisymmetric && axis == 0 {
                let hoop = volume / self.radius(patch, r);
                row.add(&mut area, row.values, |n| n * hoop);
            }
            if self.is_loaded(patch, r, axis, end) {
                let m = patch.block.columns[self.columns.mass][r];
                row.add(&mut touched, row.values, |n| n * m);
            }
        }
        patch.nodes.fields[first] = area;
        patch.nodes.fields[first + 1] = touched;
    }
}
