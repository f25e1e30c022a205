//! Slivers: tiles of which the border leaves little, merged into a neighbour.
//!
//! A light particle among heavy ones is what makes a material point method fail at a cut border.

use std::collections::HashMap;

use super::fill::{Cut, Lattice};
use super::piece::Trapezium;
use super::shape::Shape;

/// Share of a whole tile below which a cut one is a sliver.
pub(super) const SLIVER: f64 = 0.02;

/// Thickness, over a tile's edge, of the boxes that find what two tiles share of an edge.
const THICKNESS: f64 = 1e-6;

/// Steps to neighbours: in y, then in x.
const FACES: [[i64; 2]; 4] = [[-1, 0], [0, -1], [0, 1], [1, 0]];
const CORNERS: [[i64; 2]; 4] = [[-1, -1], [-1, 1], [1, -1], [1, 1]];

/// Tiles while they are merged.
struct Merger<'a> {
    shape: &'a Shape,
    lattice: &'a Lattice,
    cuts: &'a mut [Cut],
    /// The tile that each went into: itself, or one to ask further.
    into: Vec<usize>,
    /// What went into a tile, itself included, if anything did.
    members: HashMap<usize, Vec<usize>>,
}

/// Merges each sliver, the least first, into the neighbour with which it shares most of an edge,
/// of several the nearest; failing that into one across a gap or a corner. One that has no
/// neighbour stays. `cuts` are in the order of their index; areas and moments are added exactly.
pub(super) fn merge(shape: &Shape, lattice: &Lattice, cuts: &mut Vec<Cut>) {
    let size = lattice.size();
    let least = SLIVER * size[0] * size[1];
    let mut slivers: Vec<usize> =
        (0..cuts.len()).filter(|&i| cuts[i].moments.area < least).collect();
    slivers.sort_by(|&a, &b| cuts[a].moments.area.total_cmp(&cuts[b].moments.area).then(a.cmp(&b)));
    let into = (0..cuts.len()).collect();
    let mut merger = Merger { shape, lattice, cuts, into, members: HashMap::new() };
    // one pass is enough: what has been looked at is merged, no sliver any more, or alone
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
    /// Merges a tile into the best neighbour, if it has one.
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
        self.into[tile] = target;
        self.members.entry(target).or_insert_with(|| vec![target]).extend(members);
    }

    fn root(&self, mut tile: usize) -> usize {
        while self.into[tile] != tile {
            tile = self.into[tile];
        }
        tile
    }

    /// The neighbour of `tile`, which consists of `members`, that shares most of an edge with it;
    /// of several the nearest, lest a row of slivers become one.
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

    /// Share, to a thousandth, of the edge between a tile and its neighbour on both sides of which
    /// the shape lies, from what lies in a thin box on each side.
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
