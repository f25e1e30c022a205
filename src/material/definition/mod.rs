//! The definition of a material in a scene: density, equation of state, and its responses beside that.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod response;

pub use response::*;

/// A material.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density at rest [kg/m3]; what else bounds it follows from the equation of state.
    #[schemars(extend("exclusiveMinimum" = 0.0, "minimum" = 0.0, "maximum" = f64::MAX))]
    pub density: f64,
    /// Equation of state.
    pub eos: Eos,
    /// What it bears of shear, beside a fluid's equation of state; absent: nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
    /// When it fails, to bear neither tension nor shear any more; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// When its particles are taken out of the run; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub erosion: Option<Erosion>,
    /// Its temperature; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// Where the constants come from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
}

impl Material {
    /// v/v_solid at the start [-]: 1 of all but porous solids.
    pub fn distension(&self) -> f64 {
        match self.eos {
            Eos::PAlpha { solid_density, .. } => solid_density / self.density,
            _ => 1.0,
        }
    }

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

/// Where a material comes from, in the JSON schema alone: reading a scene makes it whole.
#[derive(JsonSchema)]
#[serde(untagged)]
pub enum MaterialSource {
    /// The material itself.
    Whole(Box<Material>),
    /// One of the library, by its name; keys beside it override.
    Library {
        /// Its name.
        library: String,
    },
    /// One in a file beside the scene's; keys beside it override.
    File {
        /// Path of the file from the scene's folder.
        file: String,
    },
}

/// Equations of state by type.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Eos {
    /// Mie-Grueneisen solid about the Hugoniot Us = c0 + s up + s2 up^2.
    MieGruneisen {
        /// Bulk sound speed at rest [m/s].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        c0: f64,
        /// Slope of the Us-up curve [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        s: f64,
        /// Curvature of the Us-up curve [s/m].
        #[serde(default, skip_serializing_if = "is_zero")]
        s2: f64,
        /// Grueneisen coefficient at rest [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        gamma0: f64,
        /// What of the Grueneisen coefficient is constant.
        #[serde(default, skip_serializing_if = "Gruneisen::is_default")]
        gruneisen: Gruneisen,
        /// Greatest tension that is borne [Pa]; absent: all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0.0))]
        tension_cutoff: Option<f64>,
    },
    /// Ideal gas, p = (gamma - 1) rho e.
    IdealGas {
        /// Ratio of specific heats [-].
        #[schemars(extend("exclusiveMinimum" = 1.0))]
        gamma: f64,
    },
    /// Stiffened gas, p = (gamma - 1) rho e + gamma stiffness (rho/rho0 - 1).
    StiffenedGas {
        /// Its gamma [-].
        #[schemars(extend("exclusiveMinimum" = 1.0))]
        gamma: f64,
        /// Its cohesion p_inf [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stiffness: f64,
        /// Greatest tension that is borne [Pa]; absent: up to the stiffness.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0.0))]
        tension_cutoff: Option<f64>,
    },
    /// Tait's equation in Murnaghan's form, p = K0/n ((rho/rho0)^n - 1).
    Tait {
        /// Bulk modulus at rest K0 [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        bulk_modulus: f64,
        /// Exponent n, the modulus' derivative by pressure [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        exponent: f64,
        /// Greatest tension that is borne [Pa]; absent: up to K0/n.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0.0))]
        tension_cutoff: Option<f64>,
    },
    /// Tillotson's equation of state, from cold compression to vapour.
    Tillotson {
        /// a [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        a: f64,
        /// b [-].
        #[schemars(extend("minimum" = 0.0))]
        b: f64,
        /// A, the bulk modulus at rest [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        bulk_modulus: f64,
        /// B [Pa].
        #[schemars(extend("minimum" = 0.0))]
        second_modulus: f64,
        /// alpha, how fast cohesion fades in expansion [-].
        #[schemars(extend("minimum" = 0.0))]
        alpha: f64,
        /// beta, likewise [-].
        #[schemars(extend("minimum" = 0.0))]
        beta: f64,
        /// e0, where the thermal part changes [J/kg].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        e0: f64,
        /// Energy of incipient vaporization [J/kg].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        e_iv: f64,
        /// Energy of complete vaporization [J/kg], above e_iv.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        e_cv: f64,
        /// Greatest tension that is borne [Pa]; absent: all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0.0))]
        tension_cutoff: Option<f64>,
    },
    /// Products of an explosive, the equation of Jones, Wilkins and Lee; the density is that of
    /// the explosive.
    Jwl {
        /// A [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        a: f64,
        /// B [Pa].
        b: f64,
        /// R1 [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        r1: f64,
        /// R2 [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        r2: f64,
        /// Omega [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        omega: f64,
        /// Energy of detonation per volume of the explosive E0 [J/m3].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        energy: f64,
        /// How it burns.
        burn: Burn,
    },
    /// Porous solid that crushes, the p-alpha model; the density is that with its pores.
    PAlpha {
        /// Equation of state of the solid without pores.
        solid: Box<Eos>,
        /// Density of the solid without pores at rest [kg/m3], above the material's density.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        solid_density: f64,
        /// Pressure at which pores begin to close [Pa].
        #[schemars(extend("minimum" = 0.0))]
        elastic_pressure: f64,
        /// Pressure at which all pores are closed [Pa], above the elastic one.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        compaction_pressure: f64,
    },
    /// A table of pressures over densities and specific internal energies.
    Tabular {
        /// The table.
        table: TableSource,
        /// Greatest tension that is borne [Pa]; absent: all that the table has.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0.0))]
        tension_cutoff: Option<f64>,
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

    /// The Mie-Grueneisen material of a straight Us-up line, Gamma rho constant and any tension,
    /// which the exact solutions of impacts are made for; `None` of all others.
    pub fn straight(&self, density: f64) -> Option<crate::material::MieGruneisen> {
        let &Eos::MieGruneisen { c0, s, s2, gamma0, gruneisen, tension_cutoff: None } = self else {
            return None;
        };
        let straight = s2 == 0.0 && gruneisen.is_default();
        let rho0 = density;
        straight.then_some(crate::material::MieGruneisen { rho0, c0, s, gamma0 })
    }

    /// How it burns, of an explosive.
    pub fn burn(&self) -> Option<&Burn> {
        if let Eos::Jwl { burn, .. } = self { Some(burn) } else { None }
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// What of the Grueneisen coefficient Gamma is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gruneisen {
    /// Gamma rho.
    #[default]
    GammaRhoConstant,
    /// Gamma itself.
    GammaConstant,
}

impl Gruneisen {
    fn is_default(&self) -> bool {
        *self == Gruneisen::default()
    }
}

/// How an explosive burns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Burn {
    /// A front that passes through it.
    Front(BurnFront),
    /// All at once.
    Whole(BurnWhole),
}

/// An explosive without a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BurnWhole {
    /// All has burnt before the start.
    Complete,
}

