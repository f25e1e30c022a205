//! The same bits for every shape with every transfer, in this process: ranks are threads.

use std::time::Instant;

use serde_json::{Value, json};

use super::in_process::end_of;
use super::layouts::Layout;
use super::scenes::SHAPES;
use super::small_scenes::{ending, small_leapfrog, small_midpoint};
use crate::bounds::Unit;
use crate::table::Table;

/// A small scene with a shape and a transfer.
type Scene = fn(&str, &Value) -> Value;

/// Every scheme, with leapfrog and with mid-point steps, over layouts in which every pair of
/// choices occurs; twice as long as the tests, for waves that turn back.
pub fn check(table: &mut Table) {
    let start = Instant::now();
    let layouts = Layout::covering();
    let [xpic, fmpm] = [json!({"xpic": 3}), json!({"fmpm": 4})];
    let transfers =
        [json!("flip"), json!("pic"), json!("apic"), json!({"flip_pic": 0.9}), xpic, fmpm];
    let steppings: [(&str, Scene); 2] =
        [("leapfrog", small_leapfrog), ("mid-point", small_midpoint)];
    for (stepping, scene) in steppings {
        for shape in SHAPES {
            for transfer in &transfers {
                let mut scene = scene(shape, transfer);
                ending(&mut scene, 6e-8);
                let name = format!("same bits: {stepping}, {shape}, {transfer}");
                let whole = end_of(&scene, &Layout::WHOLE);
                let same = layouts.iter().filter(|layout| {
                    let same = end_of(&scene, layout) == whole;
                    if !same {
                        table.holds(&format!("{name}, {layout}"), "others", "the same", false);
                    }
                    same
                });
                let (same, all) = (same.count(), layouts.len());
                table.holds(&name, &format!("{same} layouts"), &format!("all {all}"), same == all);
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    table.beside("same bits, all schemes: seconds", Some(seconds), "", Unit::One);
}
