//! One patch: its rows, its nodes, and what a step keeps for them.

use std::ops::Range;

use decomp::{Block, IndexBox, Layout, NodeArrays};

use crate::effects::contact::ContactNodes;
use crate::solver::clock::Watch;
use crate::solver::nodal_fields::Band;
use crate::solver::shape::{Domain, Shape, Weights};
use crate::solver::shape_weights::Stencils;
use crate::solver::transfer::{NARROW, lines};

/// What a patch tells of its step.
#[derive(Clone, Debug, Default)]
pub struct Told<const D: usize> {
    /// Longest time step that its particles allow at a Courant number of 1 [s].
    pub time_step: f64,
    /// Greatest extent of a particle along a direction [cells].
    pub length: f64,
    /// The first fault.
    pub fault: Option<Fault<D>>,
}

/// A state that ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault<const D: usize> {
    /// When in the step it was found.
    pub phase: Phase,
    /// Cell of the particle.
    pub cell: [i64; D],
    /// Id of the particle.
    pub id: u64,
    /// Its position [m].
    pub position: [f64; D],
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

impl<const D: usize> Fault<D> {
    /// Which of a step's faults comes first, in a way that does not depend on the layout: by
    /// phase, then in canonical order.
    pub fn order(&self) -> [u64; 4] {
        let place =
            |a: usize| (self.cell.get(a).copied().unwrap_or(0) - i64::from(i32::MIN)) as u64;
        [self.phase as u64, place(1), place(0), self.id]
    }
}

/// A particle that has left by an outflow or was eroded, as seen in the grid's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departed<const D: usize> {
    /// Its id.
    pub id: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Velocity [m/s].
    pub velocity: [f64; D],
    /// Specific internal energy [J/kg].
    pub energy: f64,
    /// Whether it was eroded.
    pub eroded: bool,
}

/// A force of a side of the domain on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideForce<const D: usize> {
    /// Place of the node.
    pub at: usize,
    /// Share of it that is this patch's own: 0 for a node of another, 1/2 on a mirror, whose sums
    /// hold each particle twice.
    pub share: f64,
    /// The force [N].
    pub force: [f64; D],
    /// Whether it is friction, whose work becomes heat of the material.
    pub rubs: bool,
}

/// What sides have given in a step, as seen in the grid's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given<const D: usize> {
    /// Work, without that of friction [J].
    pub work: f64,
    /// Impulse [N s].
    pub impulse: [f64; D],
}

/// One patch.
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
    /// Matrix of heat capacities, for conduction.
    pub capacity_band: Band,
    /// Runs of rows in canonical order.
    pub runs: Vec<Range<usize>>,
    /// Nodes that hold material, of those that the patch computes: its own, and with deep ghosts
    /// those about it. A box a layer.
    pub active: Vec<IndexBox<D>>,
    /// Their places in its arrays.
    pub active_lines: Vec<Range<usize>>,
    /// Places of the nodes whose values its own rows or products on active nodes may take.
    pub span_lines: Vec<Range<usize>>,
    /// Places of the nodes with little material that it computes, which filters leave out.
    pub edge: Vec<usize>,
    /// Where its bodies' velocity fields touch, with contact.
    pub contact: ContactNodes<D>,
    /// How far beyond its own nodes it computes [nodes].
    pub deeper: i64,
    /// What it tells of its step.
    pub told: Told<D>,
    /// Forces of the sides on the nodes that it computes.
    pub side_forces: Vec<SideForce<D>>,
    /// What they have given its own nodes in this step.
    pub given: Vec<Given<D>>,
    /// Particles that have left in this step.
    pub departed: Vec<Departed<D>>,
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
            capacity_band: Band::default(),
            runs: Vec::new(),
            active: Vec::new(),
            active_lines: Vec::new(),
            span_lines: Vec::new(),
            edge: Vec::new(),
            contact: ContactNodes::default(),
            deeper: 0,
            told: Told::default(),
            side_forces: Vec::new(),
            given: Vec::new(),
            departed: Vec::new(),
            reach_length: f64::INFINITY,
            kept: Vec::new(),
            rest: Rest::default(),
            watch: Watch::default(),
        }
    }
}

