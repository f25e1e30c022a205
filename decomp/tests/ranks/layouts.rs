//! The same patches give the same result on any number of ranks.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use decomp::comm::local::run_ranks;
use decomp::{
    Block, ColumnSpec, Comm, GhostExchange, GhostReach, IndexBox, Layout, Mirror, NodeArrays,
    NodeExchange, Parity, PatchOrder, Serial, SideKind, exact_sums, relocate,
};
use proptest::prelude::*;

const SPECS: [ColumnSpec; 2] = [
    ColumnSpec { name: "v", unit: "m/s", ghost: true, state: true, mirror: Mirror::Negate(0) },
    ColumnSpec { name: "e", unit: "J/kg", ghost: false, state: true, mirror: Mirror::Same },
];

const KINDS: [[SideKind; 2]; 4] = [
    [SideKind::Open, SideKind::Open],
    [SideKind::Mirror, SideKind::Open],
    [SideKind::Wrap, SideKind::Wrap],
    [SideKind::Mirror, SideKind::Mirror],
];

/// First cell and move of a particle.
type Particle<const D: usize> = ([i64; D], [i64; D]);

/// Content of each patch, by patch number.
type Held<T> = BTreeMap<usize, T>;

/// Stirred flag, number of own particles, cells, ids and columns of a block, in its own order.
type Table<const D: usize> = (bool, usize, Vec<[i32; D]>, Vec<u64>, Vec<Vec<u64>>);

/// Threads that work on the patches of the ranks.
static THREADS: LazyLock<rayon::ThreadPool> =
    LazyLock::new(|| rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap());

/// Merges the results of `body` for the patches of all ranks.
fn on_ranks<T: Send>(size: usize, body: impl Fn(&dyn Comm) -> Held<T> + Sync) -> Held<T> {
    run_ranks(size, |comm| body(comm)).into_iter().flatten().collect()
}

/// The same patches, assigned to ranks 0 to `size - 1` at random.
fn with_ranks_of<const D: usize>(layout: &Layout<D>, size: usize, seed: &[usize]) -> Layout<D> {
    let ranks: Vec<u32> =
        (0..layout.count()).map(|p| (seed[p % seed.len()] % size) as u32).collect();
    layout.clone().with_ranks(PatchOrder::hilbert(layout.parts()), &ranks)
}

/// Moves and exchanges particles; returns the particles that each patch then holds.
fn particles_held<const D: usize>(
    comm: &dyn Comm,
    layout: &Layout<D>,
    particles: &[Particle<D>],
    (depth, notice): (i64, i64),
    pool: Option<&rayon::ThreadPool>,
) -> Held<Table<D>> {
    let mine = layout.patches_of(comm.rank());
    let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(&SPECS)).collect();
    for (id, (cell, _)) in particles.iter().enumerate() {
        if let Some(k) = mine.iter().position(|&p| p == layout.patch_of(*cell)) {
            blocks[k].push(id as u64, cell.map(|c| c as i32), &[id as f64 + 1.0, 0.5]);
        }
    }
    let reach = GhostReach { depth, travel: 1, notice: Some(notice) };
    let mut exchange = GhostExchange::new(layout, comm.rank(), reach);
    for round in 0..3 {
        for block in &mut blocks {
            block.drop_ghosts();
            for particle in 0..block.own() {
                let by = particles[block.ids[particle] as usize]
                    .1
                    .map(|m| if round == 0 { 0 } else { m });
                let from = block.cells[particle].map(i64::from);
                let to = layout.wrap_cell(std::array::from_fn(|a| from[a] + by[a]));
                block.cells[particle] = to.unwrap_or(from).map(|c| c as i32);
            }
        }
        // the active cell of a patch is that of its first particle
        for block in &mut blocks {
            block.active = match block.cells.first() {
                Some(c) => IndexBox::new(c.map(i64::from), c.map(|c| i64::from(c) + 1)),
                None => IndexBox::new([0; D], [0; D]),
            };
        }
        let inner = exchange.inner().to_vec();
        let mut early = Vec::new();
        exchange
            .run(comm, &mut blocks, pool, &mut |blocks| {
                let inner = blocks.iter().zip(&inner).filter(|(_, i)| **i);
                early = inner.map(|(b, _)| (b.stirred, b.ids.clone())).collect();
            })
            .unwrap();
        // inner patches are complete while messages are on their way
        let late = blocks.iter().zip(&inner).filter(|(_, i)| **i);
        let late: Vec<_> = late.map(|(b, _)| (b.stirred, b.ids.clone())).collect();
        assert_eq!(early, late);
    }
    let table = |b: Block<D>| {
        let bits = |c: &Vec<f64>| c.iter().map(|v| v.to_bits()).collect();
        let columns = b.columns.iter().map(bits).collect();
        (b.stirred, b.own(), b.cells.clone(), b.ids.clone(), columns)
    };
    mine.into_iter().zip(blocks.into_iter().map(table)).collect()
}

