//! A patch: its particles, its nodes, and the buffers of a step.

use std::ops::Range;

use decomp::{Block, IndexBox, Layout, NodeArrays};
use wide::f64x4;

use crate::shape::{DomainExtent, Shape};
use crate::solver::clock::Stopwatch;
use crate::solver::contact::PatchContact;
use crate::solver::find_weights::{Corners, Places};
use crate::solver::nodal_matrix::{NodalMatrix, ProductContext};
use crate::solver::packed::is_one_vector;
use crate::solver::shape_weights::Stencils;

/// Results of a patch in one step.
#[derive(Clone, Debug, Default)]
pub struct StepReport<const D: usize> {
    /// Longest time step that its particles allow at a Courant number of 1 [s].
    pub time_step: f64,
    /// Greatest extent of a particle along a direction [cells].
    pub length: f64,
    /// First fault.
    pub fault: Option<Fault<D>>,
}

/// Invalid particle state that ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault<const D: usize> {
    /// Part of the step in which it was found.
    pub phase: FaultPhase,
    /// Cell of the particle.
    pub cell: [i64; D],
    /// Id of the particle.
    pub id: u64,
    /// Its position [m].
    pub position: [f64; D],
    /// Its body.
    pub body: usize,
    /// Description of the fault.
    pub what: String,
}

/// Part of a step in which a fault is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultPhase {
    /// When particles are moved to the middle of the step.
    Start,
    /// When their cells are determined.
    Locate,
    /// When the state at the end of the step is checked.
    End,
}

impl<const D: usize> Fault<D> {
    /// Sort key that does not depend on the layout: the first fault of a step is the least by
    /// phase, then in canonical order.
    pub fn order(&self) -> [u64; 4] {
        let place =
            |a: usize| (self.cell.get(a).copied().unwrap_or(0) - i64::from(i32::MIN)) as u64;
        [self.phase as u64, place(1), place(0), self.id]
    }
}

/// Particle removed at an outflow side or by erosion, in the frame of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemovedParticle<const D: usize> {
    /// Its id.
    pub id: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Velocity [m/s].
    pub velocity: [f64; D],
    /// Specific internal energy, with that of its spin [J/kg].
    pub energy: f64,
    /// Whether it was eroded.
    pub eroded: bool,
}

/// Force of a side of the domain on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideForce<const D: usize> {
    /// Index of the node in the arrays.
    pub at: usize,
    /// Share of the force that this patch accounts for [-]: 0 for a node of another patch, 1/2 on a
    /// mirror, whose sums count each particle twice.
    pub share: f64,
    /// Force [N].
    pub force: [f64; D],
    /// Whether it is friction, whose work becomes heat of the material.
    pub has_friction: bool,
}

/// Work and impulse of sides in a step, in the frame of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryWork<const D: usize> {
    /// Work without that of friction [J].
    pub work: f64,
    /// Impulse [N s].
    pub impulse: [f64; D],
}

/// A patch.
#[derive(Clone, Debug)]
pub struct Patch<const D: usize> {
    /// Its particles.
    pub block: Block<D>,
    /// Its nodes.
    pub nodes: NodeArrays<D>,
    /// Weights of its particles.
    pub stencils: Stencils,
    /// Four numbers of each node side by side, for sums over the corners of particles: momentum
    /// [kg m/s] and force [N], then the velocities at the start and the end of the step [m/s].
    pub corner_nodes: Vec<f64x4>,
    /// Mass matrix.
    pub mass_matrix: NodalMatrix,
    /// Matrix of compliances, for pressure relaxation.
    pub compliance_matrix: NodalMatrix,
    /// Matrices of effects.
    pub matrices: Vec<NodalMatrix>,
    /// Ranges of particles in canonical order.
    pub runs: Vec<Range<usize>>,
    /// Computed nodes that hold material, one box per layer; with deep ghosts a patch also computes
    /// nodes around its own.
    pub active: Vec<IndexBox<D>>,
    /// Ranges of these nodes in the arrays.
    pub active_lines: Vec<Range<usize>>,
    /// Ranges of the nodes that own particles or products on active nodes may read.
    pub span_lines: Vec<Range<usize>>,
    /// Computed nodes with little material, which filters leave out.
    pub edge: Vec<usize>,
    /// Other computed nodes that share particles with such nodes, and the fraction of their mass
    /// that belongs to these pairs [-].
    pub beside_edge: Vec<(usize, f64)>,
    /// Nodes where velocity fields of bodies meet, with contact.
    pub contact: PatchContact<D>,
    /// Layers of nodes that the patch computes beyond its own.
    pub extra_ghost_layers: i64,
    /// Results of the step.
    pub report: StepReport<D>,
    /// Forces of the sides on the computed nodes.
    pub side_forces: Vec<SideForce<D>>,
    /// Work and impulse of the sides on the own nodes in this step.
    pub boundary_work: Vec<BoundaryWork<D>>,
    /// Particles removed in this step.
    pub removed: Vec<RemovedParticle<D>>,
    /// Longest particle for which ghost layers and halos are deep enough [cells].
    pub reach_length: f64,
    /// Reusable buffer with one value per particle: the volume ratios before the step [-] while the
    /// stress update runs.
    pub kept: Vec<f64>,
    /// Whether the patch is quiescent.
    pub quiescence: Quiescence,
    /// Timer of the patch.
    pub stopwatch: Stopwatch,
}

