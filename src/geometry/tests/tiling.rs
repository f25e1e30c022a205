//! Tilings against all tiles, cut and merged one by one.

use proptest::prelude::*;
use serde_json::json;

use super::super::column::Column;
use super::super::lattice::{Cut, Lattice};
use super::super::merge::merge;
use super::super::{BoundedRegion, CellBox, Tile, Tiling, fill};
use super::random::part;
use super::tiles::{GRIDS, shapes};
use super::{region, shape};

/// The tiles of a shape by brute force: every tile of the lattice is cut.
fn every_tile(shape: &BoundedRegion, lattice: &Lattice) -> Vec<Tile> {
    let [lower, upper] = shape.bounds();
    let [first, last] = lattice.reach(0, [lower[0], upper[0]]);
    let columns = (first..last).map(|column| Column::new(shape, lattice, column));
    let mut cuts: Vec<Cut> = columns.flat_map(|c| c.border(&[]).collect::<Vec<_>>()).collect();
    cuts.sort_unstable_by_key(|cut| cut.index);
    merge(shape, lattice, &mut cuts);
    cuts.iter().map(|cut| lattice.tile(cut)).collect()
}

fn is_in(cell: [i64; 2], [lower, upper]: CellBox) -> bool {
    (0..2).all(|d| lower[d] <= cell[d] && cell[d] < upper[d])
}

/// Compares a tiling with all of its tiles: numbers, cells, slices, sizes and nearest tiles.
fn check(tiling: &Tiling, tiles: &[Tile], lattice: &Lattice) {
    assert_eq!(tiling.all(), tiles);
    assert_eq!(tiling.count(), tiles.len() as u64);
    let cells: Vec<_> = tiles.iter().map(|tile| lattice.cell_of(tile.centre)).collect();
    let all = cells.iter().fold([[i64::MAX; 2], [i64::MIN; 2]], |[a, b], c| {
        [[0, 1].map(|d| a[d].min(c[d])), [0, 1].map(|d| b[d].max(c[d] + 1))]
    });
    let cut = [0, 1].map(|d| (2 * all[0][d] + all[1][d]).div_euclid(3));
    for (x, y) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let side = |d: usize, k: i64| [[all[0][d], cut[d]], [cut[d], all[1][d]]][k as usize];
        let (x, y) = (side(0, x), side(1, y));
        let cells_here = [[x[0], y[0]], [x[1], y[1]]];
        let mut found = Vec::new();
        tiling.each_in(cells_here, &mut |number, tile| found.push((number, tile)));
        found.sort_by_key(|(number, _)| *number);
        let here = (0..tiles.len()).filter(|&k| is_in(cells[k], cells_here));
        let expected: Vec<_> = here.map(|k| (k as u64, tiles[k])).collect();
        assert_eq!(found, expected, "{cells_here:?}");
        assert_eq!(tiling.count_in(cells_here), expected.len() as u64);
    }
    for axis in 0..2 {
        let count = all[1][axis].max(1);
        let expected = (0..count).map(|slice| {
            cells.iter().filter(|cell| cell[axis].clamp(0, count - 1) == slice).count() as u64
        });
        assert_eq!(tiling.slices(axis, count as usize), expected.collect::<Vec<_>>());
    }
    let longest = |tiles: &mut dyn Iterator<Item = Tile>| {
        tiles.fold([0.0; 2], |most: [f64; 2], t| [0, 1].map(|d| most[d].max(t.size[d])))
    };
    let (found, longest) = (tiling.longest(), longest(&mut tiles.iter().copied()));
    for d in 0..2 {
        assert!((found[d] - longest[d]).abs() <= 1e-9 * longest[d], "{found:?} {longest:?}");
    }
    for k in 0..7 {
        let at = [0, 1].map(|d| {
            let share = f64::from(k * (3 + 2 * d as i32) % 7) / 6.0;
            lattice.lower[d]
                + (all[0][d] as f64 + share * (all[1][d] - all[0][d]) as f64) * lattice.cell[d]
        });
        let apart = |tile: &Tile| (0..2).map(|d| (at[d] - tile.centre[d]).powi(2)).sum::<f64>();
        let nearest =
            (0..tiles.len()).min_by(|&a, &b| apart(&tiles[a]).total_cmp(&apart(&tiles[b])));
        assert_eq!(tiling.nearest(&at), nearest.unwrap_or(0) as u64, "{at:?}");
    }
}

