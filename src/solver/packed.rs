//! Windows of at most four nodes along a direction in vectors of four numbers, for sums over several
//! particles with one window and for several sums over one particle. A line of the window fills one
//! vector, and a window of two nodes along each direction of a plane fills one too. In a patch with
//! wider windows, `K` is their number of nodes, and narrow particles have weights on the first four
//! alone.
//!
//! The sums have the bits of [`ParticleWeights`](super::particle_weights::ParticleWeights).
//!
//! This module does not depend on materials, time stepping or messages.

use decomp::array::from_fn;
use wide::f64x4;

use crate::shape::{fours, vector};
use crate::solver::particle_weights::{NARROW, window};

/// Greatest number of nodes along a direction of such a window.
pub const PACKED: usize = NARROW;

/// Number of nodes with weights along a direction, of the `width` of a window.
pub(super) const fn packed_nodes(width: usize) -> usize {
    if width < PACKED { width } else { PACKED }
}

/// Whether a window in a plane, of `width` nodes along each direction, fills one vector. On a line no
/// window does.
pub(super) const fn is_one_vector(width: usize) -> bool {
    width == 2
}

/// Weights of one particle on its window. Numbers beyond the nodes of a line belong to other lines; with
/// two nodes along each direction the second half of the vector is the second line.
#[derive(Clone, Copy, Debug)]
pub struct PackedWeights<const V: usize, const D: usize> {
    /// Values.
    pub values: [f64x4; V],
    /// Gradients along each direction [1/m].
    pub gradients: [[f64x4; V]; D],
}

/// Lines of `K` numbers that follow each other.
///
/// # Panics
///
/// If `numbers` has fewer than `(V - 1) * K + 4` numbers.
#[inline(always)]
pub(super) fn pack<const K: usize, const V: usize>(numbers: &[f64]) -> [f64x4; V] {
    // one check for all lines
    let numbers = &numbers[..const { (V - 1) * K + PACKED }];
    from_fn(|line| vector(window(numbers, line * K)))
}

/// Place of a window in the patch's arrays: its first node, and the distance from a line to the
/// next, in 32 bits each, so that no index of a node overflows.
#[derive(Clone, Copy, Debug)]
pub struct WindowPlace {
    /// First node.
    pub first: u32,
    /// Distance from a line to the next.
    pub stride: u32,
}

impl WindowPlace {
    /// Nodes of the window in `field`.
    #[inline(always)]
    pub fn nodes<const K: usize, const V: usize>(&self, field: &[f64]) -> [f64x4; V] {
        if const { is_one_vector(K) } {
            let [[a, b], [c, d]] = [0, 1].map(|line| *window::<2>(field, self.line(line)));
            return [f64x4::from([a, b, c, d]); V];
        }
        self.check::<K, V, _>(field);
        from_fn(|line| {
            let at = self.line(line);
            // SAFETY: no line ends beyond the last one, which `check` has found within the field, as
            // sums of 32-bit numbers do not overflow 64 bits
            let line = unsafe { field.get_unchecked(at..at + const { packed_nodes(K) }) };
            // the nodes in a vector as a constant argument cannot be computed from K
            match const { K <= PACKED } {
                true => fours(window::<K>(line, 0), 0),
                false => fours(window::<PACKED>(line, 0), 0),
            }
        })
    }

    /// First node of a line.
    #[inline(always)]
    fn line(&self, line: usize) -> usize {
        const {
            assert!(
                usize::BITS >= 64,
                "indices of 64 bits, so that first + line * stride does not overflow"
            )
        };
        self.first as usize + line * self.stride as usize
    }

    /// One check for all lines of the window instead of one for each.
    ///
    /// # Panics
    ///
    /// If the last line of the window ends beyond `field`.
    #[inline(always)]
    fn check<const K: usize, const V: usize, T>(&self, field: &[T]) {
        let end = self.line(V - 1) + const { packed_nodes(K) };
        assert!(end <= field.len(), "a window beyond the field");
    }

    /// Both lines of two nodes in `field`, to read.
    ///
    /// # Panics
    ///
    /// If the second line ends beyond `field`.
    #[inline(always)]
    pub fn square<T>(self, field: &[T]) -> [&[T; 2]; 2] {
        self.check::<2, 2, _>(field);
        // SAFETY: the second line ends within the field, and so does the first
        [0, 1].map(|line| unsafe { &*field.as_ptr().add(self.line(line)).cast() })
    }

