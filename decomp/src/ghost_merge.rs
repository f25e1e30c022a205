//! Arrival of packed particles at their patches, and the canonical order of ghosts.

use crate::counting_sort::CountingSort;
use crate::packing::{Group, Kind};
use crate::particle_sort::SortBuffers;
use crate::{Block, IndexBox, array};

/// Buffers for the arrival of particles at one patch, kept from one patch and step to the next.
#[derive(Clone, Debug)]
pub(crate) struct ArrivalBuffers<const D: usize> {
    sorting: SortBuffers<D>,
    merging: MergeBuffers,
}

impl<const D: usize> Default for ArrivalBuffers<D> {
    fn default() -> Self {
        ArrivalBuffers { sorting: SortBuffers::default(), merging: MergeBuffers::default() }
    }
}

/// Buffers of the order of ghosts.
#[derive(Clone, Debug, Default)]
struct MergeBuffers {
    sorting: CountingSort,
    /// Place in the order of each ghost as it arrives.
    slots: Vec<u32>,
}

/// Adds the particles of `groups` to `block`, which has no ghosts and whose own particles have the
/// cells `ring.home`; own particles and ghosts are in canonical order afterwards.
pub(crate) fn receive<'a, const D: usize>(
    block: &mut Block<D>,
    ring: &Ring<D>,
    groups: impl Iterator<Item = Group<'a, D>> + Clone,
    buffers: &mut ArrivalBuffers<D>,
) {
    block.stirred |= groups.clone().any(|group| group.kind == Kind::Stir);
    // a block keeps its ghosts after its own particles
    for group in groups.clone().filter(|group| group.kind == Kind::Own) {
        block.extend_own(group.ids, group.cells(), group.columns);
    }
    block.sort(0, &mut buffers.sorting);
    let ghosts = groups.filter(|group| group.kind == Kind::Ghost);
    block.merge_ghosts(ring, ghosts, &mut buffers.merging);
}

/// The cells around a patch whose particles it sees.
#[derive(Clone, Debug)]
pub(crate) struct Ring<const D: usize> {
    /// The cells of the patch.
    pub home: IndexBox<D>,
    /// The cells of the patch and those around it.
    pub halo: IndexBox<D>,
}

impl<const D: usize> Ring<D> {
    /// Number of cells of the ring.
    fn cells(&self) -> usize {
        self.halo.count() - self.home.count()
    }

    /// Number of the cells of the ring before `cell` in canonical order.
    fn place(&self, cell: [i32; D]) -> u32 {
        let cell = array::map(&cell, i64::from);
        (self.halo.flat(cell) - self.home.count_before(cell)) as u32
    }
}

impl<const D: usize> Block<D> {
    /// Adds the ghosts of `groups`, in canonical order.
    fn merge_ghosts<'a>(
        &mut self,
        ring: &Ring<D>,
        groups: impl Iterator<Item = Group<'a, D>> + Clone,
        buffers: &mut MergeBuffers,
    ) {
        if groups.clone().all(|group| group.ids.is_empty()) {
            return;
        }
        let MergeBuffers { sorting, slots } = buffers;
        let cells = groups.clone().flat_map(|group| group.cells()).map(|cell| ring.place(cell));
        let arriving = groups.clone().flat_map(|group| group.ids).copied();
        sorting.sort(ring.cells(), cells, arriving);
        slots.resize(sorting.order.len(), 0);
        for (&number, slot) in sorting.order.iter().zip(0..) {
            slots[number as usize] = slot;
        }
        self.place_ghosts(&sorting.ids, groups, slots);
    }

    /// Appends ghosts with the ordered `ids`, each at its slot.
    fn place_ghosts<'a>(
        &mut self,
        ids: &[u64],
        groups: impl Iterator<Item = Group<'a, D>> + Clone,
        slots: &[u32],
    ) {
        let (own, all) = (self.own(), self.own() + ids.len());
        self.ids.extend_from_slice(ids);
        self.cells.resize(all, [0; D]);
        let cells = groups.clone().flat_map(|group| group.cells());
        let places = &mut self.cells[own..];
        slots.iter().zip(cells).for_each(|(&slot, cell)| places[slot as usize] = cell);
        let Block { columns, ghost_columns, .. } = self;
        for (k, &c) in ghost_columns.iter().enumerate() {
            columns[c].resize(all, 0.0);
            let places = &mut columns[c][own..];
            let mut slots = slots;
            for group in groups.clone() {
                let (these, rest) = slots.split_at(group.ids.len());
                for (&slot, &word) in these.iter().zip(group.column(k)) {
                    places[slot as usize] = f64::from_bits(word);
                }
                slots = rest;
            }
        }
    }
}
