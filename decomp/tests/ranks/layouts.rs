//! The same patches, dealt to any number of ranks.

use std::collections::BTreeMap;

use decomp::comm::local::run_ranks;
use decomp::{
    Block, ColumnSpec, Comm, IndexBox, Layout, Mirror, NodeArrays, NodeExchange, Parity,
    RowExchange, Serial, Side, exact_sums, gather_rows,
};
use proptest::prelude::*;

const SPECS: [ColumnSpec; 2] = [
    ColumnSpec { name: "v", unit: "m/s", ghost: true, state: true, mirror: Mirror::Negate(0) },
    ColumnSpec { name: "e", unit: "J/kg", ghost: false, state: true, mirror: Mirror::Same },
];

const KINDS: [[Side; 2]; 4] = [
    [Side::Open, Side::Open],
    [Side::Mirror, Side::Open],
    [Side::Wrap, Side::Wrap],
    [Side::Mirror, Side::Mirror],
];

/// A row's first cell and its move.
type Row<const D: usize> = ([i64; D], [i64; D]);

/// What each patch holds, by patch.
type Held<T> = BTreeMap<usize, T>;

/// Cells, ids and columns of a block, in its own order.
type Table<const D: usize> = (usize, Vec<[i32; D]>, Vec<u64>, Vec<Vec<u64>>);

/// What `body` tells of the patches of each rank, put together.
fn on_ranks<T: Send>(size: usize, body: impl Fn(&dyn Comm) -> Held<T> + Sync) -> Held<T> {
    run_ranks(size, |comm| body(comm)).into_iter().flatten().collect()
}

/// The same patches on ranks 0 to `size - 1`, dealt at random.
fn deal<const D: usize>(layout: &Layout<D>, size: usize, seed: &[usize]) -> Layout<D> {
    let ranks = (0..layout.patches().len()).map(|p| seed[p % seed.len()] % size).collect();
    layout.clone().with_ranks(ranks)
}

/// Rows at cells, moved by their moves and exchanged, and what each patch then holds.
fn rows_held<const D: usize>(
    comm: &dyn Comm,
    layout: &Layout<D>,
    rows: &[Row<D>],
    depth: i64,
) -> Held<Table<D>> {
    let mine = layout.patches_of(comm.rank());
    let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(&SPECS)).collect();
    for (id, (cell, _)) in rows.iter().enumerate() {
        if let Some(k) = mine.iter().position(|&p| p == layout.patch_of(*cell)) {
            blocks[k].push(id as u64, cell.map(|c| c as i32), &[id as f64 + 1.0, 0.5]);
        }
    }
    let mut exchange = RowExchange::new(layout, comm.rank(), depth, 1);
    for round in 0..3 {
        for block in &mut blocks {
            block.drop_ghosts();
            for row in 0..block.own() {
                let by = rows[block.ids[row] as usize].1.map(|m| if round == 0 { 0 } else { m });
                let from = block.cells[row].map(i64::from);
                let to = layout.wrap_cell(std::array::from_fn(|a| from[a] + by[a]));
                block.cells[row] = to.unwrap_or(from).map(|c| c as i32);
            }
        }
        exchange.run(comm, &mut blocks).unwrap();
    }
    let table = |b: Block<D>| {
        let bits = |c: &Vec<f64>| c.iter().map(|v| v.to_bits()).collect();
        (b.own(), b.cells.clone(), b.ids.clone(), b.columns.iter().map(bits).collect())
    };
    mine.into_iter().zip(blocks.into_iter().map(table)).collect()
}

/// Some value of a node.
fn value(node: i64, field: usize) -> f64 {
    (node as f64 + 0.1 * field as f64).sin()
}