#[test]
fn a_tiling_has_the_tiles_that_are_cut_one_by_one() {
    for (name, json) in shapes() {
        let shape = shape(json);
        for (lower, cell, per_cell) in GRIDS {
            println!("{name} by {cell:?}");
            let lattice = Lattice { lower, cell, per_cell };
            let tiling = fill(shape.clone(), lower, cell, per_cell).unwrap();
            check(&tiling, &every_tile(&shape, &lattice), &lattice);
        }
    }
}

#[test]
fn tiles_far_from_the_origin_keep_their_rounding() {
    // sides of tiles are rounded by some 1e-10 of an edge: no tile is whole to 1e-12
    let shape = shape(json!({"disk": {"centre": [1e4, 1e4], "radius": 0.02}}));
    let ([lower, cell], per_cell) = ([[0.0; 2], [1e-3; 2]], [2, 2]);
    let lattice = Lattice { lower, cell, per_cell };
    let tiling = fill(shape.clone(), lower, cell, per_cell).unwrap();
    assert_eq!(tiling.all(), every_tile(&shape, &lattice));
}

#[test]
fn given_tiles_are_found_by_their_cells() {
    let lattice = Lattice { lower: [-1.0, 0.0], cell: [0.5, 0.25], per_cell: [1, 1] };
    let tile = |k: u32| Tile {
        centre: [f64::from(k * 7 % 11) * 0.2 - 0.9, f64::from(k * 5 % 13) * 0.1 + 0.03],
        area: 0.01,
        size: [0.1, 0.1 + 0.001 * f64::from(k)],
    };
    let tiles: Vec<Tile> = (0..40).map(tile).collect();
    let tiling = Tiling::of_tiles(tiles.clone(), lattice.lower, lattice.cell);
    check(&tiling, &tiles, &lattice);
}

#[test]
fn a_large_disk_is_counted_and_not_built() {
    // 1e9 tiles: their number is the area over that of a tile, but for the border
    let radius = 1.0;
    let cell = 2.0 * (std::f64::consts::PI / 1e9_f64).sqrt();
    let disk = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": radius}}));
    let tiling = fill(disk, [-2.0; 2], [cell; 2], [2, 2]).unwrap();
    let count = tiling.count() as f64;
    assert!((count - 1e9).abs() < 1e5, "{count}");
    let mut some = 0;
    let near = ((2.0 / cell) as i64, (2.0 / cell) as i64);
    let cells = [[near.0, near.1], [near.0 + 10, near.1 + 10]];
    tiling.each_in(cells, &mut |_, tile| {
        assert!((tile.area - 0.25 * cell * cell).abs() < 1e-9 * cell * cell);
        some += 1;
    });
    assert_eq!((some, tiling.count_in(cells)), (400, 400));
}

#[test]
fn a_border_without_end_is_refused() {
    let strip = json!({"polygon": {"vertices": [[0, 0], [1e9, 0.5], [1e9, 1], [0, 0.5]]}});
    assert!(fill(shape(strip), [0.0; 2], [1.0; 2], [1, 1]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn random_tilings_have_the_tiles_that_are_cut_one_by_one(
        a in part(), b in part(), c in part(), size in 0.05..0.4, x in -0.5..0.5, y in -0.5..0.5
    ) {
        let json = json!({"difference": [{"union": [a, b]}, c]});
        let Ok(shape) = BoundedRegion::new(&region(json)) else { return Ok(()) };
        let lattice = Lattice { lower: [x - 4.0, y - 4.0], cell: [size, 0.7 * size], per_cell: [2, 1] };
        let tiling = fill(shape.clone(), lattice.lower, lattice.cell, lattice.per_cell).unwrap();
        check(&tiling, &every_tile(&shape, &lattice), &lattice);
    }
}
