//! Makes a constant of each bound of `bounds.toml`: `l1` of `[flyer.profiles]` is
//! `bounds::flyer::profiles::L1`. A section that asks for an absent bound does not compile, and
//! neither does a bound that no section asks for.

#[path = "src/bound.rs"]
mod bound;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use bound::Bound;

type Sections = BTreeMap<String, BTreeMap<String, Bound>>;

fn main() {
    println!("cargo::rerun-if-changed=bounds.toml");
    let text = std::fs::read_to_string("bounds.toml").expect("bounds.toml is beside Cargo.toml");
    let groups: BTreeMap<String, Sections> =
        basic_toml::from_str(&text).unwrap_or_else(|error| panic!("bounds.toml: {error}"));
    let mut code = String::new();
    for (group, sections) in &groups {
        let _ = writeln!(code, "#[deny(dead_code)]\npub mod {group} {{");
        for (section, bounds) in sections {
            let _ = writeln!(code, "pub mod {section} {{\nuse crate::bounds::{{Bound, Unit::*}};");
            for (key, bound) in bounds {
                let Bound { at_most, at_least, unit } = bound;
                let limits = [at_most, at_least].into_iter().flatten().count();
                assert!(limits == 1, "{group}.{section}.{key}: one of at_most and at_least");
                let name = key.to_uppercase();
                let _ = writeln!(
                    code,
                    "pub const {name}: Bound = \
                     Bound {{ at_most: {at_most:?}, at_least: {at_least:?}, unit: {unit:?} }};"
                );
            }
            code += "}\n";
        }
        code += "}\n";
    }
    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    std::fs::write(Path::new(&folder).join("bounds.rs"), code).expect("OUT_DIR can be written");
}
