//! Equation of state from a table of p(rho, e).
//!
//! A rectangle of densities and specific internal energies, interpolated by bicubic polynomials
//! ([`Bicubic`]). Reading a table checks c^2 = dp/drho + p/rho^2 dp/de > 0, and dp/de >= 0, at the
//! nodes and at four by four places per cell. An imaginary sound speed inside the table is therefore
//! possible only between these places. States outside of the table are faults. Pressures at or
//! below minus the tension cutoff, if there is one, are not checked.
//!
//! A table is CSV text: a header with the column names `density` [kg/m3],
//! `specific_internal_energy` [J/kg] and `pressure` [Pa], in any order, then one line per node, in
//! any order. Lines that begin with `#` are skipped. Every density must have every energy.

use std::collections::BTreeMap;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bicubic::Bicubic;
use super::{EosContext, EosParameters, EosPoint, GeneralEos, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Rectangular table of p(rho, e).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Densities [kg/m3], ascending.
    pub density: Vec<f64>,
    /// Specific internal energies [J/kg], ascending.
    pub energy: Vec<f64>,
    /// Pressures [Pa]: one row along the energies per density.
    pub pressure: Vec<Vec<f64>>,
}

/// Column names.
const NAMES: [&str; 3] = ["density", "specific_internal_energy", "pressure"];

/// Integer with the same order as the finite value `v`.
fn key(v: f64) -> u64 {
    let bits = (v + 0.0).to_bits();
    if v < 0.0 { !bits } else { bits | (1 << 63) }
}

impl Table {
    /// Reads a table from CSV text.
    ///
    /// # Errors
    ///
    /// The fault, with the line or the missing node.
    pub fn read(text: &str) -> Result<Table, String> {
        let lines = (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let allowed = format!("allowed: columns {}", NAMES.join(", "));
        let (_, header) = lines.next().ok_or(format!("is empty; {allowed}"))?;
        let names: Vec<&str> = header.split(',').map(|n| n.trim().trim_matches('"')).collect();
        let mut places = [0; 3];
        for (place, name) in places.iter_mut().zip(NAMES) {
            *place = (names.iter().position(|n| *n == name))
                .ok_or(format!("line 1: no column {name} in {header:?}; {allowed}"))?;
        }
        let mut nodes: BTreeMap<u64, BTreeMap<u64, [f64; 3]>> = BTreeMap::new();
        for (line, text) in lines {
            let fields: Vec<&str> = text.split(',').map(str::trim).collect();
            let mut node = [0.0; 3];
            for (value, (place, name)) in node.iter_mut().zip(places.iter().zip(NAMES)) {
                let field = fields.get(*place).copied().unwrap_or("");
                *value = field.parse().ok().filter(|v: &f64| v.is_finite()).ok_or(format!(
                    "line {line}: {name} {field:?} is no number; allowed: finite numbers"
                ))?;
            }
            let [density, energy, _] = node;
            if nodes.entry(key(density)).or_default().insert(key(energy), node).is_some() {
                return Err(format!(
                    "line {line}: a second node at density {density}, energy {energy}; allowed: one"
                ));
            }
        }
        let mut energies: BTreeMap<u64, f64> = BTreeMap::new();
        for node in nodes.values().flat_map(|row| row.values()) {
            energies.insert(key(node[1]), node[1]);
        }
        let mut table = Table { energy: energies.values().copied().collect(), ..Table::default() };
        for row in nodes.values() {
            let density = row.values().next().map_or(0.0, |node| node[0]);
            let missing = energies.iter().find(|(key, _)| !row.contains_key(key));
            if let Some((_, energy)) = missing {
                return Err(format!(
                    "a hole: no pressure at density {density}, energy {energy}; allowed: a \
                     rectangle, every density with every energy"
                ));
            }
            table.density.push(density);
            table.pressure.push(row.values().map(|node| node[2]).collect());
        }
        Ok(table)
    }

    /// Checks that the lists are a rectangle of at least two by two nodes, ascending.
    fn check_form(&self) -> Result<(), String> {
        for (name, values) in [("densities", &self.density), ("energies", &self.energy)] {
            if values.len() < 2 {
                return Err(format!("{} {name}; allowed: at least 2", values.len()));
            }
            if let Some(w) = values.windows(2).find(|w| w[0] >= w[1]) {
                return Err(format!("{name} {} and {} in a row; allowed: ascending", w[0], w[1]));
            }
        }
        if self.density[0] <= 0.0 {
            return Err(format!("density {}; allowed: above 0", self.density[0]));
        }
        if self.pressure.len() != self.density.len() {
            let (rows, wanted) = (self.pressure.len(), self.density.len());
            return Err(format!("{rows} rows of pressure; allowed: {wanted}, one a density"));
        }
        let short = self.pressure.iter().zip(&self.density);
        if let Some((row, density)) = short.clone().find(|(r, _)| r.len() != self.energy.len()) {
            let (found, wanted) = (row.len(), self.energy.len());
            return Err(format!(
                "a hole: {found} pressures at density {density}; allowed: {wanted}, one an energy"
            ));
        }
        Ok(())
    }
}

/// Equation of state that interpolates a table.
#[derive(Clone, Debug)]
pub struct Tabular {
    rho0: f64,
    surface: Arc<Bicubic>,
    /// Energy at rest density and zero pressure [J/kg].
    first_energy: f64,
}

/// Positions in a cell, along each direction, at which the table is checked [cells].
const CHECKED: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

impl Tabular {
    /// Equation of state from `table`, for a material of density `rho0` at rest [kg/m3]; pressures
    /// at or below minus `cutoff` [Pa] are not checked.
    ///
    /// # Errors
    ///
    /// The fault of the table, and its place.
    pub fn new(rho0: f64, table: &Table, cutoff: f64) -> Result<Tabular, String> {
        table.check_form()?;
        let surface = Bicubic::new(table.density.clone(), table.energy.clone(), &table.pressure);
        let (density, energy) = (surface.x(), surface.y());
        let (least, most) = (energy[0], energy[energy.len() - 1]);
        let eos = Tabular { rho0, surface: Arc::new(surface.clone()), first_energy: 0.0 };
        let range = |v: &[f64]| format!("{} to {}", v[0], v[v.len() - 1]);
        if !surface.contains(rho0, least) {
            let range = range(density);
            return Err(format!("the material's density {rho0} lies outside of it, {range} kg/m3"));
        }
        let places = |nodes: &[f64]| -> Vec<f64> {
            let inside = nodes.windows(2).flat_map(|w| CHECKED.map(|t| w[0] + t * (w[1] - w[0])));
            inside.chain(nodes.last().copied()).collect()
        };
        for &rho in &places(density) {
            for &e in &places(energy) {
                let [p, _, by_energy] = surface.at(rho, e);
                if p <= -cutoff {
                    continue;
                }
                let c2 = eos.at(rho0 / rho, e).sound_speed_squared;
                let place = format!("at density {rho}, energy {e}");
                if c2.is_nan() || c2 <= 0.0 {
                    return Err(format!(
                        "c^2 = {c2:.4e} m2/s2 {place}; allowed: above 0 wherever pressure is \
                         above minus the tension cutoff"
                    ));
                }
                if by_energy.is_nan() || by_energy < 0.0 {
                    return Err(format!(
                        "dp/de = {by_energy:.4e} kg/m3 {place}; allowed: at least 0"
                    ));
                }
            }
        }
        let at = |e: f64| surface.at(rho0, e)[0];
        if !(at(least) <= 0.0 && at(most) >= 0.0) {
            return Err(format!(
                "no energy of it, {} J/kg, leaves the material of density {rho0} without pressure",
                range(energy)
            ));
        }
        let (mut low, mut high) = (least, most);
        // the pressure may be 0 at the lower end of the table
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if at(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Tabular { first_energy: high, ..eos })
    }
}

impl GeneralEos for Tabular {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint {
        let rho = self.rho0 / jacobian;
        let [p, by_density, by_energy] = self.surface.at(rho, energy);
        EosPoint {
            pressure: p,
            energy_slope: by_energy,
            sound_speed_squared: by_density + p / (rho * rho) * by_energy,
        }
    }

