//! One patch: its rows, its nodes, and what a step keeps for them.

use std::ops::Range;

use decomp::{Block, Layout, NodeArrays};

use crate::clock::Watch;
use crate::grid::Band;
use crate::shape::{Shape, Weights};

/// The weights of every row of a patch, ghosts too, `width` nodes each.
#[derive(Clone, Debug, Default)]
pub struct Stencils {
    /// Nodes a row.
    pub width: usize,
    /// First node of each row, in the patch's arrays.
    pub first: Vec<u32>,
    /// Values, `width` a row.
    pub values: Vec<f64>,
    /// Gradients [1/m], `width` a row.
    pub gradients: Vec<f64>,
}

impl Stencils {
    /// The weights of `row`.
    #[inline(always)]
    pub fn row<const K: usize>(&self, row: usize) -> (usize, &[f64; K], &[f64; K]) {
        let at = row * K..(row + 1) * K;
        (
            self.first[row] as usize,
            self.values[at.clone()].try_into().expect("K values a row"),
            self.gradients[at].try_into().expect("K gradients a row"),
        )
    }
}

/// What a patch tells of its step.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Longest time step that its particles allow at a Courant number of 1 [s].
    pub time_step: f64,
    /// Greatest length of a particle [cells].
    pub length: f64,
    /// The first fault.
    pub fault: Option<Fault>,
}

/// A state that ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// When in the step it was found.
    pub phase: Phase,
    /// Cell of the particle.
    pub cell: i64,
    /// Id of the particle.
    pub id: u64,
    /// Its position [m].
    pub position: f64,
    /// Its body.
    pub body: usize,
    /// What is wrong with it.
    pub what: String,
}

/// When in a step a fault is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// As the rows are brought to the middle of the step.
    Start,
    /// As their cells are found.
    Locate,
    /// As the step's end is looked at.
    End,
}

impl Fault {
    /// Which of a step's faults comes first, in a way that does not depend on the layout: by
    /// phase, then in canonical order.
    pub fn order(&self) -> [u64; 3] {
        [self.phase as u64, (self.cell - i64::from(i32::MIN)) as u64, self.id]
    }
}

/// A particle that has left by an outflow, as seen in the grid's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departed {
    /// Its id.
    pub id: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Velocity [m/s].
    pub velocity: f64,
    /// Specific internal energy [J/kg].
    pub energy: f64,
}

/// One patch. Its layout is that of `D` directions; the physics is one-dimensional so far.
#[derive(Clone, Debug)]
pub struct Patch<const D: usize> {
    /// Its rows.
    pub block: Block<D>,
    /// Its nodes.
    pub nodes: NodeArrays<D>,
    /// Weights of its rows.
    pub stencils: Stencils,
    /// Mass matrix.
    pub band: Band,
    /// Matrix of compliances, for pressure relaxation.
    pub compliance_band: Band,
    /// Runs of rows in canonical order.
    pub runs: Vec<Range<usize>>,
    /// Nodes that hold material, of those that the patch computes: its own, and with deep ghosts
    /// those about it.
    pub active: Range<usize>,
    /// Nodes whose values its own rows or products on `active` may take.
    pub span: Range<usize>,
    /// Whether it sees a node with little material, which filters leave out.
    pub has_edge: bool,
    /// How far beyond its own nodes it computes [nodes].
    pub deeper: i64,
    /// What it tells of its step.
    pub told: Told,
    /// Particles that have left in this step.
    pub departed: Vec<Departed>,
    /// Longest particle that ghosts and halos are deep enough for [cells].
    pub reach_length: f64,
    /// A buffer of a value a row, kept from step to step.
    pub kept: Vec<f64>,
    /// Whether it sleeps.
    pub rest: Rest,
    /// Its clock.
    pub watch: Watch,
}

/// The sleep of a patch at rest that no wave has reached, or of one without rows: a step would
/// change none of its bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rest {
    /// Steps computed in a row with nothing near that moves.
    settled: u32,
    /// Whether this step leaves it out.
    asleep: bool,
}

impl Rest {
    /// Whether this step leaves the patch out.
    pub fn asleep(&self) -> bool {
        self.asleep
    }

    /// Takes note of whether anything near may change the patch in this step. After `needed`
    /// steps without, all that a step computes for it, nodal values included, has become what
    /// the next one would compute again. Tells whether the patch has just fallen asleep.
    fn note(&mut self, stirred: bool, needed: u32) -> bool {
        if stirred {
            *self = Rest::default();
            return false;
        }
        let falls_asleep = !self.asleep && self.settled >= needed;
        self.asleep |= falls_asleep;
        self.settled += 1;
        falls_asleep
    }
}

