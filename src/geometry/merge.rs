//! Merges slivers, cut tiles of which little is left, into neighbours.
//!
//! A light particle among heavy ones makes a material point method fail at a cut border.

use std::collections::HashMap;

use super::lattice::{Cut, Lattice};
use super::piece::Trapezium;
use super::shape::BoundedRegion;

/// Fraction of a whole tile below which a cut tile is a sliver.
const SLIVER: f64 = 0.02;

/// Area below which a cut tile is a sliver [m2].
pub(super) fn sliver_area(lattice: &Lattice) -> f64 {
    SLIVER * lattice.area()
}

/// Thickness, over a tile's edge, of the boxes that measure the shared part of an edge.
const THICKNESS: f64 = 1e-6;

/// Index offsets of neighbours: in y, then in x.
const FACES: [[i64; 2]; 4] = [[-1, 0], [0, -1], [0, 1], [1, 0]];
const CORNERS: [[i64; 2]; 4] = [[-1, -1], [-1, 1], [1, -1], [1, 1]];

/// State of the tiles during the merging.
struct Merger<'a> {
    shape: &'a BoundedRegion,
    lattice: &'a Lattice,
    cuts: &'a mut [Cut],
    /// For each tile, the tile into which it was merged: itself, or the next one in the chain.
    into: Vec<usize>,
    /// For each tile that received others, the indices of all its parts, itself included.
    members: HashMap<usize, Vec<usize>>,
}

/// Merges each sliver, smallest first, into the neighbour with the longest shared part of an edge;
/// of several, into the nearest. If there is none, it is merged across a gap or a corner. A sliver
/// without neighbours stays. `cuts` are sorted by their index; areas and moments are added exactly.
pub(super) fn merge(shape: &BoundedRegion, lattice: &Lattice, cuts: &mut Vec<Cut>) {
    let least = sliver_area(lattice);
    let mut slivers: Vec<usize> =
        (0..cuts.len()).filter(|&i| cuts[i].moments.area < least).collect();
    slivers.sort_by(|&a, &b| cuts[a].moments.area.total_cmp(&cuts[b].moments.area).then(a.cmp(&b)));
    let into = (0..cuts.len()).collect();
    let mut merger = Merger { shape, lattice, cuts, into, members: HashMap::new() };
    // one pass is enough: a processed sliver is merged, no longer a sliver, or isolated
    for sliver in slivers {
        if merger.cuts[sliver].moments.area < least {
            merger.merge(sliver);
        }
    }
    let into = merger.into;
    let mut number = 0;
    cuts.retain(|_| {
        number += 1;
        into[number - 1] == number - 1
    });
}

impl Merger<'_> {
    /// Merges a tile into its best neighbour, if it has one.
    fn merge(&mut self, tile: usize) {
        let members = self.members.remove(&tile).unwrap_or_else(|| vec![tile]);
        let Some(target) = self.neighbour(tile, &members) else {
            self.members.insert(tile, members);
            return;
        };
        let size = self.lattice.size();
        let (own, other) = (self.cuts[tile].index, self.cuts[target].index);
        let shift = [0, 1].map(|d| (own[1 - d] - other[1 - d]) as f64 * size[d]);
        let moments = self.cuts[tile].moments.shifted(shift);
        self.cuts[target].moments += moments;
        self.cuts[target].merged = true;
        self.into[tile] = target;
        self.members.entry(target).or_insert_with(|| vec![target]).extend(members);
    }

    fn root(&self, mut tile: usize) -> usize {
        while self.into[tile] != tile {
            tile = self.into[tile];
        }
        tile
    }

    /// The neighbour with the longest shared edge with `tile`, which consists of `members`; of
    /// several the nearest, so that a row of slivers does not become one tile.
    fn neighbour(&self, tile: usize, members: &[usize]) -> Option<usize> {
        for (steps, touching) in [(FACES, true), (CORNERS, false)] {
            let mut best: Option<(f64, f64, usize)> = None;
            for &member in members {
                let index = self.cuts[member].index;
                for step in steps {
                    let place = [index[0] + step[0], index[1] + step[1]];
                    let Ok(found) = self.cuts.binary_search_by_key(&place, |cut| cut.index) else {
                        continue;
                    };
                    let target = self.root(found);
                    if target == tile {
                        continue;
                    }
                    let shared = if touching { self.shared(index, step) } else { 0.0 };
                    let near = -self.distance(tile, target);
                    if best.is_none_or(|(s, n, _)| (shared, near) > (s, n)) {
                        best = Some((shared, near, target));
                    }
                }
            }
            if let Some((_, _, target)) = best {
                return Some(target);
            }
        }
        None
    }

    /// Distance between the centroids of two tiles [m].
    fn distance(&self, a: usize, b: usize) -> f64 {
        let place = |cut: &Cut| {
            let (centre, from) = (self.lattice.centre(cut.index), cut.moments.centroid());
            [centre[0] + from[0], centre[1] + from[1]]
        };
        let (a, b) = (place(&self.cuts[a]), place(&self.cuts[b]));
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// Length shared by a tile and its neighbour, as a fraction of their common edge, in
    /// thousandths: the part with the shape on both sides. It is measured by a thin box on each
    /// side.
    fn shared(&self, index: [i64; 2], step: [i64; 2]) -> f64 {
        let (centre, size) = (self.lattice.centre(index), self.lattice.size());
        let side = |inner: f64, outer: f64| {
            let corner = |sign: f64, thickness: f64| {
                [0, 1].map(|d| match step[1 - d] as f64 {
                    0.0 => centre[d] + sign * 0.5 * size[d],
                    step => centre[d] + step * (0.5 + thickness) * size[d],
                })
            };
            let [a, b] = [corner(-1.0, inner), corner(1.0, outer)];
            let [lower, upper] = [f64::min, f64::max].map(|f| [f(a[0], b[0]), f(a[1], b[1])]);
            self.shape.overlap(&Trapezium::upright(lower, upper), centre).area
        };
        let both = side(-THICKNESS, 0.0).min(side(0.0, THICKNESS));
        (1e3 * both / (THICKNESS * size[0] * size[1])).round()
    }
}