/// Test value of a node.
fn value(node: i64, field: usize) -> f64 {
    (node as f64 + 0.1 * field as f64).sin()
}

/// Sets the owners' values and exchanges them; returns all values that each patch then holds.
fn nodes_held(comm: &dyn Comm, layout: &Layout<1>, depth: i64) -> Held<Vec<Vec<u64>>> {
    let mine = layout.patches_of(comm.rank());
    let mut patches: Vec<_> = mine.iter().map(|&p| NodeArrays::new(layout, p, depth, 2)).collect();
    for arrays in &mut patches {
        for node in arrays.owned.iter() {
            let at = arrays.nodes.flat(node);
            for field in 0..2 {
                arrays.fields[field][at] = value(node[0], field);
            }
        }
    }
    let mut exchange = NodeExchange::new(layout, comm.rank(), depth, depth);
    for _ in 0..2 {
        let fields = [(0, Parity::Even), (1, Parity::Odd(0))];
        exchange.refresh(comm, &mut patches, &fields, &mut |_| {});
    }
    let bits = |arrays: NodeArrays<1>| {
        let field = |f: &Vec<f64>| f.iter().map(|v| v.to_bits()).collect();
        arrays.fields.iter().map(field).collect()
    };
    mine.into_iter().zip(patches.into_iter().map(bits)).collect()
}

