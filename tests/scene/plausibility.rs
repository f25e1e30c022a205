//! Warnings about values that are allowed but rarely meant: each with a scene that sets it off, and
//! one beside it that does not.

use crate::with;

#[track_caller]
fn warned(name: &str, wrong: &[&str], right: &[&str], fragment: &str) {
    let warnings = |sets: &[&str]| with(name, sets).unwrap().warnings;
    let all = warnings(wrong);
    assert!(all.iter().any(|w| w.contains(fragment)), "no `{fragment}` in {all:?}");
    let all = warnings(right);
    assert!(!all.iter().any(|w| w.contains(fragment)), "{all:?}");
}

#[test]
fn densities_in_other_units() {
    let set = |density: &str| format!("materials.copper.density={density}");
    warned(
        "flyer.json",
        &[&set("8.93")],
        &[&set("20")],
        "materials.copper.density = 8.93: no solid",
    );
    warned("flyer.json", &[&set("3.1e4")], &[&set("2.9e4")], "the unit is kg/m3");
    // a gas may be thin: air at room temperature
    let air = ["materials.gas_left.density=1.2", "bodies.left.pressure=1e5", "time.end=5e-4"];
    let warnings =
        with("sod.json", &[&air[..], &["output.profiles.times=[5e-4]"]].concat()).unwrap();
    assert!(!warnings.warnings.iter().any(|w| w.contains("kg/m3")), "{:?}", warnings.warnings);
}

#[test]
fn bodies_of_few_cells() {
    let cells = |size: &str| format!("domain.cell_size={size}");
    warned("flyer.json", &[&cells("1e-4")], &[&cells("5e-5")], "bodies.flyer: 5.0 cells across");
}

#[test]
fn shocks_without_viscosity() {
    let off = "artificial_viscosity=null";
    let speed = |v: &str| format!("bodies.flyer.velocity=[{v}]");
    warned("flyer.json", &[off], &[off, &speed("50")], "bodies meet at 1000 m/s");
    warned("flyer.json", &[off], &[], "shock will oscillate");
    // bodies that leave each other
    let parting = [off, "reference=null", &speed("-500")];
    warned("flyer.json", &[off], &parting, "shock will oscillate");
    // elastic solids
    assert!(with("disks.json", &[]).unwrap().warnings.is_empty());
}

#[test]
fn runs_that_end_too_early_or_too_late() {
    let end = |t: &str| vec![format!("time.end={t}"), "output.profiles.times=[1e-10]".to_string()];
    let [short, long, right] = [end("1e-9"), end("1.0"), end("1e-7")];
    let sets = |all: &Vec<String>| all.clone();
    let warnings = |all: &Vec<String>| {
        let all = sets(all);
        with("flyer.json", &all.iter().map(String::as_str).collect::<Vec<_>>()).unwrap().warnings
    };
    assert!(warnings(&short).iter().any(|w| w.contains("crosses only 0.07 % of the longest")));
    let told = warnings(&long);
    assert!(told.iter().any(|w| w.contains("steps") && w.contains("hours")), "{told:?}");
    assert!(warnings(&right).is_empty(), "{:?}", warnings(&right));
}
