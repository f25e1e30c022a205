//! Groups of particles in messages, column after column: packed and read at the cost of a copy.

use crate::{Block, Image};

/// Kind of a group: ghosts, migrating particles, or notice that a patch is stirred.
const GHOST: u64 = 0;
const OWN: u64 = 1;
const STIR: u64 = 2;

/// Bits of the first word of a group: the kind, then the number of patches after the first one, then
/// the first patch.
const KIND_BITS: u32 = 2;
const OTHERS_BITS: u32 = 6;

fn head(first: usize, others: usize, kind: u64) -> u64 {
    debug_assert!(others < 1 << OTHERS_BITS, "too many patches of a group");
    (((first as u64) << OTHERS_BITS) | others as u64) << KIND_BITS | kind
}

/// Adds the notice to patch `to` that it is stirred.
pub(crate) fn put_stir(out: &mut Vec<u64>, to: usize) {
    out.push(head(to, 0, STIR));
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
    let start = out.len();
    out.extend([0, particles.len() as u64]);
    out.extend(to.map(|patch| patch as u64));
    let others = out.len() - start - 2;
    out[start] = head(first, others, if own { OWN } else { GHOST });
    out.extend(particles.iter().map(|&r| block.ids[r as usize]));
    for &particle in particles {
        out.extend(image.cell(block.cells[particle as usize].map(i64::from)).map(|c| c as u64));
    }
    let mirrored = image.flip.contains(&true);
    let mut put = |c: usize| {
        let (spec, column) = (&block.specs()[c], &block.columns[c][..]);
        if mirrored {
            let value = |r: u32| spec.image(column[r as usize], &image.flip);
            out.extend(particles.iter().map(|&r| value(r).to_bits()));
        } else {
            out.extend(particles.iter().map(|&r| column[r as usize].to_bits()));
        }
    };
    if own {
        (0..block.columns.len()).for_each(put);
    } else {
        block.ghost_columns().iter().for_each(|&c| put(c));
    }
}

/// Adds the particles of a message to their blocks, either ghosts or own particles. `numbers` are the
/// numbers of `patches`, ascending.
pub(crate) fn take<const D: usize>(
    numbers: &[usize],
    mut words: &[u64],
    patches: &mut [impl AsMut<Block<D>>],
    ghosts: bool,
) {
    let place = |patch: usize| numbers.binary_search(&patch).expect("a patch of this rank");
    while let Some((&head, rest)) = words.split_first() {
        let kind = head & ((1 << KIND_BITS) - 1);
        let others = (head >> KIND_BITS & ((1 << OTHERS_BITS) - 1)) as usize;
        let first = (head >> (KIND_BITS + OTHERS_BITS)) as usize;
        let block = patches[place(first)].as_mut();
        words = rest;
        if kind == STIR {
            block.stirred = true;
            continue;
        }
        let own = kind == OWN;
        let particles = words[0] as usize;
        let columns = if own { block.columns.len() } else { block.ghost_columns().len() };
        let (others, rest) = words[1..].split_at(others);
        let (stretch, rest) = rest.split_at(particles * (1 + D + columns));
        words = rest;
        if own == ghosts {
            continue;
        }
        let (ids, stretch) = stretch.split_at(particles);
        let (cells, columns) = stretch.split_at(particles * D);
        for to in std::iter::once(first).chain(others.iter().map(|&to| to as usize)) {
            let block = patches[place(to)].as_mut();
            let cells = cells
                .chunks_exact(D)
                .map(|c| std::array::from_fn::<i32, D, _>(|a| c[a] as i64 as i32));
            if own {
                block.extend_own(ids, cells, columns)
            } else {
                block.extend_ghosts(ids, cells, columns)
            }
        }
    }
}