impl<const D: usize> Patch<D> {
    /// The patch `index` of `layout`, with `block`'s rows and no nodal fields yet.
    pub fn new(layout: &Layout<D>, index: usize, block: Block<D>) -> Self {
        Patch {
            block,
            nodes: NodeArrays::new(layout, index, 0, 0),
            stencils: Stencils::default(),
            band: Band::default(),
            compliance_band: Band::default(),
            runs: Vec::new(),
            active: 0..0,
            span: 0..0,
            has_edge: false,
            deeper: 0,
            told: Told::default(),
            departed: Vec::new(),
            reach_length: f64::INFINITY,
            kept: Vec::new(),
            rest: Rest::default(),
            watch: Watch::default(),
        }
    }
}

impl<const D: usize> Patch<D> {
    /// Gives it arrays of `fields` nodal values with halos of `depth` nodes, of which it computes
    /// those up to `deeper` beyond its own.
    pub fn set_arrays(
        &mut self,
        layout: &Layout<D>,
        index: usize,
        depth: i64,
        deeper: i64,
        fields: usize,
    ) {
        self.nodes = NodeArrays::new(layout, index, depth, fields);
        self.deeper = deeper;
        // what it held for its sleep is gone
        self.rest = Rest::default();
    }

    /// Lets it sleep or wakes it, once it is known what moves near it. A patch that falls asleep
    /// keeps the nodal fields of `kept`, the masses, and holds zeros in the others, as if it had
    /// computed them.
    pub fn settle(&mut self, needed: u32, kept: &[usize]) {
        // what moves nearby cannot change a patch that none of its rows reach
        let stirred = self.block.stirred && self.block.rows() > 0;
        if self.rest.note(stirred, needed) {
            for (k, field) in self.nodes.fields.iter_mut().enumerate() {
                if !kept.contains(&k) {
                    field.fill(0.0);
                }
            }
        }
    }
}

impl Patch<1> {
    /// Computes the weights of all rows from the columns `fraction` and `length` [cells].
    pub fn find_weights<S: Shape, const K: usize>(
        &mut self,
        fraction: usize,
        length: usize,
        inverse_cell: f64,
    ) {
        let rows = self.block.rows();
        let stencils = &mut self.stencils;
        stencils.width = K;
        stencils.first.resize(rows, 0);
        stencils.values.resize(rows * K, 0.0);
        stencils.gradients.resize(rows * K, 0.0);
        let lower = self.nodes.nodes.lower[0] as i32;
        let (fractions, lengths) =
            (&self.block.columns[fraction][..rows], &self.block.columns[length][..rows]);
        let cells = &self.block.cells[..rows];
        let out = stencils
            .first
            .iter_mut()
            .zip(stencils.values.chunks_exact_mut(K))
            .zip(stencils.gradients.chunks_exact_mut(K));
        for (row, ((first, values), gradients)) in out.enumerate() {
            let w: Weights<K> = S::weights(fractions[row], lengths[row]);
            *first = (cells[row][0] + w.first - lower) as u32;
            values.copy_from_slice(&w.values);
            for (out, g) in gradients.iter_mut().zip(w.gradients) {
                *out = g * inverse_cell;
            }
        }
        self.block.runs(&mut self.runs);
        self.find_active(K);
    }

    /// The nodes to compute that any row touches, as a range of the patch's arrays.
    fn find_active(&mut self, width: usize) {
        let lower = self.nodes.nodes.lower[0];
        let own = self.nodes.owned.grow(self.deeper).intersect(&self.nodes.nodes);
        let owned = (own.lower[0] - lower) as usize..(own.upper[0] - lower) as usize;
        let first = self.stencils.first.iter().min().map_or(owned.end, |&f| f as usize);
        let last = self.stencils.first.iter().max().map_or(0, |&f| f as usize + width);
        let start = owned.start.max(first);
        self.active = start..owned.end.min(last).max(start);
        let (least, most) = (self.active.start.saturating_sub(width), self.active.end + width);
        self.span = least..most.min(self.nodes.nodes.count());
    }
}

impl<const D: usize> AsMut<Watch> for Patch<D> {
    fn as_mut(&mut self) -> &mut Watch {
        &mut self.watch
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
