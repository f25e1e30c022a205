//! Material at the greatest tension that it can carry.
//!
//! Where material is at its `tension_cutoff` or has failed, it separates at single particles. The
//! place and the time depend on the cell size, and runs with different cells can have different
//! waves from then on, although runs with larger cells still agree.

use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Factor on the half-widths of profiles in which material separates \[-\], chosen on random scenes.
const WIDENING: f64 = 10.0;

/// Share of the greatest tension from which a material counts as separating \[-\].
const AT_CUTOFF: f64 = 0.99;

/// Factor on the half-width of each profile: above 1 if any material separates in it or in an earlier
/// one.
pub(super) fn widening(scene: &CheckedScene, tables: &[&ParticleTable]) -> Vec<f64> {
    let first = tables.iter().position(|table| separates(scene, table)).unwrap_or(tables.len());
    (0..tables.len()).map(|k| if k < first { 1.0 } else { WIDENING }).collect()
}

/// Whether any material is at its greatest tension or has failed.
fn separates(scene: &CheckedScene, table: &ParticleTable) -> bool {
    let cutoffs: Vec<Option<f64>> = (0..scene.bodies.len()).map(|b| cutoff(scene, b)).collect();
    let pressure = table.column("pressure").unwrap_or_default();
    let is_at_cutoff = |(&body, &p): (&u32, &f64)| {
        cutoffs[body as usize].is_some_and(|cutoff| p <= -AT_CUTOFF * cutoff)
    };
    let failed = table.column("failed").is_some_and(|all| all.iter().any(|failed| *failed > 0.0));
    failed || table.body.iter().zip(pressure).any(is_at_cutoff)
}

/// The `tension_cutoff` of the material of a body \[Pa\], if its equation of state has one above 0.
fn cutoff(scene: &CheckedScene, body: usize) -> Option<f64> {
    let eos = serde_json::to_value(&scene.material_of(body).eos).ok()?;
    eos["tension_cutoff"].as_f64().filter(|cutoff| *cutoff > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;
    use crate::simulation::TableColumn;

    #[test]
    fn material_at_its_cutoff_and_failed_material_separate() {
        let mut scene = crate::accuracy::plan::standard();
        scene["materials"]["aluminium"]["eos"]["tension_cutoff"] = serde_json::json!(2e9);
        scene.as_object_mut().unwrap().remove("reference");
        let scene = input::parse(scene.to_string().as_bytes(), "flyer.json", &[]).unwrap();
        let table = |body: u32, pressure: f64, failed: f64| ParticleTable {
            time: 0.0,
            dimension: 1,
            ids: vec![0],
            material: vec![0],
            materials: Vec::new(),
            body: vec![body],
            columns: [("pressure", pressure), ("failed", failed)]
                .map(|(name, value)| TableColumn {
                    name: name.into(),
                    unit: String::new(),
                    values: vec![value],
                })
                .into(),
            half_edges: Vec::new(),
        };
        // the flyer has no cutoff
        let [below, at, other] =
            [table(1, -1.9e9, 0.0), table(1, -2e9, 0.0), table(0, -2e9, 0.0)];
        assert_eq!(widening(&scene, &[&below, &other, &at]), [1.0, 1.0, WIDENING]);
        assert_eq!(widening(&scene, &[&at, &below]), [WIDENING, WIDENING]);
        assert_eq!(widening(&scene, &[&table(0, 0.0, 1.0)]), [WIDENING]);
    }
}
