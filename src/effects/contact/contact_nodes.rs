//! Meetings: nodes that rows of several bodies touch, and those rows.

use std::ops::Range;

use decomp::IndexBox;
use smallvec::SmallVec;

use crate::solver::shape_weights::Stencils;
use crate::solver::transfer::lines;

/// A row that touches a meeting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Touch {
    /// Its number.
    pub row: u32,
    /// The node's place in its window, a line after the other.
    pub at: u32,
}

/// A body at a meeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member<const D: usize> {
    /// Its layer.
    pub layer: usize,
    /// Its lumped mass [kg].
    pub mass: f64,
    /// Its lumped velocity [m/s].
    pub velocity: [f64; D],
    /// Its lumped acceleration without contact [m/s2].
    pub acceleration: [f64; D],
    /// Its filled volume at the node, sum V N [cells].
    pub volume: f64,
    /// The gradient of its filled volume, sum V G: it points out of the body [cells/m].
    pub gradient: [f64; D],
}

/// The meetings of a patch. Each has the rows that touch it in canonical order.
#[derive(Clone, Debug, Default)]
pub struct Meetings<const D: usize> {
    /// Places of the nodes in a layer.
    nodes: Vec<u32>,
    /// 1 + the number of the meeting at each node of a layer; 0: none.
    number: Vec<u32>,
    /// Whether a window from each node on holds a meeting.
    near: Vec<bool>,
    starts: Vec<u32>,
    touches: Vec<Touch>,
}

impl<const D: usize> Meetings<D> {
    /// Finds the nodes of `nodes` at which more than one layer holds more than `least` of `mass`,
    /// among the nodes that each layer computes, and the rows of windows `K` wide that touch them,
    /// in the order of `runs`.
    pub fn find<const K: usize>(
        &mut self,
        mass: &[f64],
        least: f64,
        nodes: &IndexBox<D>,
        active: &[IndexBox<D>],
        stencils: &Stencils,
        runs: &[Range<usize>],
    ) {
        let (count, stride) = (nodes.count(), stencils.stride);
        self.number.clear();
        self.number.resize(count, 0);
        self.near.clear();
        self.near.resize(count, false);
        self.nodes.clear();
        for a in 0..active.len() {
            for b in a + 1..active.len() {
                let both = active[a].intersect(&active[b]);
                if both.is_empty() {
                    continue;
                }
                for node in both.lines_in(nodes).flatten() {
                    let holds = |layer: usize| mass[layer * count + node] > least;
                    if self.number[node] == 0 && holds(a) && holds(b) {
                        self.nodes.push(node as u32);
                        self.number[node] = self.nodes.len() as u32;
                    }
                }
            }
        }
        let window = || (0..lines(K, D)).flat_map(move |l| (0..K).map(move |k| (l, k)));
        for &node in &self.nodes {
            for (line, k) in window() {
                if let Some(first) = (node as usize).checked_sub(line * stride + k) {
                    self.near[first] = true;
                }
            }
        }
        self.starts.clear();
        self.starts.resize(self.nodes.len() + 1, 0);
        if self.nodes.is_empty() {
            return;
        }
        // counted, then filled: each list keeps the order of the rows
        for fills in [false, true] {
            for row in runs.iter().cloned().flatten() {
                let first = stencils.first[row] as usize % count;
                if !self.near[first] {
                    continue;
                }
                let values = stencils.row::<K, D>(row).values;
                for (line, k) in window() {
                    let meeting = self.number[first + line * stride + k] as usize;
                    if meeting == 0 || values[line][k] <= 0.0 {
                        continue;
                    }
                    let start = &mut self.starts[meeting - usize::from(fills)];
                    if fills {
                        let at = (line * K + k) as u32;
                        self.touches[*start as usize] = Touch { row: row as u32, at };
                    }
                    *start += 1;
                }
            }
            if fills {
                // each start has become the next one's
                self.starts.rotate_right(1);
                self.starts[0] = 0;
            } else {
                let mut sum = 0;
                self.starts.iter_mut().for_each(|s| {
                    sum += *s;
                    *s = sum;
                });
                self.touches.resize(sum as usize, Touch::default());
            }
        }
    }

    /// Number of meetings.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The place of a meeting in a layer.
    pub fn node(&self, meeting: usize) -> usize {
        self.nodes[meeting] as usize
    }

    /// The rows that touch a meeting, in canonical order.
    pub fn touches(&self, meeting: usize) -> &[Touch] {
        &self.touches[self.starts[meeting] as usize..self.starts[meeting + 1] as usize]
    }

    /// The bodies at a meeting, those with more than `least` of `mass`, from the components of
    /// momentum and force.
    pub fn members(
        &self,
        meeting: usize,
        least: f64,
        layers: usize,
        mass: &[f64],
        [momentum, force]: [[&[f64]; D]; 2],
    ) -> SmallVec<[Member<D>; 3]> {
        let count = self.number.len();
        let at = |layer: usize| layer * count + self.node(meeting);
        let member = |layer: usize| {
            let i = at(layer);
            let [velocity, acceleration] =
                [momentum, force].map(|sums| std::array::from_fn(|a| sums[a][i] / mass[i]));
            Member { layer, mass: mass[i], velocity, acceleration, volume: 0.0, gradient: [0.0; D] }
        };
        (0..layers).filter(|&l| mass[at(l)] > least).map(member).collect()
    }
}
