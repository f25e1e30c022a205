//! Materials and bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::VelocityField;
use super::region::{Annulus, Disk, Ellipse, HalfPlane, Polygon, Region, Rotation};

/// A material.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density at rest [kg/m3].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub density: f64,
    /// Equation of state.
    pub eos: Eos,
    /// What it bears of shear, beside a fluid's equation of state; absent: nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
    /// When it fails, to bear neither tension nor shear any more; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// Its temperature; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
}

impl Material {
    /// Whether its stress is a tensor.
    pub fn bears_shear(&self) -> bool {
        self.eos.is_solid() || self.strength.is_some()
    }

    /// Whether a part of the plastic work is kept from heating it.
    pub fn stores_work(&self) -> bool {
        let stored = |t: Thermal| t.source == HeatSource::Energy && t.taylor_quinney < 1.0;
        self.strength.is_some() && self.thermal.is_some_and(stored)
    }
}

/// Models of strength by type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Strength {
    /// Von Mises' yield surface, Y = yield_stress + hardening ep.
    VonMises {
        /// Shear modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at no plastic strain [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        yield_stress: f64,
        /// Growth of the yield stress with the plastic strain [Pa].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        hardening: f64,
    },
    /// Johnson & Cook (1983), Y = (a + b ep^n)(1 + c ln max(1, rate/reference_rate))(1 - T*^m).
    JohnsonCook {
        /// Shear modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at no plastic strain [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        a: f64,
        /// Hardening [Pa].
        #[schemars(range(min = 0.0))]
        b: f64,
        /// Exponent of the plastic strain [-].
        #[schemars(range(max = 5.0), extend("exclusiveMinimum" = 0.0))]
        n: f64,
        /// Coefficient of the rate's logarithm [-].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        c: f64,
        /// Rate from which on it counts [1/s].
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        reference_rate: f64,
        /// Softening by temperature, which needs `thermal`; absent: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        softening: Option<Softening>,
    },
    /// Steinberg, Cochran & Guinan (1980), for high rates.
    SteinbergGuinan {
        /// Shear modulus at rest [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at rest [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        yield_stress: f64,
        /// Hardening [-].
        #[schemars(range(min = 0.0))]
        beta: f64,
        /// Its exponent [-].
        #[schemars(range(min = 0.0, max = 5.0))]
        n: f64,
        /// Plastic strain at the start [-].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        initial_strain: f64,
        /// Most that hardening reaches [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        max_yield_stress: f64,
        /// Growth of both moduli with pressure, A = G'p/G0 [1/Pa].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        pressure_hardening: f64,
        /// Fall of both moduli with temperature above 300 K, B = -G'T/G0 [1/K], which needs
        /// `thermal`; absent: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        temperature_softening: Option<f64>,
    },
}

/// Softening by temperature, 1 - T*^m with T* = (T - reference)/(melt - reference).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Softening {
    /// Exponent [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub m: f64,
    /// Temperature below which there is none [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// Melting temperature [K].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub melt_temperature: f64,
}

/// Models of failure by type. What fails bears neither tension nor shear from then on; its elastic
/// energy stays with it as heat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Failure {
    /// At once at a tension.
    TensionLimit {
        /// The tension [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stress: f64,
        /// What must reach it.
        #[serde(default)]
        measure: TensionMeasure,
    },
    /// Johnson & Cook (1985): by the sum of plastic strain over the strain at fracture, (d1 + d2
    /// exp(d3 s*))(1 + d4 ln max(1, rate/reference_rate))(1 + d5 T*); needs `strength`.
    JohnsonCook {
        /// Strain at fracture, constant part [-].
        #[serde(default)]
        d1: f64,
        /// Strain at fracture, part that depends on the triaxiality [-].
        #[serde(default)]
        d2: f64,
        /// Its exponent [-].
        #[serde(default)]
        d3: f64,
        /// Coefficient of the rate's logarithm [-].
        #[serde(default)]
        d4: f64,
        /// Coefficient of the temperature, which needs `thermal` and the strength's `softening` [-].
        #[serde(default)]
        d5: f64,
        /// Rate from which on it counts [1/s].
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        reference_rate: f64,
    },
}

/// What must reach a tension limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TensionMeasure {
    /// The greatest principal stress.
    #[default]
    PrincipalStress,
    /// The mean of the stresses, minus the pressure.
    MeanStress,
}

/// The temperature of a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Specific heat cv [J/(kg K)].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub specific_heat: f64,
    /// Temperature at rest [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// What the temperature follows from.
    #[serde(default)]
    pub source: HeatSource,
    /// Share of the plastic work that heats (Taylor & Quinney 1934) [-].
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub taylor_quinney: f64,
    /// Thermal conductivity [W/(m K)]; absent: no heat is conducted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub conductivity: Option<f64>,
}

