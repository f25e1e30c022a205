//! Scenes of bodies in contact, on cells of 10 mm.

use serde_json::{Value, json};

/// Edge of a cell [m].
pub const CELL: f64 = 0.01;

/// A material, and the speed of its pressure waves [m/s].
#[derive(Clone, Copy, PartialEq)]
pub enum Material {
    /// Neo-Hookean rubber of 1 MPa.
    Rubber,
    /// The same with 10 MPa.
    StiffRubber,
    /// Copper without strength.
    Copper,
}

impl Material {
    fn scene(self) -> Value {
        let rubber = |modulus: f64| {
            json!({"density": 1000.0, "eos": {"type": "neo_hookean",
                "youngs_modulus": modulus, "poissons_ratio": 0.3}})
        };
        match self {
            Material::Rubber => rubber(1e6),
            Material::StiffRubber => rubber(1e7),
            Material::Copper => json!({"density": 8930.0, "eos": {"type": "mie_gruneisen",
                "c0": 3940.0, "s": 1.489, "gamma0": 1.96}}),
        }
    }

    /// Acoustic impedance rho c [Pa s/m].
    pub fn impedance(self) -> f64 {
        // rho c = sqrt(rho E (1 - nu)/((1 + nu)(1 - 2 nu)))
        let rubber = |modulus: f64| (1000.0 * modulus * 0.7 / (1.3 * 0.4)).sqrt();
        match self {
            Material::Rubber => rubber(1e6),
            Material::StiffRubber => rubber(1e7),
            Material::Copper => 8930.0 * 3940.0,
        }
    }
}

/// A vector turned by an angle.
pub fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// A box turned about the origin.
pub fn block(lower: [f64; 2], upper: [f64; 2], degrees: f64) -> Value {
    let whole = json!({"box": {"lower": lower, "upper": upper}});
    match degrees == 0.0 {
        true => whole,
        false => json!({"rotation": {"angle": degrees, "about": [0.0, 0.0], "of": whole}}),
    }
}

/// A disk around a point that is turned about the origin.
pub fn disk(centre: [f64; 2], radius: f64, degrees: f64) -> Value {
    json!({"disk": {"centre": turned(centre, degrees), "radius": radius}})
}

/// Frictionless contact, or with a coefficient of friction, with the default normals.
pub fn contact(friction: Option<f64>) -> Value {
    match friction {
        None => json!({"type": "frictionless"}),
        Some(coefficient) => json!({"type": "friction", "coefficient": coefficient}),
    }
}

/// Bodies, each a region and a velocity [m/s], in a domain that holds them with a margin.
pub fn scene(
    bodies: &[(Value, [f64; 2])],
    domain: [[f64; 2]; 2],
    material: Material,
    contact: Value,
    end: f64,
) -> Value {
    let bodies: Vec<Value> = bodies
        .iter()
        .enumerate()
        .map(|(k, (region, velocity))| {
            let mut body = region.clone();
            body["name"] = json!(format!("body {k}"));
            body["material"] = json!("material");
            body["velocity"] = json!(velocity);
            body["particles_per_cell"] = json!([2, 2]);
            body
        })
        .collect();
    let [lower, upper] = domain;
    json!({
        "title": "bodies in contact",
        "domain": {"lower": lower, "upper": upper, "cell_size": CELL},
        "time": {"end": end, "courant": 0.4},
        "method": {
            "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": true, "edge_mask": 0.3, "spin": true
        },
        "materials": {"material": material.scene()},
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"},
        "bodies": bodies,
        "contact": contact
    })
}

/// Whole cells around the corners of boxes that are turned, with a margin of four cells, shifted by
/// `shift` cells.
pub fn around(corners: &[[f64; 2]], degrees: f64, shift: f64) -> [[f64; 2]; 2] {
    let corners: Vec<_> = corners.iter().map(|&corner| turned(corner, degrees)).collect();
    let bound = |a: usize, round: fn(f64) -> f64, pick: fn(f64, f64) -> f64, margin: f64| {
        let most = corners.iter().map(|corner| corner[a]).reduce(pick).unwrap_or_default();
        (round(most / CELL - 1e-9 * margin) + margin + shift) * CELL
    };
    [
        [0, 1].map(|a| bound(a, f64::floor, f64::min, -4.0)),
        [0, 1].map(|a| bound(a, f64::ceil, f64::max, 4.0)),
    ]
}
