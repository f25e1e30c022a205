//! Particles of one patch for the patches of one destination: each is packed once for all of them.

use crate::packing::{put_particles, put_stir};
use crate::planned_words::{bits, only, packed_words};
use crate::{Block, Image, IndexBox, Layout};

/// Distances of ghosts and of motion [cells].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GhostReach {
    /// Width of the ghost region around a patch, see [`Layout::halo`].
    pub depth: i64,
    /// Largest distance that a particle moves between two exchanges.
    pub travel: i64,
    /// Active cells within this distance make a patch stirred; `None`: patches always are.
    pub notice: Option<i64>,
}

/// Patches of one destination that may need particles of one patch of this rank. A particle is
/// packed once for all of them.
#[derive(Clone, Debug)]
pub(crate) struct Bundle<const D: usize> {
    pub taker: Taker,
    /// At most [`MOST_RECEIVERS`].
    receivers: Vec<Receiver<D>>,
    images: Vec<ImageGroups<D>>,
    /// The packed groups of the last exchange.
    pub words: Vec<u64>,
}

/// A patch that may need particles of another.
#[derive(Clone, Debug)]
struct Receiver<const D: usize> {
    patch: usize,
    /// Its cells, those whose particles it sees, and those that make it stirred.
    home: IndexBox<D>,
    halo: IndexBox<D>,
    near: IndexBox<D>,
}

/// Particles of one patch that appear in one image at the receivers of a bundle.
#[derive(Clone, Debug)]
struct ImageGroups<const D: usize> {
    image: Image<D>,
    /// Receivers that see a part of the domain in this image, one bit each.
    seers: u64,
    /// Smallest box that contains the cells whose images lie in the halos of these receivers.
    sources: IndexBox<D>,
    /// Particles to hand over, by receiver.
    movers: Vec<Vec<u32>>,
    /// Particles to copy as ghosts, by the set of their receivers. Sets of former steps remain,
    /// without particles.
    ghosts: Vec<(u64, Vec<u32>)>,
    /// Index of the last set that got a particle: the next particle mostly has the same.
    last: usize,
}

impl<const D: usize> ImageGroups<D> {
    /// Adds a ghost for the receivers of the set `receivers`.
    fn push_ghost(&mut self, receivers: u64, particle: u32) {
        let ImageGroups { ghosts, last, .. } = self;
        if ghosts.get(*last).is_none_or(|(set, _)| *set != receivers) {
            *last = ghosts.iter().position(|(set, _)| *set == receivers).unwrap_or_else(|| {
                ghosts.push((receivers, Vec::new()));
                ghosts.len() - 1
            });
        }
        ghosts[*last].1.push(particle);
    }
}

/// Destination of the words of a bundle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Taker {
    /// A message to a rank.
    Message(usize),
    /// Patches of this rank.
    Here,
}

impl Taker {
    /// The rank, if it is another one.
    pub fn rank(self) -> Option<usize> {
        match self {
            Taker::Message(rank) => Some(rank),
            Taker::Here => None,
        }
    }
}

/// Greatest number of receivers of a bundle: a set of them is the bits of a number.
pub(crate) const MOST_RECEIVERS: usize = 64;

impl<const D: usize> Bundle<D> {
    /// The patches `takers` of one destination.
    pub fn new(
        layout: &Layout<D>,
        reach: GhostReach,
        images: &[Image<D>],
        takers: &[(Taker, usize)],
    ) -> Self {
        let GhostReach { depth, notice, .. } = reach;
        let seen = depth.max(notice.unwrap_or(0));
        let receiver = |&(_, patch): &(Taker, usize)| Receiver {
            patch,
            home: layout.patch(patch),
            halo: layout.halo(patch, depth),
            near: layout.patch(patch).grow(notice.unwrap_or(-1)),
        };
        let receivers: Vec<Receiver<D>> = takers.iter().map(receiver).collect();
        let groups = |&image: &Image<D>| {
            // a particle that has crossed a joined side already carries a cell at the other end
            let domain = image.cells(layout.domain());
            let sees = |r: &Receiver<D>| !domain.intersect(&r.home.grow(seen)).is_empty();
            let bit = |(k, r)| u64::from(sees(r)) << k;
            let seers = receivers.iter().enumerate().map(bit).fold(0, |set, bit| set | bit);
            let halos = bits(seers).map(|k| receivers[k].halo);
            let sources = image.source_cells(&halos.reduce(|all, halo| all.hull(&halo))?);
            let movers = vec![Vec::new(); receivers.len()];
            Some(ImageGroups { image, seers, sources, movers, ghosts: Vec::new(), last: 0 })
        };
        let images = images.iter().filter_map(groups).collect();
        Bundle { taker: takers[0].0, receivers, images, words: Vec::new() }
    }