    fn check_validity(&self, jacobian: f64, energy: f64, _pressure: f64) -> Option<&'static str> {
        (!self.surface.contains(self.rho0 / jacobian, energy))
            .then_some("outside of its table of densities and energies")
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        if pressure == 0.0 {
            return self.first_energy;
        }
        let mut e = self.first_energy;
        for _ in 0..80 {
            let point = self.at(1.0, e);
            let step = (pressure - point.pressure) / point.energy_slope;
            if !step.is_finite() || step.abs() <= f64::EPSILON * e.abs() {
                break;
            }
            e += step;
        }
        e
    }
}

/// Table of pressures over densities and specific internal energies.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TabularParameters {
    /// Pressures over density and specific internal energy: the name of a file, or the lists
    /// themselves.
    pub table: TableSource,
    /// Greatest tension that the material carries [Pa]; absent: all that the table has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

/// Table of p(rho, e).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum TableSource {
    /// CSV file with the columns density, specific_internal_energy and pressure, in the folder of
    /// the scene file.
    File(String),
    /// The table itself.
    Values(TableValues),
}

/// Rectangular table of pressures.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableValues {
    /// Densities [kg/m3], ascending.
    pub density: Vec<f64>,
    /// Specific internal energies [J/kg], ascending.
    pub specific_internal_energy: Vec<f64>,
    /// Pressures [Pa]: one row along the energies per density.
    pub pressure: Vec<Vec<f64>>,
}

impl TabularParameters {
    fn eos(&self, rho0: f64) -> Result<Tabular, String> {
        let TableSource::Values(values) = &self.table else {
            return Err("its file has not been read".into());
        };
        let table = Table {
            density: values.density.clone(),
            energy: values.specific_internal_energy.clone(),
            pressure: values.pressure.clone(),
        };
        Tabular::new(rho0, &table, self.tension_cutoff.unwrap_or(f64::INFINITY))
    }
}

