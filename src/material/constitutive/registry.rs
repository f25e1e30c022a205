//! The table of materials: one line a model.

use super::general::Implicit;
use super::solid::Loops;
use super::{Matter, Point};
use crate::material::definition::{Burn, Eos, Gruneisen, Material, TableSource};
use crate::material::{
    Burning, Cutoff, EquationOfState, GeneralCutoff, GeneralEos, Hencky, HistoryEos, IdealGas, Jwl,
    Lame, MieGruneisen, NeoHookean, Porous, QuadraticMieGruneisen, StiffenedGas, Table, Tabular,
    Tait, Tillotson,
};

/// What is made of an equation of state without a history: the model stays known to the compiler.
trait PlainMaker {
    type Made;

    /// Of one that is linear in e.
    fn linear<E: EquationOfState>(self, eos: E) -> Self::Made;

    /// Of one of any form.
    fn general<E: GeneralEos>(self, eos: E) -> Self::Made;
}

/// The same of any equation of state.
trait Maker: PlainMaker {
    /// Of one with a history.
    fn history<E: HistoryEos>(self, eos: E) -> Self::Made;
}

/// What `maker` makes of a fluid's equation of state; `None` of an elastic solid's, or of pores in
/// what is no plain solid.
///
/// # Errors
///
/// What is wrong with a table.
fn make<M: Maker>(eos: &Eos, rho0: f64, maker: M) -> Result<Option<M::Made>, String> {
    match *eos {
        Eos::Jwl { burn: Burn::Front(ref front), .. } => {
            let products = products(eos, rho0).expect("it is one");
            let detonation_velocity = front.detonation_velocity;
            Ok(Some(maker.history(Burning { products, detonation_velocity })))
        }
        Eos::PAlpha { ref solid, solid_density, elastic_pressure, compaction_pressure } => {
            let distension = solid_density / rho0;
            let pores = Pores { maker, distension, elastic_pressure, compaction_pressure };
            make_plain(solid, solid_density, pores)
        }
        _ => make_plain(eos, rho0, maker),
    }
}

/// The same of one without a history.
fn make_plain<M: PlainMaker>(eos: &Eos, rho0: f64, maker: M) -> Result<Option<M::Made>, String> {
    fn limited<M: PlainMaker, E: EquationOfState>(
        maker: M,
        eos: E,
        cutoff: Option<f64>,
    ) -> M::Made {
        match cutoff {
            None => maker.linear(eos),
            Some(tension) => maker.linear(Cutoff { eos, tension }),
        }
    }
    fn general<M: PlainMaker, E: GeneralEos>(maker: M, eos: E, cutoff: Option<f64>) -> M::Made {
        match cutoff {
            None => maker.general(eos),
            Some(tension) => maker.general(GeneralCutoff::new(eos, tension)),
        }
    }
    Ok(Some(match eos {
        &Eos::MieGruneisen { c0, s, s2, gamma0, gruneisen, tension_cutoff } => {
            if s2 == 0.0 && gruneisen == Gruneisen::GammaRhoConstant {
                limited(maker, MieGruneisen { rho0, c0, s, gamma0 }, tension_cutoff)
            } else {
                let gamma_constant = gruneisen == Gruneisen::GammaConstant;
                let eos = QuadraticMieGruneisen { rho0, c0, s, s2, gamma0, gamma_constant };
                limited(maker, eos, tension_cutoff)
            }
        }
        &Eos::IdealGas { gamma } => maker.linear(IdealGas { rho0, gamma }),
        &Eos::StiffenedGas { gamma, stiffness, tension_cutoff } => {
            limited(maker, StiffenedGas { rho0, gamma, stiffness }, tension_cutoff)
        }
        &Eos::Tait { bulk_modulus, exponent, tension_cutoff } => {
            limited(maker, Tait { rho0, bulk_modulus, exponent }, tension_cutoff)
        }
        &Eos::Tillotson {
            a,
            b,
            bulk_modulus,
            second_modulus,
            alpha,
            beta,
            e0,
            e_iv,
            e_cv,
            tension_cutoff,
        } => {
            let eos =
                Tillotson { rho0, a, b, bulk_modulus, second_modulus, alpha, beta, e0, e_iv, e_cv };
            general(maker, eos, tension_cutoff)
        }
        Eos::Jwl { burn: Burn::Whole(_), .. } => {
            maker.linear(products(eos, rho0).expect("it is one"))
        }
        Eos::Tabular { table, tension_cutoff } => {
            let TableSource::Values(values) = table else {
                return Err("its file has not been read".into());
            };
            let table = Table {
                density: values.density.clone(),
                energy: values.specific_internal_energy.clone(),
                pressure: values.pressure.clone(),
            };
            let eos = Tabular::new(rho0, &table, tension_cutoff.unwrap_or(f64::INFINITY))?;
            general(maker, eos, *tension_cutoff)
        }
        Eos::Jwl { .. } | Eos::PAlpha { .. } => return Ok(None),
        Eos::LinearElastic { .. } | Eos::NeoHookean { .. } => return Ok(None),
    }))
}

