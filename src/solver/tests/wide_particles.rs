//! Patches in which a few particles reach more nodes than vectors hold.

use serde_json::json;

use super::fixture::Fixture;

/// First node, values and gradients of a particle.
type Weights = (u32, Vec<f64>, [Vec<f64>; 2]);

/// The first four lines of the first four nodes of a particle's window of `K` nodes; all others are
/// zero.
fn narrow<const K: usize>(f: &Fixture<2>, particle: usize) -> Weights {
    let weights = f.patch.stencils.particle::<K, 2>(particle);
    let part = |lines: &[[f64; K]]| {
        let beyond = |l: usize, k: usize| l >= 4 || k >= 4;
        for (l, line) in lines.iter().enumerate() {
            assert!((0..K).all(|k| !beyond(l, k) || line[k] == 0.0), "line {l}: {line:?}");
        }
        lines[..4].iter().flat_map(|line| line[..4].to_vec()).collect()
    };
    let gradients = [0, 1].map(|a| part(weights.gradient(a)));
    (f.patch.stencils.first[particle], part(weights.values), gradients)
}

/// Twelve particles in three cells, some of them sheared, after the nodal sums of a step; the particle
/// `long`, if any, is stretched five times along x.
fn stretched(long: Option<usize>) -> Fixture<2> {
    let mut f = Fixture::<2>::new(json!({
        "method": {
            "shape": "cpdi_bspline_quadratic",
            "transfer": {"fmpm": 4},
            "stepping": "midpoint",
            "energy": "compatible",
            "pressure_relaxation": {"rate": 0.1, "interval": 1},
        },
        "bodies": [{
            "name": "body",
            "material": "fluid",
            "box": {"lower": [3.0, 3.0], "upper": [6.0, 4.0]},
            "particles_per_cell": [2, 2],
        }],
    }));
    let stretch = |r: usize| if Some(r) == long { 5.0 } else { 1.0 + 0.02 * r as f64 };
    let xx: Vec<f64> = (0..12).map(stretch).collect();
    let xy: Vec<f64> = (0..12).map(|r| 0.01 * (r % 5) as f64).collect();
    f.set("deformation_xx", &xx).set("deformation_xy", &xy).set("jacobian_mid", &xx);
    let velocity: Vec<f64> = (0..12).map(|r| 1.0 + 0.3 * r as f64).collect();
    f.set("velocity_x", &velocity);
    f.scatter(0.1);
    f
}

#[test]
fn others_have_the_weights_of_a_patch_without_wide_particles() {
    let plain = stretched(None);
    assert_eq!(plain.patch.stencils.width, 4);
    for long in [0, 5, 11] {
        let wide = stretched(Some(long));
        assert_eq!(wide.patch.stencils.width, 6);
        let flags: Vec<bool> = (0..12).map(|r| r != long).collect();
        assert_eq!(wide.patch.stencils.narrow, flags);
        // four particles together, and the rest one after the other, may begin at another node
        for r in (0..12).filter(|&r| r / 4 != long / 4) {
            let (first, values, gradients) = narrow::<6>(&wide, r);
            let expected = narrow::<4>(&plain, r);
            let rows =
                |first: u32, stride: usize| (first as usize / stride, first as usize % stride);
            let lower = |f: &Fixture<2>| f.patch.nodes.nodes.lower;
            let node = |f: &Fixture<2>, first: u32| {
                let (y, x) = rows(first, f.patch.stencils.stride);
                [x as i64 + lower(f)[0], y as i64 + lower(f)[1]]
            };
            assert_eq!(node(&wide, first), node(&plain, expected.0), "particle {r}");
            assert_eq!((values, gradients), (expected.1, expected.2), "particle {r}");
        }
    }
}

#[test]
fn nodes_far_from_a_wide_particle_have_the_same_sums() {
    let (plain, wide) = (stretched(None), stretched(Some(11)));
    // nodes that the particles of the first cell alone reach
    for y in 2..=5 {
        for field in ["mass", "lumped_velocity_x", "acceleration_x"] {
            let at = |f: &Fixture<2>| f.node(field, [2, y]).to_bits();
            assert_eq!(at(&wide), at(&plain), "{field} at {y}");
        }
        assert!(y > 4 || wide.node("mass", [2, y]) > 0.0);
    }
}