/// Quiescence: the patch is at rest and no wave has reached it, or it has no particles, so that a
/// step would not change a single bit of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiescence {
    /// Consecutive steps computed with nothing moving nearby.
    settled: u32,
    /// Whether this step skips the patch.
    asleep: bool,
}

impl Quiescence {
    /// Whether this step skips the patch.
    pub fn is_quiescent(&self) -> bool {
        self.asleep
    }

    /// Records whether anything nearby may change the patch in this step. After `needed` steps
    /// without such a change, another step would reproduce all results, nodal values included.
    /// Returns whether the patch has just become quiescent.
    fn note(&mut self, stirred: bool, needed: u32) -> bool {
        if stirred {
            *self = Quiescence::default();
            return false;
        }
        let falls_asleep = !self.asleep && self.settled >= needed;
        self.asleep |= falls_asleep;
        self.settled += 1;
        falls_asleep
    }
}

impl<const D: usize> Patch<D> {
    /// Patch `index` of `layout`, with the particles of `block` and no nodal fields yet.
    pub fn new(layout: &Layout<D>, index: usize, block: Block<D>) -> Self {
        Patch {
            block,
            nodes: NodeArrays::new(layout, index, 0, 0),
            stencils: Stencils::default(),
            corner_nodes: Vec::new(),
            mass_matrix: NodalMatrix::default(),
            compliance_matrix: NodalMatrix::default(),
            matrices: Vec::new(),
            runs: Vec::new(),
            active: Vec::new(),
            active_lines: Vec::new(),
            span_lines: Vec::new(),
            edge: Vec::new(),
            beside_edge: Vec::new(),
            contact: PatchContact::default(),
            extra_ghost_layers: 0,
            report: StepReport::default(),
            side_forces: Vec::new(),
            boundary_work: Vec::new(),
            removed: Vec::new(),
            reach_length: f64::INFINITY,
            kept: Vec::new(),
            quiescence: Quiescence::default(),
            stopwatch: Stopwatch::default(),
        }
    }
}

impl<const D: usize> Patch<D> {
    /// Allocates arrays of `fields` nodal values in `layers` with halos of `depth` nodes; the patch
    /// computes nodes up to `deeper` beyond its own.
    pub fn set_arrays(
        &mut self,
        layout: &Layout<D>,
        index: usize,
        depth: i64,
        deeper: i64,
        fields: usize,
        layers: usize,
    ) {
        self.nodes = NodeArrays::layered(layout, index, depth, fields, layers);
        self.extra_ghost_layers = deeper;
        self.stencils.forget();
        // the nodal values of a quiescent patch are lost
        self.quiescence = Quiescence::default();
    }

    /// Makes the patch quiescent or active, once nearby motion is known. A patch that becomes
    /// quiescent keeps the nodal fields `kept` (the masses) and sets the others to zero, as if it
    /// had computed them.
    pub fn settle(&mut self, needed: u32, kept: &[usize]) {
        // nearby motion cannot change a patch that no particle reaches
        let stirred = self.block.stirred && self.block.particles() > 0;
        if self.quiescence.note(stirred, needed) {
            self.contact.clear();
            self.side_forces.clear();
            for (k, field) in self.nodes.fields.iter_mut().enumerate() {
                if !kept.contains(&k) {
                    field.fill(0.0);
                }
            }
        }
    }
}

