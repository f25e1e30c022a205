//! The impact of Burghardt (2010): pictures of other scenes do not have the numbers of its figures.

use crate::exact::Impact;

/// Closing speed [m/s] and thickness of the flyer [m] in section 2 of Burghardt (2010).
const SPEED: f64 = 1000.0;
const THICKNESS: f64 = 0.5e-3;

/// Bulk sound speed c0 [m/s] and slope s [-] of copper and aluminium, from the same section.
const COPPER: [f64; 2] = [3940.0, 1.489];
const ALUMINIUM: [f64; 2] = [5386.0, 1.339];

/// Whether this is the impact of Burghardt (2010): his two materials, speed and flyer.
pub fn is_burghardts(impact: &Impact) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b;
    let is = |material: crate::material::MieGruneisen, [c0, s]: [f64; 2]| {
        near(material.c0, c0) && near(material.s, s)
    };
    is(impact.flyer.material, COPPER)
        && is(impact.target.material, ALUMINIUM)
        && near(impact.speed, SPEED)
        && near(impact.thickness(), THICKNESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::reference::impact_of;
    use crate::scene::Reference;

    fn is_his(changes: &[&str]) -> bool {
        let text = include_bytes!("../../../inputs/flyer.json");
        let changes: Vec<String> = changes.iter().map(|change| (*change).into()).collect();
        let scene = crate::input::parse(text, "flyer.json", &changes).unwrap();
        let Some(Reference::FlyerImpact(named)) = &scene.scene.reference else { panic!() };
        is_burghardts(&impact_of(&scene, named).unwrap().0)
    }

    #[test]
    fn only_his_impact_has_his_figures() {
        assert!(is_his(&[]));
        assert!(is_his(&["domain.cell_size=2e-5"]), "his at any resolution");
        assert!(!is_his(&["bodies.flyer.velocity=[900]"]));
        assert!(!is_his(&["bodies.flyer.material=aluminium", "bodies.target.material=copper"]));
        assert!(!is_his(&["bodies.flyer.box.lower=[-0.4e-3]"]));
    }
}