fn check_particles<const D: usize>(
    layout: Layout<D>,
    particles: &[Particle<D>],
    reach: (i64, i64),
    size: usize,
    seed: &[usize],
) {
    let alone = particles_held(&Serial, &layout, particles, reach, None);
    let assigned = with_ranks_of(&layout, size, seed);
    for pool in [None, Some(&*THREADS)] {
        let held = on_ranks(size, |comm| particles_held(comm, &assigned, particles, reach, pool));
        assert_eq!(held, alone);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ranks_on_a_line_hold_the_particles_of_one(
        particles in prop::collection::vec((1i64..23, -1i64..=1), 1..30),
        parts in 1usize..13,
        depth in 1i64..5,
        notice in 0i64..9,
        kind in 0usize..4,
        size in 1usize..=5,
        seed in prop::collection::vec(0usize..60, 12),
    ) {
        let particles: Vec<_> = particles.iter().map(|r| ([r.0], [r.1])).collect();
        let layout = Layout::new(IndexBox::new([0], [24]), [KINDS[kind]], [parts]);
        check_particles(layout, &particles, (depth, notice), size, &seed);
    }

    #[test]
    fn ranks_on_a_plane_hold_the_particles_of_one(
        particles in prop::collection::vec(((1i64..11, 1i64..8), (-1i64..=1, -1i64..=1)), 1..30),
        parts in (1usize..6, 1usize..5),
        depth in 1i64..4,
        notice in 0i64..7,
        kinds in (0usize..4, 0usize..4),
        size in 1usize..=5,
        seed in prop::collection::vec(0usize..60, 20),
    ) {
        let particles: Vec<_> = particles.iter().map(|r| ([r.0.0, r.0.1], [r.1.0, r.1.1])).collect();
        let sides = [KINDS[kinds.0], KINDS[kinds.1]];
        let layout = Layout::new(IndexBox::new([0, 0], [12, 9]), sides, [parts.0, parts.1]);
        check_particles(layout, &particles, (depth, notice), size, &seed);
    }

    #[test]
    fn ranks_hold_the_nodes_of_one(
        parts in 1usize..11,
        depth in 1i64..5,
        kind in 0usize..4,
        size in 1usize..=5,
        seed in prop::collection::vec(0usize..60, 10),
    ) {
        let layout = Layout::new(IndexBox::new([0], [10]), [KINDS[kind]], [parts]);
        let alone = nodes_held(&Serial, &layout, depth);
        let assigned = with_ranks_of(&layout, size, &seed);
        prop_assert_eq!(on_ranks(size, |comm| nodes_held(comm, &assigned, depth)), alone);
    }

    #[test]
    fn ranks_sum_to_the_bits_of_one(
        terms in prop::collection::vec((-1e20f64..1e20, 0usize..60), 1..60),
        size in 1usize..=5,
    ) {
        let sums = |comm: &dyn Comm| {
            let mine: Vec<f64> =
                terms.iter().filter(|t| t.1 % comm.size() == comm.rank()).map(|t| t.0).collect();
            exact_sums::<2>(comm, |add| {
                add(0, &mine);
                mine.iter().for_each(|x| add(1, &[1e-30 * x * x]));
            })
            .map(f64::to_bits)
        };
        let alone = sums(&Serial);
        prop_assert_eq!(run_ranks(size, |comm| sums(comm)), vec![alone; size]);
    }
}

/// After moves between assignments, patches hold the same particles as if assigned so at once.
#[test]
fn patches_move_with_all_their_particles() {
    let layout = Layout::new(IndexBox::new([0], [24]), [KINDS[0]], [7]);
    for size in 1..=5 {
        let layouts: Vec<Layout<1>> =
            (0..4).map(|k| with_ranks_of(&layout, size, &[k, 3 * k + 1, 4, 2 * k])).collect();
        let held = run_ranks(size, |comm| {
            let mine = layouts[0].patches_of(comm.rank());
            let mut blocks: Vec<Block<1>> = mine
                .into_iter()
                .map(|p| {
                    let mut block = Block::new(&SPECS);
                    let ids = (0..24).filter(|&id| layout.patch_of([id]) == p);
                    ids.for_each(|id| block.push(id as u64, [id as i32], &[id as f64, -1.5]));
                    block
                })
                .collect();
            let mut migrated = 0;
            for pair in layouts.windows(2) {
                let (moved, counts) =
                    relocate(comm, &pair[0], &pair[1], blocks, &SPECS, |_, block| block);
                (blocks, migrated) = (moved, migrated + counts.particles);
            }
            let last = layouts[3].patches_of(comm.rank());
            (last.into_iter().zip(blocks).collect::<Vec<_>>(), migrated)
        });
        for (patch, block) in held.iter().flat_map(|h| &h.0) {
            let ids: Vec<u64> =
                (0..24).filter(|&i| layout.patch_of([i as i64]) == *patch).collect();
            assert_eq!((&block.ids, block.own()), (&ids, ids.len()));
            assert!(block.columns[0].iter().zip(&ids).all(|(c, i)| *c == *i as f64));
            assert!(block.columns[1].iter().all(|c| *c == -1.5));
        }
        assert_eq!(held.iter().map(|h| h.0.len()).sum::<usize>(), 7);
        assert_eq!(held.iter().any(|h| h.1 > 0), size > 1);
    }
}