/// Random owners' values, and what each patch then holds of all.
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
    let mut exchange = NodeExchange::new(layout, comm.rank(), depth);
    for _ in 0..2 {
        exchange.refresh(comm, &mut patches, &[(0, Parity::Even), (1, Parity::Odd(0))]);
    }
    let bits = |arrays: NodeArrays<1>| {
        let field = |f: &Vec<f64>| f.iter().map(|v| v.to_bits()).collect();
        arrays.fields.iter().map(field).collect()
    };
    mine.into_iter().zip(patches.into_iter().map(bits)).collect()
}

fn check_rows<const D: usize>(
    layout: Layout<D>,
    rows: &[Row<D>],
    depth: i64,
    size: usize,
    seed: &[usize],
) {
    let alone = rows_held(&Serial, &layout, rows, depth);
    let dealt = deal(&layout, size, seed);
    assert_eq!(on_ranks(size, |comm| rows_held(comm, &dealt, rows, depth)), alone);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ranks_on_a_line_hold_the_rows_of_one(
        rows in prop::collection::vec((1i64..23, -1i64..=1), 1..30),
        parts in 1usize..13,
        depth in 1i64..5,
        kind in 0usize..4,
        size in 1usize..=5,
        seed in prop::collection::vec(0usize..60, 12),
    ) {
        let rows: Vec<_> = rows.iter().map(|r| ([r.0], [r.1])).collect();
        let layout = Layout::new(IndexBox::new([0], [24]), [KINDS[kind]], [parts]);
        check_rows(layout, &rows, depth, size, &seed);
    }

    #[test]
    fn ranks_on_a_plane_hold_the_rows_of_one(
        rows in prop::collection::vec(((1i64..11, 1i64..8), (-1i64..=1, -1i64..=1)), 1..30),
        parts in (1usize..6, 1usize..5),
        depth in 1i64..4,
        kinds in (0usize..4, 0usize..4),
        size in 1usize..=5,
        seed in prop::collection::vec(0usize..60, 20),
    ) {
        let rows: Vec<_> = rows.iter().map(|r| ([r.0.0, r.0.1], [r.1.0, r.1.1])).collect();
        let sides = [KINDS[kinds.0], KINDS[kinds.1]];
        let layout = Layout::new(IndexBox::new([0, 0], [12, 9]), sides, [parts.0, parts.1]);
        check_rows(layout, &rows, depth, size, &seed);
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
        let dealt = deal(&layout, size, &seed);
        prop_assert_eq!(on_ranks(size, |comm| nodes_held(comm, &dealt, depth)), alone);
    }

    #[test]
    fn ranks_sum_to_the_bits_of_one(
        terms in prop::collection::vec((-1e20f64..1e20, 0usize..60), 1..60),
        size in 1usize..=5,
    ) {
        let sums = |comm: &dyn Comm| {
            let mine: Vec<f64> =
                terms.iter().filter(|t| t.1 % comm.size() == comm.rank()).map(|t| t.0).collect();
            exact_sums::<_, 2>(comm, |add| {
                mine.iter().for_each(|&x| {
                    add(0, x);
                    add(1, 1e-30 * x * x);
                })
            })
            .map(f64::to_bits)
        };
        let alone = sums(&Serial);
        prop_assert_eq!(run_ranks(size, |comm| sums(comm)), vec![alone; size]);
    }
}

#[test]
fn rows_are_gathered_at_rank_0_by_id() {
    let gathered = run_ranks(3, |comm| {
        let mut block = Block::<1>::new(&SPECS);
        for id in (0..10).filter(|id| id % 3 == 2 - comm.rank() as u64) {
            block.push(id, [id as i32], &[id as f64, 0.5 * id as f64]);
        }
        gather_rows(comm, std::iter::once(&block), &[1])
    });
    let (ids, columns) = &gathered[0];
    assert_eq!(*ids, (0..10).collect::<Vec<u64>>());
    assert_eq!(columns[0], (0..10).map(|id| 0.5 * id as f64).collect::<Vec<_>>());
    assert!(gathered[1..].iter().all(|(ids, _)| ids.is_empty()));
}
