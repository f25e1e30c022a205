//! Counting sort of particles by cell and id. The counts of the particles of the cells give the first
//! place of each cell. The ids of a cell are few or almost in order, and are inserted one by one.

/// Order of particles, with buffers that are kept from one sort to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct CountingSort {
    /// Ids in their order.
    pub ids: Vec<u64>,
    /// Number of each particle, in their order.
    pub order: Vec<u32>,
    /// Cell of each particle.
    cells: Vec<u32>,
    /// First place of each cell's particles, then their end.
    starts: Vec<u32>,
}

impl CountingSort {
    /// Sorts particles with the `ids`. `cells` are the numbers of their cells in canonical order, below
    /// `count`.
    pub fn sort(
        &mut self,
        count: usize,
        cells: impl Iterator<Item = u32>,
        particle_ids: impl Iterator<Item = u64>,
    ) {
        let CountingSort { ids, order, cells: cell_of, starts } = self;
        cell_of.clear();
        cell_of.extend(cells);
        starts.clear();
        starts.resize(count + 1, 0);
        cell_of.iter().for_each(|&cell| starts[cell as usize + 1] += 1);
        let mut before = 0;
        for start in starts.iter_mut() {
            before += *start;
            *start = before;
        }
        order.resize(cell_of.len(), 0);
        ids.resize(cell_of.len(), 0);
        for ((&cell, id), number) in cell_of.iter().zip(particle_ids).zip(0..) {
            let start = &mut starts[cell as usize];
            order[*start as usize] = number;
            ids[*start as usize] = id;
            *start += 1;
        }
        // each start is now the end of its cell
        let mut from = 0;
        for &end in &starts[..count] {
            let cell = from..end as usize;
            sort_by_id(&mut ids[cell.clone()], &mut order[cell]);
            from = end as usize;
        }
    }
}

/// Sorts the ids of a cell, and the `order` with them.
fn sort_by_id(ids: &mut [u64], order: &mut [u32]) {
    for k in 1..ids.len() {
        let mut at = k;
        while at > 0 && ids[at - 1] > ids[at] {
            ids.swap(at - 1, at);
            order.swap(at - 1, at);
            at -= 1;
        }
    }
}
