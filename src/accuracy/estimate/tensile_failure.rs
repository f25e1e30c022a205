//! Material that fails in tension.
//!
//! The place and the time of tensile failure depend on the cell size. Runs with different cells can
//! therefore differ afterwards, even if the coarse runs agree with each other.

use crate::material::failure::DAMAGE;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Factor on the half-widths of profiles in which material fails, and of later ones \[-\], chosen on
/// random scenes.
const FACTOR: f64 = 10.0;

/// Factor on the half-widths of histories of a run in which material fails in a profile \[-\], chosen
/// on random scenes. It is smaller than [`FACTOR`], since a history also has the time before the
/// failure.
const FACTOR_OF_HISTORIES: f64 = 2.0;

/// Share of the greatest tension from which a material counts as failing \[-\].
const AT_CUTOFF: f64 = 0.99;

/// Damage from which a particle, or the mean over a block of particles, counts as failed \[-\].
const FAILED: f64 = 0.5;

/// Factor on the half-width of each profile: above 1 if any material fails in it or in an earlier one.
pub fn factors(scene: &CheckedScene, tables: &[&ParticleTable]) -> Vec<f64> {
    let first = tables.iter().position(|table| fails(scene, table)).unwrap_or(tables.len());
    (0..tables.len()).map(|k| if k < first { 1.0 } else { FACTOR }).collect()
}

/// Factor on the half-widths of histories: above 1 if material fails in any profile.
pub fn factor_of_histories(profiles: &[f64]) -> f64 {
    if profiles.iter().any(|factor| *factor > 1.0) { FACTOR_OF_HISTORIES } else { 1.0 }
}

/// Whether any material is at its `tension_cutoff` or has failed.
fn fails(scene: &CheckedScene, table: &ParticleTable) -> bool {
    let cutoff = |body| scene.material_of(body).tension_cutoff().filter(|cutoff| *cutoff > 0.0);
    let cutoffs: Vec<Option<f64>> = (0..scene.bodies.len()).map(cutoff).collect();
    let pressure = table.column("pressure").unwrap_or_default();
    // the cutoff holds for the pressure of the solid, which is p times the distension
    // (Carroll & Holt 1972)
    let distension = table.column("distension");
    let is_at_cutoff = |row: usize| {
        let solid = pressure[row] * distension.map_or(1.0, |alpha| alpha[row]);
        cutoffs[table.body[row] as usize].is_some_and(|cutoff| solid <= -AT_CUTOFF * cutoff)
    };
    let has_failed = table.column(DAMAGE).is_some_and(|all| all.iter().any(|d| *d >= FAILED));
    has_failed || (0..pressure.len()).any(is_at_cutoff)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;
    use crate::simulation::TableColumn;

    #[test]
    fn material_at_its_cutoff_and_failed_material_widen_the_intervals() {
        let mut scene = crate::accuracy::plan::standard();
        scene["materials"]["aluminium"]["eos"]["tension_cutoff"] = serde_json::json!(2e9);
        scene.as_object_mut().unwrap().remove("reference");
        let scene = input::parse(scene.to_string().as_bytes(), "flyer.json", &[]).unwrap();
        let porous = |body: u32, pressure: f64, failed: f64, distension: f64| ParticleTable {
            time: 0.0,
            dimension: 1,
            ids: vec![0],
            material: vec![0],
            materials: Vec::new(),
            body: vec![body],
            columns: [("pressure", pressure), (DAMAGE, failed), ("distension", distension)]
                .map(|(name, value)| TableColumn {
                    name: name.into(),
                    unit: String::new(),
                    values: vec![value],
                })
                .into(),
            half_edges: Vec::new(),
        };
        let table = |body: u32, pressure: f64, failed: f64| porous(body, pressure, failed, 1.0);
        // the flyer has no cutoff
        let [below, at, other] = [table(1, -1.9e9, 0.0), table(1, -2e9, 0.0), table(0, -2e9, 0.0)];
        assert_eq!(factors(&scene, &[&below, &other, &at]), [1.0, 1.0, FACTOR]);
        assert_eq!(factors(&scene, &[&at, &below]), [FACTOR, FACTOR]);
        assert_eq!(factor_of_histories(&[1.0, FACTOR]), FACTOR_OF_HISTORIES);
        assert_eq!(factor_of_histories(&[1.0, 1.0]), 1.0);
        assert_eq!(factors(&scene, &[&table(0, 0.0, 1.0)]), [FACTOR]);
        assert_eq!(factors(&scene, &[&porous(1, -1e9, 0.0, 1.9)]), [1.0]);
        assert_eq!(factors(&scene, &[&porous(1, -1e9, 0.0, 2.0)]), [FACTOR]);
    }
}
