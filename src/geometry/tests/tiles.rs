//! Tiles of lattices: sums, counts, positions, slivers.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::{BoundedRegion, Tile};
use super::{close, fill, shape, sum};

/// Shapes with all kinds of borders, about 4 m wide.
pub(super) fn shapes() -> Vec<(&'static str, Value)> {
    let disk = |x: f64, y: f64, r: f64| json!({"disk": {"centre": [x, y], "radius": r}});
    let turned = |angle: f64, of: Value| json!({"rotation": {"angle": angle, "about": [0.3, 0.1], "of": of}});
    let upright = json!({"box": {"lower": [-2.0, -1.0], "upper": [2.0, 1.0]}});
    let star: Vec<_> = (0..10)
        .map(|k| {
            let (sin, cos) = (PI * k as f64 / 5.0 + 0.1).sin_cos();
            let r = if k % 2 == 0 { 2.0 } else { 0.7 };
            [r * cos, r * sin]
        })
        .collect();
    let star = json!({"polygon": {"vertices": star}});
    vec![
        ("disk", disk(0.1, 0.2, 2.0)),
        ("turned box", turned(30.0, upright.clone())),
        ("nearly upright box", turned(1e-7, upright)),
        (
            "turned ellipse",
            turned(-20.0, json!({"ellipse": {"centre": [0.0, 0.0], "radii": [2.0, 0.6]}})),
        ),
        (
            "annulus less a star",
            json!({"difference": [
            {"annulus": {"centre": [0.0, 0.0], "inner": 0.5, "outer": 2.0}}, star]}),
        ),
        ("star and disk", json!({"union": [star, disk(0.0, 0.0, 1.0)]})),
        ("lens", json!({"intersection": [disk(-1.0, 0.0, 2.0), disk(1.0, 0.3, 2.0)]})),
        ("thin ring", json!({"annulus": {"centre": [0.0, 0.0], "inner": 1.99, "outer": 2.0}})),
    ]
}

pub(super) const GRIDS: [([f64; 2], [f64; 2], [usize; 2]); 4] = [
    ([-3.0, -3.0], [0.5, 0.5], [2, 2]),
    ([-3.17, -4.03], [0.1, 0.13], [2, 3]),
    ([-5.0, -5.0], [0.07, 0.07], [3, 3]),
    ([100.3, 50.1], [0.2, 0.1], [1, 1]),
];

fn check(shape: &BoundedRegion, tiles: &[Tile], cell: [f64; 2], per_cell: [usize; 2]) {
    let (sum, area) = (sum(tiles), shape.area());
    close(sum.area, area, 1e-11, area);
    for d in 0..2 {
        let exact = area * shape.centroid()[d];
        close(sum.first[d], exact, 1e-11, area * (1.0 + shape.centroid()[d].abs()));
    }
    let size = [0, 1].map(|d| cell[d] / per_cell[d] as f64);
    for tile in tiles {
        assert!(tile.area >= 0.02 * size[0] * size[1], "{tile:?} is a sliver");
        close(tile.size[0] * tile.size[1], tile.area, 1e-14, tile.area);
        close(tile.size[0] / tile.size[1], size[0] / size[1], 1e-14, 1.0);
    }
}

#[test]
fn tiles_have_the_area_and_the_moments_of_the_shape() {
    for (name, json) in shapes() {
        let shape = shape(json);
        for (lower, cell, per_cell) in GRIDS {
            println!("{name} by {cell:?}");
            check(&shape, &fill(&shape, lower, cell, per_cell), cell, per_cell);
        }
    }
}

#[test]
fn tiles_are_ordered_by_y_and_then_by_x() {
    let shape = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    let tiles = fill(&shape, [-2.0, -2.0], [0.1, 0.1], [1, 1]);
    let cell = |tile: &Tile| tile.centre.map(|x| ((x + 2.0) / 0.1).floor() as i64);
    let order: Vec<_> = tiles.iter().map(cell).map(|[i, j]| [j, i]).collect();
    assert!(order.is_sorted() && order.windows(2).all(|p| p[0] != p[1]));
    assert_eq!(tiles, fill(&shape, [-2.0, -2.0], [0.1, 0.1], [1, 1]), "the same each time");
}

#[test]
fn whole_tiles_are_those_of_the_lattice() {
    let shape = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    let tiles = fill(&shape, [-2.0, -2.0], [0.1, 0.1], [2, 2]);
    let whole = tiles.iter().filter(|t| t.area == 0.05 * 0.05).count();
    // count of the tiles whose four corners are inside
    let inside = |i: i32, j: i32| (i * i + j * j) <= 400;
    let all = |i, j| [(0, 0), (0, 1), (1, 0), (1, 1)].iter().all(|(a, b)| inside(i + a, j + b));
    let count = (-20..20).flat_map(|i| (-20..20).map(move |j| (i, j))).filter(|p| all(p.0, p.1));
    assert_eq!(whole, count.count());
    for tile in tiles.iter().filter(|t| t.area == 0.05 * 0.05) {
        let place = tile.centre.map(|x| (x + 2.0) / 0.05 - 0.5);
        assert!(place.iter().all(|p| (p - p.round()).abs() < 1e-12), "{tile:?}");
        assert_eq!(tile.size, [0.05, 0.05]);
    }
}