    /// The same, to write to.
    ///
    /// # Panics
    ///
    /// If the second line ends beyond `field`, or the lines overlap.
    #[inline(always)]
    pub fn square_mut<T>(self, field: &mut [T]) -> [&mut [T; 2]; 2] {
        self.check::<2, 2, _>(field);
        assert!(self.stride >= 2, "lines overlap");
        let first = field.as_mut_ptr();
        // SAFETY: the second line ends within the field, and so does the first; they do not overlap, as
        // a line of two nodes is not longer than the stride
        [0, 1].map(|line| unsafe { &mut *first.add(self.line(line)).cast() })
    }

    /// Writes the nodes of the window to `field`.
    #[inline(always)]
    pub fn put<const K: usize, const V: usize>(&self, field: &mut [f64], nodes: &[f64x4; V]) {
        if const { is_one_vector(K) } {
            let lines = nodes[0].to_array();
            for (line, numbers) in lines.as_chunks::<2>().0.iter().enumerate() {
                field[self.line(line)..][..2].copy_from_slice(numbers);
            }
            return;
        }
        self.check::<K, V, _>(field);
        for (line, nodes) in nodes.iter().enumerate() {
            let nodes = nodes.to_array();
            let at = self.line(line);
            let count = const { packed_nodes(K) };
            // SAFETY: as in `nodes`
            let line = unsafe { field.get_unchecked_mut(at..at + count) };
            line.copy_from_slice(&nodes[..count]);
        }
    }
}

/// Adds `term` of each weight to `nodes`.
#[inline(always)]
pub fn add_to<const V: usize>(nodes: &mut [f64x4; V], weights: &[f64x4; V], term: f64) {
    let term = f64x4::splat(term);
    for (node, weight) in nodes.iter_mut().zip(weights) {
        *node += *weight * term;
    }
}

/// Weights times nodal values, added over the lines: see [`totals`].
#[inline(always)]
pub fn dot<const V: usize>(weights: &[f64x4; V], nodes: &[f64x4; V]) -> f64x4 {
    let mut sum = weights[0] * nodes[0];
    for line in 1..V {
        sum += weights[line] * nodes[line];
    }
    sum
}

/// Sum over the nodes of a window that is one vector, over its lines first.
#[inline(always)]
pub fn total(sum: f64x4) -> f64 {
    let [a, b, c, d] = sum.to_array();
    0.0 + (a + c) + (b + d)
}

/// Sums over the nodes for each of four vectors, which [`dot`] has added over the lines; a window of two
/// nodes along each direction is added over its lines here.
#[inline(always)]
pub fn totals<const K: usize>(sums: [f64x4; 4]) -> [f64; 4] {
    let columns = f64x4::transpose(sums);
    if const { is_one_vector(K) } {
        // over the lines first
        return (f64x4::ZERO + (columns[0] + columns[2]) + (columns[1] + columns[3])).to_array();
    }
    // from +0 on, as sums of one particle
    let mut total = f64x4::ZERO;
    for column in &columns[..const { packed_nodes(K) }] {
        total += *column;
    }
    total.to_array()
}

