//! Contact nodes: nodes with particles of several bodies, and those particles.

use std::ops::Range;

use decomp::IndexBox;
use smallvec::SmallVec;

use crate::solver::particle_weights::lines;
use crate::solver::shape_weights::Stencils;

/// Particle that touches a contact node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Touch {
    /// Index of the particle.
    pub particle: u32,
    /// Index of the node in the particle's window, line by line.
    pub at: u32,
}

/// Body at a contact node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member<const D: usize> {
    /// Layer of the body.
    pub layer: usize,
    /// Lumped mass [kg].
    pub mass: f64,
    /// Lumped velocity [m/s].
    pub velocity: [f64; D],
    /// Lumped acceleration without contact [m/s2].
    pub acceleration: [f64; D],
    /// Filled volume at the node, sum V N [cells].
    pub volume: f64,
    /// Gradient of the filled volume, sum V G [cells/m]; it points out of the body.
    pub gradient: [f64; D],
}

/// Contact nodes of a patch, each with the particles that touch it in canonical order.
#[derive(Clone, Debug, Default)]
pub struct ContactNodes<const D: usize> {
    /// Indices of the nodes in a layer.
    nodes: Vec<u32>,
    /// 1 + index of the contact node at each node of a layer; 0: none.
    number: Vec<u32>,
    /// Whether a window that starts at each node contains a contact node.
    near: Vec<bool>,
    starts: Vec<u32>,
    touches: Vec<Touch>,
    /// Numbers of contact nodes with the particles that touch them, by particle.
    found: Vec<(u32, Touch)>,
}

impl<const D: usize> ContactNodes<D> {
    /// Finds the nodes in `nodes` at which more than one layer has a `mass` of more than `least`
    /// [kg], among the nodes that each layer computes, and the particles that touch them (with
    /// windows `K` wide), in the order of `runs`.
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
        self.found.clear();
        for particle in runs.iter().cloned().flatten() {
            let first = stencils.first[particle] as usize % count;
            if !self.near[first] {
                continue;
            }
            let values = stencils.particle::<K, D>(particle).values;
            for (line, values) in values.iter().enumerate() {
                let numbers = &self.number[first + line * stride..][..K];
                for (k, (&number, &value)) in numbers.iter().zip(values).enumerate() {
                    if number > 0 && value > 0.0 {
                        let at = (line * K + k) as u32;
                        self.found.push((number, Touch { particle: particle as u32, at }));
                        self.starts[number as usize] += 1;
                    }
                }
            }
        }
        let mut sum = 0;
        self.starts.iter_mut().for_each(|s| {
            sum += *s;
            *s = sum;
        });
        // each list keeps the order of the particles
        self.touches.resize(sum as usize, Touch::default());
        for (number, touch) in &self.found {
            let start = &mut self.starts[*number as usize - 1];
            self.touches[*start as usize] = *touch;
            *start += 1;
        }
        // filling has moved each start to the next one
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Index of the node of a contact node in a layer.
    pub fn node(&self, contact_node: usize) -> usize {
        self.nodes[contact_node] as usize
    }

    /// Particles that touch a contact node, in canonical order.
    pub fn touches(&self, contact_node: usize) -> &[Touch] {
        &self.touches[self.starts[contact_node] as usize..self.starts[contact_node + 1] as usize]
    }

    /// Bodies at a contact node with a `mass` of more than `least` [kg]. The last argument has the
    /// components of the nodal momentum [kg m/s] and force [N].
    pub fn members(
        &self,
        contact_node: usize,
        least: f64,
        layers: usize,
        mass: &[f64],
        [momentum, force]: [[&[f64]; D]; 2],
    ) -> SmallVec<[Member<D>; 3]> {
        let count = self.number.len();
        let at = |layer: usize| layer * count + self.node(contact_node);
        let member = |layer: usize| {
            let i = at(layer);
            let [velocity, acceleration] =
                [momentum, force].map(|sums| decomp::array::from_fn(|a| sums[a][i] / mass[i]));
            Member { layer, mass: mass[i], velocity, acceleration, volume: 0.0, gradient: [0.0; D] }
        };
        (0..layers).filter(|&l| mass[at(l)] > least).map(member).collect()
    }
}
