//! Instructions of contact, counted by callgrind.

use serde_json::{Value, json};

use super::scenes::block;
use crate::bounds::{Unit, contact::normals as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Two blocks of seven cells that press on each other: three of the fifteen rows of nodes are in
/// contact.
fn job(contact: &Value, end: f64) -> Job {
    let mut bodies = [block([0.0, 0.0], [0.4, 0.07], 0.0), block([0.0, -0.07], [0.4, 0.0], 0.0)];
    for ((body, name), speed) in bodies.iter_mut().zip(["upper", "lower"]).zip([1.0, 0.0]) {
        body["name"] = json!(name);
        body["material"] = json!("rubber");
        body["velocity"] = json!([speed, 0.0]);
        body["particles_per_cell"] = json!([2, 2]);
    }
    let boundary = json!({"y_lower": "no_slip", "x_lower": "periodic", "x_upper": "periodic"});
    Job::new("free_slide")
        .set(format!("bodies={}", json!(bodies)))
        .set(format!("boundary={boundary}"))
        .set("domain.lower=[0, -0.07]")
        .set("domain.upper=[0.4, 0.07]")
        .set("body_force={\"gravity\": [0, -10]}")
        .set(format!("contact={contact}"))
        .set("decomposition={\"skip_quiescent\": false}")
        .set("output={\"pictures\": false, \"checkpoint\": {\"keep\": 0}}")
        .set(format!("time.end={end:e}"))
        .counted()
}

/// Instructions per particle and step: the set-up cancels.
fn count(contact: &Value) -> Result<f64, String> {
    let run = |end: f64| -> Result<[f64; 3], String> {
        let run = job(contact, end).run()?;
        let instructions = run.instructions.ok_or("callgrind has printed no number")?;
        Ok([run.summary.steps as f64, run.summary.particles as f64, instructions as f64])
    };
    let ([steps, particles, instructions], [more_steps, _, more]) = (run(2e-4)?, run(1.2e-3)?);
    Ok((more - instructions) / ((more_steps - steps) * particles))
}

/// Each source of normals, without and with friction, against a run without contact.
pub fn check(table: &mut Table) {
    let Some(without) = table.take("without contact", count(&Value::Null)) else { return };
    for normals in ["boundary_faces", "widest_gap", "volume_gradient", "logistic_regression"] {
        for friction in [None, Some(0.3)] {
            let contact = match friction {
                None => json!({"type": "frictionless", "normals": normals}),
                Some(mu) => json!({"type": "friction", "coefficient": mu, "normals": normals}),
            };
            let law = if friction.is_some() { "friction" } else { "frictionless" };
            let figure = format!("{normals}, {law}: instructions over those without contact");
            let ratio = table.take(&figure, count(&contact)).map(|count| count / without);
            match normals {
                "boundary_faces" => table.check(&figure, ratio, bounds::INSTRUCTIONS),
                _ => table.beside(&figure, ratio, "", Unit::One),
            }
        }
    }
}