#[test]
fn a_shape_on_the_lattice_has_whole_tiles_alone() {
    // a union, so that the lattice is that of the grid
    let shape = shape(json!({"union": [
        {"box": {"lower": [0.1, 0.2], "upper": [0.4, 0.7]}},
        {"box": {"lower": [0.4, 0.2], "upper": [0.6, 0.3]}}]}));
    let tiles = fill(&shape, [0.0, 0.0], [0.1, 0.1], [2, 2]);
    assert_eq!(tiles.len(), 4 * (15 + 2));
    assert!(tiles.iter().all(|t| (t.area - 0.0025).abs() < 1e-17), "whole");
}

#[test]
fn a_sliver_goes_to_the_neighbour_that_it_shares_most_with() {
    // 1 % of a column of tiles beyond x = 1, and a corner of 0.01 %
    let shape =
        shape(json!({"polygon": {"vertices": [[0, 0], [1.01, 0], [1.01, 2.01], [0, 2.01]]}}));
    let tiles = fill(&shape, [0.0, 0.0], [1.0, 1.0], [1, 1]);
    assert_eq!(tiles.len(), 2);
    close(tiles[0].area, 1.01, 1e-15, 1.0);
    close(tiles[0].centre[0], 0.505, 1e-15, 1.0);
    close(tiles[1].area, 1.01 * 1.01, 1e-15, 1.0);
    close(tiles[1].centre[0], 0.505, 1e-15, 1.0);
    close(tiles[1].centre[1], 1.0 + 0.505, 1e-15, 1.0);
    close(tiles[1].size[0], 1.01, 1e-15, 1.0);
}

#[test]
fn a_sliver_goes_by_its_edges_before_its_distance() {
    // a sliver of 1 % of a tile: 0.2 of an edge above a whole tile, 0.05 of an edge beside a nearer
    // part
    let body = |lower: [f64; 2], upper: [f64; 2]| json!({"box": {"lower": lower, "upper": upper}});
    let shape = shape(json!({"union": [
        body([1.0, 0.0], [2.0, 1.0]),
        body([0.8, 1.0], [1.0, 1.2]),
        body([1.0, 1.0], [1.2, 1.05])]}));
    let tiles = fill(&shape, [0.0, 0.0], [1.0, 1.0], [1, 1]);
    assert_eq!(tiles.len(), 2);
    close(tiles[0].area, 1.01, 1e-14, 1.0);
    close(tiles[1].area, 0.04, 1e-14, 1.0);
}

#[test]
fn a_sliver_at_a_corner_goes_across_it() {
    let shape = shape(json!({"union": [
        {"box": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}},
        {"box": {"lower": [1.0, 1.0], "upper": [1.1, 1.1]}}]}));
    let tiles = fill(&shape, [0.0, 0.0], [1.0, 1.0], [1, 1]);
    assert_eq!(tiles.len(), 1);
    close(tiles[0].area, 1.01, 1e-14, 1.0);
}

#[test]
fn a_body_all_of_slivers_is_merged_within_itself() {
    // a strip of 0.7 % of a tile over nine tiles: three add up to 2.1 %
    let strip = json!({"polygon": {"vertices": [[0, 0], [9, 0], [9, 0.007], [0, 0.007]]}});
    let strip = shape(strip);
    let tiles = fill(&strip, [0.0, 0.0], [1.0, 1.0], [1, 1]);
    check(&strip, &tiles, [1.0, 1.0], [1, 1]);
    assert!(tiles.len() >= 2, "{}", tiles.len());
    let speck = shape(json!({"disk": {"centre": [0.5, 0.5], "radius": 0.01}}));
    let tiles = fill(&speck, [0.0, 0.0], [1.0, 1.0], [1, 1]);
    assert_eq!(tiles.len(), 1, "smaller than a sliver itself");
    close(tiles[0].area, PI * 1e-4, 1e-12, PI * 1e-4);
}

#[test]
fn the_borders_of_neighbours_leave_no_gap() {
    // two bodies on the two sides of one tilted line: together they fill each tile
    let side = |sign: f64| {
        shape(json!({"intersection": [
            {"box": {"lower": [-1.0, -1.0], "upper": [1.0, 1.0]}},
            {"half_plane": {"point": [0.1, 0.0], "normal": [sign * 2.0, sign * 1.0]}}]}))
    };
    let (left, right) = (side(1.0), side(-1.0));
    for i in -10..10 {
        for j in -10..10 {
            let lower = [f64::from(i) * 0.1, f64::from(j) * 0.1];
            let upper = [f64::from(i + 1) * 0.1, f64::from(j + 1) * 0.1];
            let area = |s: &BoundedRegion| s.moments_within(lower, upper).area;
            close(area(&left) + area(&right), 0.01, 1e-12, 0.01);
        }
    }
}
