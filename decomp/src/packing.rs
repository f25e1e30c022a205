//! Groups of particles in messages, column after column: packed and read at the cost of a copy.

use crate::particle_block::MirrorChange;
use crate::{Block, Image, array};

/// Kind of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Copies of particles.
    Ghost,
    /// Migrating particles.
    Own,
    /// Notice that a patch is stirred.
    Stir,
}

/// Bits of the first word of a group: the kind, then the number of patches after the first one, then
/// the first patch.
const KIND_BITS: u32 = 2;
const OTHERS_BITS: u32 = 6;

fn head(first: usize, others: usize, kind: Kind) -> u64 {
    debug_assert!(others < 1 << OTHERS_BITS, "too many patches of a group");
    (((first as u64) << OTHERS_BITS) | others as u64) << KIND_BITS | kind as u64
}

/// Adds the notice to patch `to` that it is stirred.
pub(crate) fn put_stir(out: &mut Vec<u64>, to: usize) {
    out.push(head(to, 0, Kind::Stir));
}

/// Packs the particles with indices `particles` of `block`, as they appear in `image`, for all
/// patches `to`, 64 at most: as own particles with all columns, or as ghosts. Layout: first patch and
/// kind, number of particles, other patches, ids, cells, columns.
pub(crate) fn put_particles<const D: usize>(
    out: &mut Vec<u64>,
    block: &Block<D>,
    particles: &[u32],
    mut to: impl Iterator<Item = usize>,
    own: bool,
    image: &Image<D>,
) {
    let (false, Some(first)) = (particles.is_empty(), to.next()) else { return };
    let columns = if own { block.columns.len() } else { block.ghost_columns().len() };
    let start = out.len();
    out.reserve(2 + to.size_hint().0 + particles.len() * (1 + D + columns));
    out.extend([0, particles.len() as u64]);
    out.extend(to.map(|patch| patch as u64));
    let others = out.len() - start - 2;
    out[start] = head(first, others, if own { Kind::Own } else { Kind::Ghost });
    out.extend(particles.iter().map(|&r| block.ids[r as usize]));
    for &particle in particles {
        out.extend(image.cell(block.cells[particle as usize].map(i64::from)).map(|c| c as u64));
    }
    let mut put = |c: usize| {
        let values = particles.iter().map(|&r| block.columns[c][r as usize]);
        match block.specs()[c].mirror.in_image(&image.flip) {
            MirrorChange::None => out.extend(values.map(f64::to_bits)),
            MirrorChange::Negate => out.extend(values.map(|value| (-value).to_bits())),
            MirrorChange::Complement => out.extend(values.map(|value| (1.0 - value).to_bits())),
        }
    };
    if own {
        (0..block.columns.len()).for_each(put);
    } else {
        block.ghost_columns().iter().for_each(|&c| put(c));
    }
}

/// Numbers of columns of packed particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PackedColumns {
    /// Of a migrating particle.
    pub own: usize,
    /// Of a ghost.
    pub ghost: usize,
}

impl PackedColumns {
    /// Of the particles of `block`.
    pub fn of<const D: usize>(block: &Block<D>) -> Self {
        PackedColumns { own: block.columns.len(), ghost: block.ghost_columns().len() }
    }
}

/// A group of particles in a message.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a, const D: usize> {
    pub kind: Kind,
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Section of words for each column.
    pub columns: &'a [u64],
    cells: &'a [u64],
    first: usize,
    others: &'a [u64],
}

impl<'a, const D: usize> Group<'a, D> {
    /// The group at the start of `words`, and the words after it; `None` if there are no words.
    pub fn split_first(words: &'a [u64], columns: PackedColumns) -> Option<(Self, &'a [u64])> {
        let (&head, rest) = words.split_first()?;
        let others = (head >> KIND_BITS & ((1 << OTHERS_BITS) - 1)) as usize;
        let first = (head >> (KIND_BITS + OTHERS_BITS)) as usize;
        let (kind, columns) = match head & ((1 << KIND_BITS) - 1) {
            kind if kind == Kind::Own as u64 => (Kind::Own, columns.own),
            kind if kind == Kind::Ghost as u64 => (Kind::Ghost, columns.ghost),
            _ => {
                let none = Group {
                    kind: Kind::Stir,
                    ids: &[],
                    columns: &[],
                    cells: &[],
                    first,
                    others: &[],
                };
                return Some((none, rest));
            }
        };
        let particles = rest[0] as usize;
        let (others, rest) = rest[1..].split_at(others);
        let (ids, rest) = rest.split_at(particles);
        let (cells, rest) = rest.split_at(particles * D);
        let (columns, rest) = rest.split_at(particles * columns);
        Some((Group { kind, ids, columns, cells, first, others }, rest))
    }

    /// Numbers of the patches that the group is for.
    pub fn patches(&self) -> impl Iterator<Item = usize> + 'a {
        let others = self.others.iter().map(|&patch| patch as usize);
        std::iter::once(self.first).chain(others)
    }

    /// Cells of the particles.
    pub fn cells(&self) -> impl Iterator<Item = [i32; D]> + use<'a, D> {
        let cells = self.cells.chunks_exact(D);
        cells.map(|cell| array::from_fn(|a| cell[a] as i64 as i32))
    }

    /// Section of words of the column with index `k` among those that the particles carry.
    pub fn column(&self, k: usize) -> &'a [u64] {
        &self.columns[k * self.ids.len()..][..self.ids.len()]
    }
}