/// Calls `$call` with the width of windows in a plane, the number of vectors that hold a window of three
/// or four nodes along a direction, and the dimension. Where windows are wider, only narrow particles
/// have their weights in so many vectors. Evaluates `$other` on a line, where few successive particles
/// have the same window, and for two nodes: these have sums of their own.
macro_rules! with_packed {
    ($width:expr, $call:ident ( $($arg:expr),* ), $other:expr) => {
        match $width {
            3 if const { D > 1 } => $call::<3, 3, D>($($arg),*),
            4 if const { D > 1 } => $call::<4, 4, D>($($arg),*),
            6 if const { D > 1 } => $call::<6, 4, D>($($arg),*),
            10 if const { D > 1 } => $call::<10, 4, D>($($arg),*),
            _ => $other,
        }
    };
}
pub(crate) use with_packed;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::particle_weights::{ParticleWeights, lines};
    use crate::solver::shape_weights::Stencils;

    /// Three particles on windows that start at node 5, 5 and 6, in lines of `K + 3` nodes; narrow
    /// ones, if the windows are wider.
    fn three<const K: usize, const D: usize>() -> (Stencils, Vec<f64>) {
        let stride = K + 3;
        let mut stencils = Stencils::default();
        stencils.resize::<K, D>(3, stride);
        stencils.first.copy_from_slice(&[5, 5, 6]);
        stencils.narrow.fill(true);
        let number = |k: usize| ((k * k * 31 + k * 17) % 97) as f64 / 7.0 - 6.0;
        stencils.values.iter_mut().enumerate().for_each(|(k, v)| *v = number(k));
        stencils.gradients.iter_mut().enumerate().for_each(|(k, g)| *g = number(k + 5));
        // the last window ends with the field
        let nodes = 6 + (lines(K, D) - 1) * stride + K;
        (stencils, (0..nodes).map(|k| number(3 * k + 1)).collect())
    }

    fn check<const K: usize, const V: usize, const D: usize>() {
        let (mut stencils, field) = three::<K, D>();
        stencils.find_groups::<K>(std::slice::from_ref(&(0..3)));
        let groups: Vec<_> = stencils.groups.iter().map(|group| group.particles()).collect();
        assert_eq!(groups, [0..2, 2..3]);
        // gather: four sums at a time are those of one particle and one field
        for r in 0..3 {
            let weights: ParticleWeights<'_, K, D> = stencils.particle(r);
            let packed = stencils.packed::<K, V, D>(r);
            let nodes = stencils.place(r).nodes::<K, V>(&field);
            let slope = dot(&packed.gradients[D - 1], &nodes);
            let sums = [dot(&packed.values, &nodes), slope, f64x4::ZERO, slope];
            let expected = [
                weights.dot(weights.values, &field),
                weights.dot(weights.gradient(D - 1), &field),
                0.0,
                weights.dot(weights.gradient(D - 1), &field),
            ];
            assert_eq!(totals::<K>(sums).map(f64::to_bits), expected.map(f64::to_bits));
            if is_one_vector(K) {
                assert_eq!(sums.map(|sum| total(sum).to_bits()), expected.map(f64::to_bits));
            }
        }
        // scatter: sums over a group are those over one particle after the other
        let (mut one, mut together) = (field.clone(), field);
        for group in groups {
            let place = stencils.place(group.start);
            let mut nodes = place.nodes::<K, V>(&together);
            for r in group {
                let weights: ParticleWeights<'_, K, D> = stencils.particle(r);
                let term = 0.7 + r as f64;
                weights.add(&mut one, weights.values, |n| n * term);
                add_to(&mut nodes, &stencils.packed_values::<K, V, D>(r), term);
            }
            place.put::<K, V>(&mut together, &nodes);
        }
        assert_eq!(one, together, "{K} nodes");
    }

    #[test]
    fn sums_in_vectors_have_the_bits_of_sums_one_by_one() {
        check::<3, 1, 1>();
        check::<4, 1, 1>();
        check::<2, 1, 2>();
        check::<3, 3, 2>();
        check::<4, 4, 2>();
        check::<6, 4, 2>();
        check::<10, 4, 2>();
    }

    #[test]
    fn narrow_and_wide_particles_are_never_in_one_group() {
        let (mut stencils, _) = three::<6, 2>();
        stencils.first.fill(5);
        stencils.narrow[1] = false;
        let groups = |stencils: &mut Stencils| {
            stencils.find_groups::<6>(std::slice::from_ref(&(0..3)));
            let groups = stencils.groups.iter();
            groups.map(|group| (group.particles(), group.packed_count())).collect::<Vec<_>>()
        };
        assert_eq!(groups(&mut stencils), [(0..1, 1), (1..2, 0), (2..3, 1)]);
        stencils.narrow[0] = false;
        assert_eq!(groups(&mut stencils), [(0..2, 0), (2..3, 1)]);
    }

    /// Weights (1/4, 1/2, 1/4) on nodes with 2, 4 and 6: a sum of 4; masses of 2 and 3 kg add up.
    #[test]
    fn two_particles_by_hand() {
        let mut stencils = Stencils::default();
        stencils.resize::<3, 1>(2, 8);
        stencils.first.copy_from_slice(&[1, 1]);
        stencils.values[..6].copy_from_slice(&[0.25, 0.5, 0.25, 0.0, 0.5, 0.5]);
        let field = [9.0, 2.0, 4.0, 6.0, 9.0, 9.0];
        let nodes = stencils.place(0).nodes::<3, 1>(&field);
        let sums = [0, 1, 0, 1].map(|r| dot(&stencils.packed_values::<3, 1, 1>(r), &nodes));
        assert_eq!(totals::<3>(sums), [4.0, 5.0, 4.0, 5.0]);
        let mut masses = [0.0; 6];
        let mut nodes = stencils.place(0).nodes::<3, 1>(&masses);
        add_to(&mut nodes, &stencils.packed_values::<3, 1, 1>(0), 2.0);
        add_to(&mut nodes, &stencils.packed_values::<3, 1, 1>(1), 3.0);
        stencils.place(0).put::<3, 1>(&mut masses, &nodes);
        assert_eq!(masses, [0.0, 0.5, 2.5, 2.0, 0.0, 0.0]);
    }

    #[test]
    #[should_panic(expected = "a window beyond the field")]
    fn a_window_beyond_the_field_is_refused() {
        let place = WindowPlace { first: 5, stride: 10 };
        place.nodes::<4, 4>(&[0.0; 38]);
    }
}
