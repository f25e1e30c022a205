//! The weights of a patch's rows on its nodes, and what a frame keeps of them.
//!
//! Knows no materials, no time stepping, no messages.

use std::ops::Range;

use decomp::Block;

use crate::solver::transfer::{NARROW, Row, lines};

/// The weights of every row of a patch, ghosts too, on windows of `width` nodes along each
/// direction.
#[derive(Clone, Debug, Default)]
pub struct Stencils {
    /// Nodes along one direction.
    pub width: usize,
    /// From a line of nodes to the next in the patch's arrays.
    pub stride: usize,
    /// First node of each row, in the patch's arrays.
    pub first: Vec<u32>,
    /// Whether a row's weights beyond the first [`NARROW`] nodes are zero, where windows are wider.
    pub narrow: Vec<bool>,
    /// Values, `width`^D a row.
    pub values: Vec<f64>,
    /// Gradients [1/m], `width`^D a row for each direction.
    pub gradients: Vec<f64>,
    /// What the total-Lagrangian frame keeps.
    kept: Kept,
}

/// What the total-Lagrangian frame keeps from step to step: a row's weights follow from its id and
/// the cell that it, or its image, is seen in.
#[derive(Clone, Debug, Default)]
struct Kept {
    /// Gradients with regard to the first places [1/m].
    gradients: Vec<f64>,
    ids: Vec<u64>,
    /// Cells, a component after the other.
    cells: Vec<i32>,
}

impl Stencils {
    /// The weights of `row`.
    #[inline(always)]
    pub fn row<const K: usize, const D: usize>(&self, row: usize) -> Row<'_, K, D> {
        let nodes = const { K * lines(K, D) };
        Row {
            first: self.first[row] as usize,
            stride: self.stride,
            narrow: K > NARROW && self.narrow[row],
            values: self.values[row * nodes..(row + 1) * nodes].as_chunks().0,
            gradients: self.gradients[row * nodes * D..(row + 1) * nodes * D].as_chunks().0,
        }
    }

    /// The weights of `rows`, one after the other: without the checks of looking each up.
    #[inline(always)]
    pub fn rows<const K: usize, const D: usize>(
        &self,
        rows: Range<usize>,
    ) -> impl Iterator<Item = Row<'_, K, D>> {
        let nodes = const { K * lines(K, D) };
        let first = self.first[rows.clone()].iter();
        let values = self.values[rows.start * nodes..rows.end * nodes].chunks_exact(nodes);
        let gradients =
            self.gradients[rows.start * nodes * D..rows.end * nodes * D].chunks_exact(nodes * D);
        // none where windows are not wider
        let narrow = self.narrow.get(rows).unwrap_or_default();
        let weights = first.zip(values).zip(gradients).enumerate();
        weights.map(move |(at, ((&first, values), gradients))| Row {
            first: first as usize,
            stride: self.stride,
            narrow: K > NARROW && narrow[at],
            values: values.as_chunks().0,
            gradients: gradients.as_chunks().0,
        })
    }

    /// Whether all rows of `block`, ghosts too, are those whose weights were last kept.
    pub fn are_kept<const D: usize>(&self, block: &Block<D>) -> bool {
        let cells = &block.cells[..block.rows()];
        !self.kept.ids.is_empty()
            && self.kept.ids == block.ids
            && self.kept.cells.as_slice() == cells.as_flattened()
    }

    /// Keeps the weights just found for `block`, whose gradients are with regard to the first places.
    pub fn keep<const D: usize>(&mut self, block: &Block<D>) {
        let Stencils { gradients, kept, .. } = self;
        std::mem::swap(gradients, &mut kept.gradients);
        gradients.resize(kept.gradients.len(), 0.0);
        kept.ids.clone_from(&block.ids);
        kept.cells.clear();
        kept.cells.extend_from_slice(block.cells[..block.rows()].as_flattened());
    }

    /// Forgets what it keeps.
    pub fn forget(&mut self) {
        self.kept = Kept::default();
    }

    /// Pushes the kept gradients of all rows of `block` forward with the inverse of F in the columns
    /// from `push` on, G = F^-T G0.
    pub fn push_gradients<const K: usize, const D: usize>(
        &mut self,
        block: &Block<D>,
        push: usize,
    ) {
        let rows = block.rows();
        let nodes = const { K * lines(K, D) };
        let inverse = |k: usize| &block.columns[push + k][..rows];
        let pairs = (self.gradients.chunks_exact_mut(nodes * D))
            .zip(self.kept.gradients.chunks_exact(nodes * D))
            .enumerate();
        if D == 1 {
            let f = inverse(0);
            for (r, (gradients, first)) in pairs {
                for (g, g0) in gradients.iter_mut().zip(first) {
                    *g = f[r] * g0;
                }
            }
            return;
        }
        let [xx, xy, yx, yy] = std::array::from_fn(inverse);
        for (r, (gradients, first)) in pairs {
            let (gx, gy) = gradients.split_at_mut(nodes);
            let (x, y) = first.split_at(nodes);
            for k in 0..nodes {
                gx[k] = xx[r] * x[k] + yx[r] * y[k];
                gy[k] = xy[r] * x[k] + yy[r] * y[k];
            }
        }
    }

    /// Gradients of a row with regard to its first place along `axis` [1/m], a line after the other.
    pub fn first_gradient<const K: usize, const D: usize>(
        &self,
        row: usize,
        axis: usize,
    ) -> &[[f64; K]] {
        let nodes = const { K * lines(K, D) };
        let from = (row * D + axis) * nodes;
        self.kept.gradients[from..from + nodes].as_chunks().0
    }
}