/// What a temperature follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeatSource {
    /// The internal energy, about the isentrope of the equation of state.
    #[default]
    Energy,
    /// The plastic work alone.
    PlasticWork,
}

fn one() -> f64 {
    1.0
}

/// Equations of state by type.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Eos {
    /// Mie-Grueneisen solid about the Hugoniot Us = c0 + s up, with gamma0 rho0 constant.
    MieGruneisen {
        /// Bulk sound speed at rest [m/s].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        c0: f64,
        /// Slope of the Us-up line [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        s: f64,
        /// Grueneisen coefficient at rest [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        gamma0: f64,
    },
    /// Ideal gas, p = (gamma - 1) rho e.
    IdealGas {
        /// Ratio of specific heats [-].
        #[schemars(extend("exclusiveMinimum" = 1.0))]
        gamma: f64,
    },
    /// Elastic solid, linear in the logarithmic strain: Hooke's law where strains are small.
    LinearElastic {
        /// Young's modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        youngs_modulus: f64,
        /// Poisson's ratio [-].
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
        poissons_ratio: f64,
    },
    /// Neo-Hookean solid, sigma = (lambda ln J 1 + mu (F F^T - 1))/J.
    NeoHookean {
        /// Young's modulus where strains are small [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        youngs_modulus: f64,
        /// Poisson's ratio where strains are small [-].
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
        poissons_ratio: f64,
    },
}

impl Eos {
    /// Whether it is that of an elastic solid, which bears shear by itself.
    pub fn is_solid(&self) -> bool {
        matches!(self, Eos::LinearElastic { .. } | Eos::NeoHookean { .. })
    }
}

/// A body: a region of one material, filled with particles. Its region is one of the keys `box`,
/// `disk`, `ellipse`, `polygon`, `annulus`, `half_plane`, `union`, `difference`, `intersection`
/// and `rotation`; on a line it is a `box`.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name, unlike that of any other body.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// A box along the axes, where it lies at the start.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<BoxShape>,
    /// A disk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disk: Option<Disk>,
    /// An ellipse with its axes along x and y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipse: Option<Ellipse>,
    /// A polygon.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygon: Option<Polygon>,
    /// What lies between two circles about one centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub annulus: Option<Annulus>,
    /// One side of a straight line; alone it has no end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_plane: Option<HalfPlane>,
    /// What lies in any of several regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub union: Option<Vec<Region>>,
    /// What lies in the first of several regions and in none of the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub difference: Option<Vec<Region>>,
    /// What lies in each of several regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub intersection: Option<Vec<Region>>,
    /// A region turned about a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Rotation>,
    /// Velocity at the start [m/s]; absent: at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Vec<f64>>,
    /// Velocity at the start as a function of place, instead of `velocity`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_field: Option<VelocityField>,
    /// Pressure at the start [Pa], reached at the material's density by its internal energy.
    #[serde(default)]
    pub pressure: f64,
    /// Particles a cell in each direction; absent only where `positions` are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub particles_per_cell: Option<Vec<usize>>,
    /// Where the particles are at the start, instead of a lattice: each gets what of the body is
    /// nearest to it (its Voronoi cell), and stands at that cell's centroid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
}

/// Positions of particles.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Positions {
    /// A CSV file of columns x and y, beside the scene's file.
    File(String),
    /// The positions themselves [m].
    Points(Vec<Vec<f64>>),
}

impl Body {
    /// The body's regions, each with its key; a body that is sound has one.
    pub fn regions(&self) -> Vec<(&'static str, Region)> {
        let all = [
            ("box", self.extent.clone().map(Region::Box)),
            ("disk", self.disk.clone().map(Region::Disk)),
            ("ellipse", self.ellipse.clone().map(Region::Ellipse)),
            ("polygon", self.polygon.clone().map(Region::Polygon)),
            ("annulus", self.annulus.clone().map(Region::Annulus)),
            ("half_plane", self.half_plane.clone().map(Region::HalfPlane)),
            ("union", self.union.clone().map(Region::Union)),
            ("difference", self.difference.clone().map(Region::Difference)),
            ("intersection", self.intersection.clone().map(Region::Intersection)),
            ("rotation", self.rotation.clone().map(Region::Rotation)),
        ];
        all.into_iter().filter_map(|(key, region)| Some((key, region?))).collect()
    }
}

/// A box.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Lower corner [m].
    pub lower: Vec<f64>,
    /// Upper corner [m].
    pub upper: Vec<f64>,
}
