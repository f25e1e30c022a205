//! Tiles around given points.

use proptest::prelude::*;
use serde_json::json;

use super::super::{BoundedRegion, voronoi, voronoi_line};
use super::{close, fill, shape, sum};

fn ring() -> BoundedRegion {
    shape(json!({"difference": [
        {"annulus": {"centre": [0.0, 0.0], "inner": 0.4, "outer": 1.0}},
        {"polygon": {"vertices": [[0.0, 0.0], [2.0, -0.3], [2.0, 0.3]]}}]}))
}

fn check(shape: &BoundedRegion, points: &[[f64; 2]]) {
    let tiles = voronoi(shape, points).unwrap();
    assert_eq!(tiles.len(), points.len());
    let (sum, area) = (sum(&tiles), shape.area());
    close(sum.area, area, 1e-12, area);
    for d in 0..2 {
        close(sum.first[d], area * shape.centroid()[d], 1e-12, area);
    }
    for tile in tiles {
        close(tile.size[0] * tile.size[1], tile.area, 1e-14, tile.area);
        assert_eq!(tile.size[0], tile.size[1]);
    }
}

#[test]
fn a_lattice_gives_its_tiles_back() {
    let body = shape(json!({"box": {"lower": [0.0, 0.0], "upper": [1.0, 0.5]}}));
    let tiles = fill(&body, [0.0, 0.0], [0.1, 0.1], [2, 2]);
    let points: Vec<_> = tiles.iter().map(|t| t.centre).collect();
    for (tile, cell) in tiles.iter().zip(voronoi(&body, &points).unwrap()) {
        close(cell.area, tile.area, 1e-12, tile.area);
        close(cell.centre[0], tile.centre[0], 1e-13, 1.0);
        close(cell.centre[1], tile.centre[1], 1e-13, 1.0);
    }
}

#[test]
fn few_points_and_points_on_a_line_have_cells_too() {
    let disk = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    check(&disk, &[[0.3, 0.1]]);
    check(&disk, &[[0.3, 0.1], [-0.5, 0.2]]);
    check(&disk, &[[0.0, 0.1], [0.0, 0.9], [0.0, -0.4], [0.0, 0.5]]);
    check(&disk, &[[0.1, 0.1], [0.3, 0.3], [-0.2, -0.2]]);
    assert_eq!(voronoi(&disk, &[]), Ok(Vec::new()));
    // centroids of half disks are at 4 r/(3 pi)
    let halves = voronoi(&disk, &[[0.1, 0.0], [-0.1, 0.0]]).unwrap();
    close(halves[0].centre[0], 4.0 / (3.0 * std::f64::consts::PI), 1e-14, 1.0);
    close(halves[0].area, 0.5 * std::f64::consts::PI, 1e-14, 1.0);
}

#[test]
fn points_outside_or_doubled_are_named() {
    let fault = |points: &[[f64; 2]]| voronoi(&ring(), points).unwrap_err().to_string();
    let [a, b] = [[-0.5, 0.0], [0.0, 0.6]];
    let text = "point 2 at [0.0, 0.0]: outside of the region; allowed: points within it";
    assert_eq!(fault(&[a, [0.0, 0.0], b]), text);
    let text = "point 4 at [-0.5, 0.0]: the place of point 1; allowed: a place of its own";
    assert_eq!(fault(&[a, b, [0.0, -0.6], a]), text);
    assert_eq!(fault(&[a, b, [0.0, -0.6], [-0.5, -0.0]]), text.replace("0.0]", "-0.0]"));
    assert!(fault(&[a, b, [-0.5, 1e-9], [0.0, -0.6]]).starts_with("point 3 at"));
    let text = "point 3 at [-0.5, 1e-17]: the place of point 1; allowed: a place of its own";
    assert_eq!(fault(&[a, b, [-0.5, 1e-17], [0.0, -0.6]]), text);
    assert!(fault(&[a, [f64::NAN, 0.0]]).starts_with("point 2"));
}

#[test]
fn a_line_is_shared_at_the_middles() {
    let cells = voronoi_line(0.0, 1.0, &[0.7, 0.1, 0.3]).unwrap();
    for (found, exact) in cells.iter().zip([(0.75, 0.5), (0.1, 0.2), (0.35, 0.3)]) {
        close(found.0, exact.0, 1e-15, 1.0);
        close(found.1, exact.1, 1e-15, 1.0);
    }
    assert_eq!(voronoi_line(0.0, 2.0, &[0.5]), Ok(vec![(1.0, 2.0)]));
    assert_eq!(voronoi_line(0.0, 2.0, &[]), Ok(Vec::new()));
    let fault = |points: &[f64]| voronoi_line(0.0, 1.0, points).unwrap_err().to_string();
    assert_eq!(fault(&[0.5, 1.5]), "point 2 at [1.5]: outside of the body; allowed: 0.0 to 1.0");
    assert_eq!(
        fault(&[0.5, 0.1, 0.5]),
        "point 3 at [0.5]: the place of point 1; allowed: a place of its own"
    );
    assert!(fault(&[f64::NAN]).starts_with("point 1"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn cells_of_random_points_tile_the_shape(
        points in prop::collection::vec((-1.0..1.0, -1.0..1.0), 1..200)
    ) {
        let ring = ring();
        let points: Vec<[f64; 2]> =
            points.into_iter().map(|(x, y)| [x, y]).filter(|p| ring.contains(*p)).collect();
        prop_assume!(!points.is_empty());
        check(&ring, &points);
    }

    #[test]
    fn cells_of_a_shaken_lattice_tile_the_shape(
        shifts in prop::collection::vec((-0.3..0.3, -0.3..0.3), 400)
    ) {
        let body = shape(json!({"box": {"lower": [0.0, 0.0], "upper": [20.0, 20.0]}}));
        let place = |(k, (x, y)): (usize, &(f64, f64))| {
            [(k % 20) as f64 + 0.5 + x, (k / 20) as f64 + 0.5 + y]
        };
        let points: Vec<_> = shifts.iter().enumerate().map(place).collect();
        check(&body, &points);
        let tiles = voronoi(&body, &points).unwrap();
        // each cell contains all points within 0.2, half the least distance between two points
        prop_assert!(tiles.iter().all(|t| t.area > 0.04 && t.area < 4.0));
    }
}