impl EosParameters for TabularParameters {
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        let sound = |why: String| {
            ParameterError::missing("table", format!("{why}; allowed: a table that is sound"))
        };
        self.eos(at.density).map(|_| ()).map_err(sound)
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        Ok(Some(super::limited_general(visitor, self.eos(rho0)?, self.tension_cutoff)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::general::tests::check_derivatives;
    use super::super::{EquationOfState, MieGruneisen};
    use super::*;

    const ALUMINIUM: MieGruneisen =
        MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };

    pub fn table(nodes: [usize; 2]) -> Table {
        let even = |from: f64, to: f64, n: usize| -> Vec<f64> {
            (0..n).map(|k| from + (to - from) * k as f64 / (n - 1) as f64).collect()
        };
        // a node at rest density, where the slope of the cold part has a corner
        let (density, energy) = (even(2685.0, 4685.0, nodes[0]), even(-1e5, 5e6, nodes[1]));
        let row = |rho: &f64| energy.iter().map(|&e| ALUMINIUM.pressure(2785.0 / rho, e)).collect();
        Table { pressure: density.iter().map(row).collect(), density, energy }
    }

    fn text(table: &Table) -> String {
        let mut text = "pressure, specific_internal_energy, density\n".to_string();
        for (row, rho) in table.pressure.iter().zip(&table.density) {
            for (p, e) in row.iter().zip(&table.energy) {
                text += &format!("{p}, {e}, {rho}\n");
            }
        }
        text
    }

    #[test]
    fn a_table_is_near_to_what_it_was_made_of() {
        let eos = Tabular::new(2785.0, &table([41, 11]), f64::INFINITY).unwrap();
        for (j, e) in [(0.7, 3e6), (0.89, 2.4e5), (0.97, 1e4)] {
            let (point, exact) = (eos.at(j, e), GeneralEos::at(&ALUMINIUM, j, e));
            assert!(
                (point.pressure / exact.pressure - 1.0).abs() < 3e-4,
                "{j}: {point:?} {exact:?}"
            );
            let c2 = point.sound_speed_squared / exact.sound_speed_squared;
            assert!((c2 - 1.0).abs() < 5e-3, "{j}: {c2}");
        }
        assert!(eos.energy_at(0.0).abs() < 1e-6);
        let e = eos.energy_at(1e9);
        assert!((eos.at(1.0, e).pressure / 1e9 - 1.0).abs() < 1e-12);
        check_derivatives(&eos, &[[0.71, 3e6, 0.0], [0.89, 2.4e5, 0.0]], 1e-5);
        assert!(eos.check_validity(0.5, 1e5, 0.0).unwrap().contains("outside of its table"));
        assert_eq!(eos.check_validity(0.9, 1e5, 0.0), None);
    }

    #[test]
    fn text_is_read_in_any_order() {
        let made = table([3, 4]);
        let lines = text(&made);
        let mut lines: Vec<&str> = lines.lines().collect();
        lines[1..].reverse();
        assert_eq!(Table::read(&format!("# made\n{}\n\n", lines.join("\n"))), Ok(made));
    }

    #[test]
    fn faults_of_tables_are_reported_with_their_place() {
        let refused = |text: &str, words: &[&str]| {
            let message = Table::read(text).unwrap_err();
            words.iter().for_each(|w| assert!(message.contains(w), "{message}"));
        };
        refused("", &["empty", "density"]);
        refused("density,pressure\n1,2", &["line 1", "specific_internal_energy"]);
        let head = "density,specific_internal_energy,pressure\n";
        refused(&format!("{head}1,2,x"), &["line 2", "pressure \"x\""]);
        refused(&format!("{head}1,2,3\n1,2,4"), &["line 3", "second node at density 1, energy 2"]);
        refused(&format!("{head}1,1,3\n1,2,4\n2,1,3"), &["hole", "density 2, energy 2"]);
        let refused = |edit: &dyn Fn(&mut Table), words: &[&str]| {
            let mut bad = table([5, 4]);
            edit(&mut bad);
            let message = Tabular::new(2785.0, &bad, f64::INFINITY).unwrap_err();
            words.iter().for_each(|w| assert!(message.contains(w), "{message}"));
        };
        refused(&|t| t.density.truncate(1), &["1 densities", "at least 2"]);
        refused(&|t| t.energy[1] = t.energy[0], &["energies", "ascending"]);
        refused(&|t| t.density[0] = -1.0, &["density -1", "above 0"]);
        refused(&|t| t.pressure.truncate(2), &["2 rows"]);
        refused(&|t| t.pressure[1].truncate(2), &["hole", "density 3185"]);
        refused(&|t| t.pressure[3][1] = 0.0, &["c^2", "at density"]);
        refused(&|t| t.pressure[2][2] = t.pressure[2][0], &["dp/de", "at density"]);
        refused(
            &|t| t.pressure.iter_mut().flatten().for_each(|p| *p += 2e9),
            &["without pressure"],
        );
        let message = Tabular::new(9000.0, &table([5, 4]), f64::INFINITY).unwrap_err();
        assert!(message.contains("9000") && message.contains("2685 to 4685"), "{message}");
    }
}