/// The products of an explosive of density `rho0`.
pub fn products(eos: &Eos, rho0: f64) -> Option<Jwl> {
    let &Eos::Jwl { a, b, r1, r2, omega, energy, .. } = eos else { return None };
    Some(Jwl { rho0, a, b, r1, r2, omega, energy })
}

/// Puts pores into a solid.
struct Pores<M> {
    maker: M,
    distension: f64,
    elastic_pressure: f64,
    compaction_pressure: f64,
}

impl<M: Maker> Pores<M> {
    fn over<E: GeneralEos>(self, solid: E) -> M::Made {
        let Pores { maker, distension, elastic_pressure, compaction_pressure } = self;
        maker.history(Porous { solid, distension, elastic_pressure, compaction_pressure })
    }
}

impl<M: Maker> PlainMaker for Pores<M> {
    type Made = M::Made;

    fn linear<E: EquationOfState>(self, eos: E) -> Self::Made {
        self.over(eos)
    }

    fn general<E: GeneralEos>(self, eos: E) -> Self::Made {
        self.over(eos)
    }
}

/// Makes what the step calls.
struct ForStep;

impl PlainMaker for ForStep {
    type Made = Matter;

    fn linear<E: EquationOfState>(self, eos: E) -> Matter {
        Matter::Fluid(Box::new(Point(eos)))
    }

    fn general<E: GeneralEos>(self, eos: E) -> Matter {
        Matter::Fluid(Box::new(Implicit(eos)))
    }
}

impl Maker for ForStep {
    fn history<E: HistoryEos>(self, eos: E) -> Matter {
        Matter::Fluid(Box::new(Implicit(eos)))
    }
}

/// Makes what exact solutions look at.
struct Boxed;

impl PlainMaker for Boxed {
    type Made = Box<dyn HistoryEos>;

    fn linear<E: EquationOfState>(self, eos: E) -> Self::Made {
        Box::new(eos)
    }

    fn general<E: GeneralEos>(self, eos: E) -> Self::Made {
        Box::new(eos)
    }
}

impl Maker for Boxed {
    fn history<E: HistoryEos>(self, eos: E) -> Self::Made {
        Box::new(eos)
    }
}

/// The equation of state of a material; `None` of an elastic solid, which has none, and of pores in
/// what is no plain solid.
///
/// # Errors
///
/// What is wrong with a table.
pub fn equation(material: &Material) -> Result<Option<Box<dyn HistoryEos>>, String> {
    make(&material.eos, material.density, Boxed)
}

/// The model of a material of a scene that has passed its check.
pub fn build(material: &Material) -> Matter {
    let rho0 = material.density;
    match material.eos {
        Eos::LinearElastic { youngs_modulus, poissons_ratio } => {
            let lame = Lame::new(youngs_modulus, poissons_ratio);
            Matter::Solid(Box::new(Loops(Hencky { rho0, lame })))
        }
        Eos::NeoHookean { youngs_modulus, poissons_ratio } => {
            let lame = Lame::new(youngs_modulus, poissons_ratio);
            Matter::Solid(Box::new(Loops(NeoHookean { rho0, lame })))
        }
        ref eos => make(eos, rho0, ForStep)
            .ok()
            .flatten()
            .expect("the check has refused what makes no fluid"),
    }
}