    /// Notes the receivers that need `particle` of `patch`, in `cell`; `stays` says whether the cell
    /// is one of that patch. Returns whether one of them owns it from now on.
    pub fn sort_in(&mut self, particle: u32, cell: [i64; D], stays: bool, patch: usize) -> bool {
        let Bundle { receivers, images, .. } = self;
        let mut owned = false;
        for groups in images.iter_mut().filter(|groups| groups.sources.contains(cell)) {
            let at = groups.image.cell(cell);
            let original = groups.image == Image::IDENTITY;
            let mut ghost = 0;
            for k in bits(groups.seers) {
                let receiver = &receivers[k];
                // a staying particle is not sent to its patch; a leaver may return as a ghost
                if !receiver.halo.contains(at) || (stays && original && receiver.patch == patch) {
                    continue;
                }
                if original && receiver.home.contains(at) {
                    groups.movers[k].push(particle);
                    owned = true;
                } else {
                    ghost |= 1 << k;
                }
            }
            if ghost != 0 {
                groups.push_ghost(ghost, particle);
            }
        }
        owned
    }

    /// Words that the ghosts of `patch` with the cells `home` take in this bundle, of `words` words
    /// each, if `count` gives the number of particles in a box. No particle leaves the patch, and no
    /// patch is stirred.
    pub fn ghost_words(
        &self,
        (patch, home): (usize, &IndexBox<D>),
        words: u64,
        count: &dyn Fn(&IndexBox<D>) -> u64,
    ) -> u64 {
        let of_image = |groups: &ImageGroups<D>| {
            let original = groups.image == Image::IDENTITY;
            let others = |(_, r): &(usize, &Receiver<D>)| !original || r.patch != patch;
            let seers = self.receivers.iter().enumerate().filter(others);
            let seers = seers.fold(0, |set, (k, _)| set | groups.seers & 1 << k);
            let seen = self.receivers.iter().map(|r| groups.image.source_cells(&r.halo));
            packed_words(home, &only(seers, seen), words, count)
        };
        self.images.iter().map(of_image).sum()
    }

    /// Packs the notice that receivers near the active cells of `block`, of `patch`, are stirred.
    pub fn put_stirs(&mut self, block: &Block<D>, patch: usize) {
        let Bundle { receivers, images, words, .. } = self;
        for (k, receiver) in receivers.iter().enumerate().filter(|(_, r)| r.patch != patch) {
            let near = |groups: &ImageGroups<D>| {
                let active = groups.image.cells(&block.active);
                groups.seers >> k & 1 == 1 && !active.intersect(&receiver.near).is_empty()
            };
            if images.iter().any(near) {
                put_stir(words, receiver.patch);
            }
        }
    }

    /// Packs the noted particles of `block` and forgets them.
    pub fn put_particles(&mut self, block: &Block<D>) {
        let Bundle { receivers, images, words, .. } = self;
        for ImageGroups { image, movers, ghosts, .. } in images {
            for (receiver, movers) in receivers.iter().zip(movers) {
                put_particles(words, block, movers, std::iter::once(receiver.patch), true, image);
                movers.clear();
            }
            for (set, ghosts) in ghosts {
                let patches = bits(*set).map(|k| receivers[k].patch);
                put_particles(words, block, ghosts, patches, false, image);
                ghosts.clear();
            }
        }
    }
}