impl<const D: usize> Patch<D> {
    /// Gives it arrays of `fields` nodal values in `layers` with halos of `depth` nodes, of which
    /// it computes those up to `deeper` beyond its own.
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
        self.deeper = deeper;
        self.stencils.forget();
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
    /// Computes the weights of all rows from the columns that start at `fraction` and at `domain`
    /// [cells]; `inverse_cell` is 1/edge of a cell [1/m], `layer` the column with each row's
    /// layer, if there are several.
    pub fn find_weights<S: Shape, const K: usize>(
        &mut self,
        fraction: usize,
        domain: usize,
        inverse_cell: [f64; D],
        layer: Option<usize>,
    ) {
        let rows = self.block.rows();
        let stencils = &mut self.stencils;
        let nodes = const { K * lines(K, D) };
        stencils.width = K;
        stencils.stride = self.nodes.nodes.extent(0);
        stencils.first.resize(rows, 0);
        stencils.values.resize(rows * nodes, 0.0);
        stencils.gradients.resize(rows * nodes * D, 0.0);
        stencils.narrow.resize(if K > NARROW { rows } else { 0 }, false);
        let lower = self.nodes.nodes.lower.map(|l| l as i32);
        let column = |k: usize| &self.block.columns[k][..rows];
        let cells = &self.block.cells[..rows];
        let (mut least, mut most) = ([i32::MAX; D], [i32::MIN; D]);
        let narrow = &mut stencils.narrow;
        let out = stencils
            .first
            .iter_mut()
            .zip(stencils.values.chunks_exact_mut(nodes))
            .zip(stencils.gradients.chunks_exact_mut(nodes * D));
        if D == 1 {
            let (fractions, lengths) = (column(fraction), column(domain));
            for (row, ((first, values), gradients)) in out.enumerate() {
                let w: Weights<K> = S::weights(fractions[row], lengths[row]);
                let at = cells[row][0] + w.first - lower[0];
                (least[0], most[0]) = (least[0].min(at), most[0].max(at));
                *first = at as u32;
                if K > NARROW {
                    narrow[row] = S::nodes(lengths[row]) <= NARROW;
                }
                values.copy_from_slice(&w.values);
                for (out, g) in gradients.iter_mut().zip(w.gradients) {
                    *out = g * inverse_cell[0];
                }
            }
        } else {
            let fractions = [0, 1].map(|a| column(fraction + a));
            let domains: [&[f64]; 4] = std::array::from_fn(|k| {
                if k < S::EXTENT.plane_columns() { column(domain + k) } else { &[] }
            });
            let stride = stencils.stride as i32;
            for (row, ((first, values), gradients)) in out.enumerate() {
                let place = fractions.map(|f| f[row]);
                let domain = Domain::from_columns(S::EXTENT, &domains, row);
                let (gx, gy) = gradients.split_at_mut(nodes);
                let mut lines = crate::solver::shape::Plane {
                    values: values.as_chunks_mut::<K>().0,
                    gradients: [gx.as_chunks_mut::<K>().0, gy.as_chunks_mut::<K>().0],
                };
                let [width, height] = domain.extent();
                let is_narrow = K > NARROW && S::nodes(width.max(height)) <= NARROW;
                let corner = match is_narrow {
                    true => lines.fill_first::<S, NARROW>(place, &domain),
                    false => S::plane(place, &domain, &mut lines),
                };
                let at: [i32; D] = std::array::from_fn(|a| cells[row][a] + corner[a] - lower[a]);
                for a in 0..D {
                    (least[a], most[a]) = (least[a].min(at[a]), most[a].max(at[a]));
                }
                *first = (at[0] + stride * at[D - 1]) as u32;
                if K > NARROW {
                    narrow[row] = is_narrow;
                }
                gx.iter_mut().for_each(|g| *g *= inverse_cell[0]);
                gy.iter_mut().for_each(|g| *g *= inverse_cell[D - 1]);
            }
        }
        self.find_runs(layer, K as i64, least, most);
    }

    /// Finds the runs of rows in canonical order, and the nodes that they reach.
    fn find_runs(&mut self, layer: Option<usize>, width: i64, least: [i32; D], most: [i32; D]) {
        self.block.runs(&mut self.runs);
        self.active.clear();
        self.active_lines.clear();
        self.span_lines.clear();
        match layer {
            None => self.find_active(0, width, least, most),
            Some(column) => self.separate(column, width),
        }
        self.find_span(width);
    }

    /// Moves each row's window to the layer in `column`.
    fn separate(&mut self, column: usize, width: i64) {
        let (count, stride) = (self.nodes.nodes.count(), self.stencils.stride);
        for layer in 0..self.nodes.layers {
            let (mut least, mut most) = ([i32::MAX; D], [i32::MIN; D]);
            let rows = self.stencils.first.iter_mut().zip(&self.block.columns[column]);
            for (first, _) in rows.filter(|(_, l)| **l as usize == layer) {
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

    /// The nodes of a layer to compute that any row touches; windows of `width` nodes start
    /// between `least` and `most`, counted from the arrays' first node.
    fn find_active(&mut self, layer: usize, width: i64, least: [i32; D], most: [i32; D]) {
        let all = self.nodes.nodes;
        let own = self.nodes.owned.grow(self.deeper).intersect(&all);
        let touched = IndexBox {
            lower: std::array::from_fn(|a| all.lower[a] + i64::from(least[a])),
            upper: std::array::from_fn(|a| all.lower[a] + i64::from(most[a]) + width),
        };
        let active = match least[0] > most[0] {
            true => IndexBox::new(own.lower, own.lower),
            false => {
                let active = own.intersect(&touched);
                let upper = std::array::from_fn(|a| active.upper[a].max(active.lower[a]));
                IndexBox::new(active.lower, upper)
            }
        };
        let from = layer * all.count();
        let place = |line: Range<usize>| line.start + from..line.end + from;
        self.active_lines.extend(active.lines_in(&all).map(place));
        self.active.push(active);
    }

    /// The nodes about those that are computed, alike in every layer: a limiter looks on in another
    /// body's flow, of which the patch itself may compute nothing.
    fn find_span(&mut self, width: i64) {
        let all = self.nodes.nodes;
        let filled = self.active.iter().filter(|active| active.count() > 0);
        let hull = filled.copied().reduce(|a, b| IndexBox {
            lower: std::array::from_fn(|k| a.lower[k].min(b.lower[k])),
            upper: std::array::from_fn(|k| a.upper[k].max(b.upper[k])),
        });
        let Some(hull) = hull else { return };
        let span = hull.grow(width).intersect(&all);
        for from in (0..self.nodes.layers).map(|layer| layer * all.count()) {
            let place = |line: Range<usize>| line.start + from..line.end + from;
            self.span_lines.extend(span.lines_in(&all).map(place));
        }
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
