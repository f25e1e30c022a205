//! The pictures of a run, PNG and SVG.

use std::path::PathBuf;

use crate::home::{Contents, Home};
use crate::scenes::whole;

/// Asserts that exactly these pictures exist, each as PNG and SVG and not empty. A stem stands for
/// the one file that begins with it.
#[track_caller]
pub fn has_pictures(files: &Contents, stems: &[&str]) {
    for kind in ["png", "svg"] {
        let is_kind = |path: &&PathBuf| path.extension().is_some_and(|e| e == kind);
        let found: Vec<_> = files.keys().filter(is_kind).collect();
        assert_eq!(found.len(), stems.len(), "{found:?}");
        for (path, stem) in found.iter().zip(stems) {
            let name = path.to_str().unwrap();
            assert!(name.starts_with(stem), "{name} is no {stem}");
            let bytes = files[*path].as_ref().unwrap();
            assert!(bytes.len() > 2000, "{name} has {} bytes", bytes.len());
            match kind {
                "png" => assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"), "{name}"),
                _ => {
                    let text = std::str::from_utf8(bytes).unwrap();
                    assert!(text.trim_start().starts_with('<') && text.contains("<svg"), "{name}");
                    assert!(text.trim_end().ends_with("</svg>"), "{name}");
                }
            }
        }
    }
}

const STEMS: [&str; 7] = [
    "figure_1",
    "figure_2",
    "figure_3",
    "figure_4_0.050us",
    "figure_4_0.100us",
    "histories",
    "x_t_diagram",
];

#[test]
fn a_run_draws_all() {
    let home = Home::with(&whole());
    has_pictures(&home.run("run", &[]).files, &STEMS);
}

#[test]
fn a_picture_says_what_it_is() {
    let run = Home::with(&whole()).run("run", &[]);
    let svg = run.text("x_t_diagram.svg");
    for word in ["Flyer plate", "mm"] {
        assert!(svg.contains(word), "no `{word}` in the x-t diagram");
    }
}

#[test]
fn without_a_reference_there_are_no_hugoniots() {
    let mut scene = whole();
    scene.as_object_mut().unwrap().remove("reference");
    let stems = ["histories", "pressure_0.050us", "pressure_0.100us", "x_t_diagram"];
    let run = Home::with(&scene).run("run", &[]);
    has_pictures(&run.files, &stems);
    let svg = run.text("x_t_diagram.svg");
    assert!(!svg.contains("wave paths") && svg.contains("surface of a body"), "{svg}");
    let svg = run.text("pressure_0.100us.svg");
    assert!(svg.contains("copper") && svg.contains("aluminium"));
}

#[test]
fn other_impacts_are_no_figures_of_a_paper() {
    let run = Home::with(&whole()).run("run", &["--set", "bodies.flyer.velocity=[800]"]);
    let stems = [
        "histories",
        "hugoniot_free_surface",
        "hugoniot_impact",
        "hugoniot_second_interface",
        "pressure_0.050us",
        "pressure_0.100us",
        "x_t_diagram",
    ];
    has_pictures(&run.files, &stems);
    assert!(!run.text("hugoniot_impact.svg").contains("Figure"));
}
