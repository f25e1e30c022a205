//! Memory of a patch in the steps, from the declared columns, nodal fields, weights and matrices.

use decomp::array;

use super::nodal_matrix::NodalMatrix;
use super::reach::StencilRadius;
use super::stepper::Stepper;
use crate::shape::padded_width;
use crate::solver::shape_weights::Group;

/// Sizes of a patch that determine its memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchSize {
    /// Own particles.
    pub own: u64,
    /// Copies of particles of other patches, images among them.
    pub ghosts: u64,
    /// Cells of the patch along its edges.
    pub cells: [u64; 2],
    /// Depth of the ghost layers [cells].
    pub ghost_layers: i64,
}

const DOUBLE: usize = size_of::<f64>();

impl<const D: usize> Stepper<D> {
    /// Memory of a patch [bytes] whose longest particle is `longest` [cells], with the copy of its
    /// state that the monitor keeps, and the words of its ghosts in messages.
    pub fn patch_bytes(&self, longest: f64, reach: StencilRadius, size: &PatchSize) -> u64 {
        let specs = &self.columns.specs;
        let ghost_columns = specs.iter().filter(|spec| spec.ghost).count();
        let place = size_of::<u64>() + D * size_of::<i32>();
        let words = DOUBLE * (1 + D + ghost_columns);
        let weights = self.weight_and_matrix_bytes(padded_width(self.shape.nodes(longest)));
        // and one reusable value per particle
        let own = place + DOUBLE * (specs.len() + 1) + weights + self.columns.state_bytes(D);
        let ghost = place + DOUBLE * ghost_columns + weights + words;
        let depth = reach.depth(size.ghost_layers) as u64;
        let nodes =
            size.cells[..D].iter().fold(1, |all: u64, n| all.saturating_mul(n + 2 * depth + 1));
        let node = self.node_bytes(padded_width(self.shape.nodes(longest)));
        let parts = [(size.own, own), (size.ghosts, ghost), (nodes, node)];
        parts.into_iter().fold(0, |all: u64, (count, bytes)| {
            all.saturating_add(count.saturating_mul(bytes as u64))
        })
    }

    /// Memory of the weights of a particle, and of the matrices, on windows of `width` nodes [bytes].
    fn weight_and_matrix_bytes(&self, width: usize) -> usize {
        if self.sums_corners() {
            return 0;
        }
        let nodes = width.pow(D as u32);
        // values, gradients, the first node, and at most one group per particle
        let group = if D > 1 { size_of::<Group>() } else { 0 };
        let weights = DOUBLE * nodes * (1 + D) + size_of::<u32>() + group;
        let [_, matrices] = self.matrix_bytes(width);
        let kept = DOUBLE * nodes * D + size_of::<u64>() + D * size_of::<i32>();
        if self.total_lagrangian { weights + kept + matrices } else { weights + matrices }
    }

    /// Memory of a node: fields and matrices of all layers [bytes].
    fn node_bytes(&self, width: usize) -> usize {
        let [matrices, _] = self.matrix_bytes(width);
        // sums over corners have four numbers of each node side by side
        let beside = if self.sums_corners() { 4 * DOUBLE } else { 0 };
        self.layers * (DOUBLE * self.fields.count + matrices) + beside
    }

    /// Memory of the matrices per node and per particle [bytes].
    fn matrix_bytes(&self, width: usize) -> [usize; 2] {
        let others = usize::from(self.relaxation.is_some()) + self.of_effects.matrices;
        let spin = self.columns.spin.is_some();
        let mass = match self.needs_matrix() || spin {
            true => NodalMatrix::bytes(width, D, spin),
            false => [0; 2],
        };
        let other = NodalMatrix::bytes(width, D, false);
        array::from_fn(|k| mass[k] + others * other[k])
    }
}