impl<const D: usize> Patch<D> {
    /// Particles and computed nodes, for products with matrices.
    pub fn product_context(&self) -> ProductContext<'_> {
        ProductContext { stencils: &self.stencils, runs: &self.runs, lines: &self.active_lines }
    }

    /// Calls `f` with the weights, which are taken out of the patch meanwhile.
    #[inline(always)]
    pub(super) fn with_stencils(&mut self, f: impl FnOnce(&mut Self, &Stencils)) {
        let stencils = std::mem::take(&mut self.stencils);
        f(self, &stencils);
        self.stencils = stencils;
    }

    /// Computes the weights of all particles from the columns that start at `fraction` and `domain`
    /// [cells]; `inverse_cell` is 1/edge of a cell [1/m], `layer` the column of each particle's
    /// layer, if there are several.
    pub fn find_weights<S: Shape, const K: usize>(
        &mut self,
        fraction: usize,
        domain: usize,
        inverse_cell: [f64; D],
        layer: Option<usize>,
    ) {
        let at =
            Self::places(&self.block, &self.nodes, S::EXTENT, [fraction, domain], inverse_cell);
        let corners = self.stencils.fill::<S, K, D>(&at, self.nodes.nodes.extent(0));
        self.block.runs(&mut self.runs);
        self.find_nodes(layer, [K as i64; 2], corners);
        if const { D > 1 && !is_one_vector(K) } {
            self.stencils.find_groups::<K>(&self.runs);
        }
    }

    /// Places of the particles of `block`, including ghosts, from the columns that start at
    /// `fraction` and `domain` [cells]; `inverse_cell` is 1/edge of a cell [1/m].
    pub(super) fn places<'a>(
        block: &'a Block<D>,
        nodes: &NodeArrays<D>,
        extent: DomainExtent,
        [fraction, domain]: [usize; 2],
        inverse_cell: [f64; D],
    ) -> Places<'a, D> {
        let particles = block.particles();
        let column = |k: usize| &block.columns[k][..particles];
        let domains = if D == 1 { 1 } else { extent.plane_columns() };
        Places {
            cells: &block.cells[..particles],
            fractions: decomp::array::from_fn(|a| column(fraction + a)),
            domains: decomp::array::from_fn(|k| if k < domains { column(domain + k) } else { &[] }),
            lower: nodes.nodes.lower.map(|l| l as i32),
            inverse_cell,
        }
    }

    /// Finds the nodes within reach of the particles: windows of `width` nodes have their first nodes
    /// within `corners`, and the longest particle reaches `longest` nodes along a direction.
    pub(super) fn find_nodes(
        &mut self,
        layer: Option<usize>,
        [width, longest]: [i64; 2],
        corners: Corners<D>,
    ) {
        let Corners { least, most } = corners;
        self.active.clear();
        self.active_lines.clear();
        self.span_lines.clear();
        match layer {
            None => self.find_active(0, width, least, most),
            Some(column) => self.separate(column, width),
        }
        self.find_span(longest);
    }

    /// Shifts the window of each particle to the layer in `column`.
    fn separate(&mut self, column: usize, width: i64) {
        let (count, stride) = (self.nodes.nodes.count(), self.stencils.stride);
        for layer in 0..self.nodes.layers {
            let (mut least, mut most) = ([i32::MAX; D], [i32::MIN; D]);
            let particles = self.stencils.first.iter_mut().zip(&self.block.columns[column]);
            for (first, _) in particles.filter(|(_, l)| **l as usize == layer) {
                let at = *first as usize;
                for a in 0..D {
                    let at = if D == 1 { at } else { [at % stride, at / stride][a] } as i32;
                    (least[a], most[a]) = (least[a].min(at), most[a].max(at));
                }
                *first += (layer * count) as u32;
            }
            self.find_active(layer, width, least, most);
        }
    }

    /// Finds the nodes of a layer that the patch computes and that any particle touches. Windows of
    /// `width` nodes start between `least` and `most`, relative to the first node of the arrays.
    fn find_active(&mut self, layer: usize, width: i64, least: [i32; D], most: [i32; D]) {
        let all = self.nodes.nodes;
        let own = self.nodes.owned.grow(self.extra_ghost_layers).intersect(&all);
        let touched = IndexBox {
            lower: decomp::array::from_fn(|a| all.lower[a] + i64::from(least[a])),
            upper: decomp::array::from_fn(|a| all.lower[a] + i64::from(most[a]) + width),
        };
        let active = match least[0] > most[0] {
            true => IndexBox::new(own.lower, own.lower),
            false => {
                let active = own.intersect(&touched);
                let upper = decomp::array::from_fn(|a| active.upper[a].max(active.lower[a]));
                IndexBox::new(active.lower, upper)
            }
        };
        let from = layer * all.count();
        let place = |line: Range<usize>| line.start + from..line.end + from;
        self.active_lines.extend(active.lines_in(&all).map(place));
        self.active.push(active);
    }

    /// Finds the nodes around the computed ones, the same in every layer: a limiter also reads the
    /// flow of another body, of which the patch itself may compute no nodes.
    fn find_span(&mut self, width: i64) {
        let all = self.nodes.nodes;
        let filled = self.active.iter().filter(|active| active.count() > 0);
        let hull = filled.copied().reduce(|a, b| IndexBox {
            lower: decomp::array::from_fn(|k| a.lower[k].min(b.lower[k])),
            upper: decomp::array::from_fn(|k| a.upper[k].max(b.upper[k])),
        });
        let Some(hull) = hull else { return };
        let span = hull.grow(width).intersect(&all);
        for from in (0..self.nodes.layers).map(|layer| layer * all.count()) {
            let place = |line: Range<usize>| line.start + from..line.end + from;
            self.span_lines.extend(span.lines_in(&all).map(place));
        }
    }
}

impl<const D: usize> AsMut<Stopwatch> for Patch<D> {
    fn as_mut(&mut self) -> &mut Stopwatch {
        &mut self.stopwatch
    }
}

impl<const D: usize> AsMut<Block<D>> for Patch<D> {
    fn as_mut(&mut self) -> &mut Block<D> {
        &mut self.block
    }
}

impl<const D: usize> AsMut<NodeArrays<D>> for Patch<D> {
    fn as_mut(&mut self) -> &mut NodeArrays<D> {
        &mut self.nodes
    }
}