/// A burning front, from points or from a plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnFront {
    /// Points that it spreads from [m]; each place is lit from the nearest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub points: Option<Vec<Vec<f64>>>,
    /// The plane that it starts from, to both sides, instead of points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<BurnPlane>,
    /// Its speed through the explosive where that lies at the start [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub detonation_velocity: f64,
    /// Length over which the burnt fraction grows from 0 to 1 behind it [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub width: f64,
    /// When it starts [s].
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0))]
    pub start: f64,
    /// Whether compression burns too: the fraction is at least (1 - V)/(1 - V_CJ).
    #[serde(default)]
    pub compression: bool,
}

/// A plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnPlane {
    /// A point of it [m].
    pub point: Vec<f64>,
    /// Its normal, of any length.
    pub normal: Vec<f64>,
}

impl Burn {
    /// The front, unless all has burnt.
    pub fn front(&self) -> Option<&BurnFront> {
        if let Burn::Front(front) = self { Some(front) } else { None }
    }
}

/// A table of p(rho, e).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum TableSource {
    /// A CSV file of columns density, specific_internal_energy and pressure, beside the scene's
    /// file.
    File(String),
    /// The table itself.
    Values(TableValues),
}

/// A rectangular table of pressures.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableValues {
    /// Densities [kg/m3], ascending.
    pub density: Vec<f64>,
    /// Specific internal energies [J/kg], ascending.
    pub specific_internal_energy: Vec<f64>,
    /// Pressures [Pa]: for each density a row along the energies.
    pub pressure: Vec<Vec<f64>>,
}
