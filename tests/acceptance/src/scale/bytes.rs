//! Bytes between ranks: a particle and a node travel once, however many patches need them.

use crate::bounds::{Unit, scale as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Bytes per step of FMPM(8) in a plane with few and with many patches. On more ranks the borders
/// between ranks are longer by themselves where patches are small, as loads are more even.
pub fn check(table: &mut Table) {
    for ranks in [2, 4] {
        let name = format!("FMPM(8), {ranks} ranks: bytes per step with 256 patches over 8");
        let (few, many) = (sent(ranks, [4, 2]), sent(ranks, [16, 16]));
        let (Some(few), Some(many)) = (table.take(&name, few), table.take(&name, many)) else {
            continue;
        };
        match ranks {
            2 => table.check(&name, Some(many / few), bounds::bytes::MANY_PATCHES),
            _ => table.beside(&name, Some(many / few), "", Unit::One),
        }
        table.beside("  bytes per step with 256 patches", Some(many), "", Unit::Bytes);
    }
}

/// Bytes per step of all ranks.
fn sent(ranks: usize, patches: [usize; 2]) -> Result<f64, String> {
    let sets = [
        "domain.cell_size=4e-5".to_string(),
        r#"method.transfer={"fmpm":8}"#.into(),
        format!("domain.patches=[{},{}]", patches[0], patches[1]),
        "decomposition.skip_quiescent=false".into(),
        "decomposition.balance.every=0".into(),
        "reference=null".into(),
        "time.end=5e-8".into(),
        r#"output={"profiles":{"times":[5e-8]},"pictures":false}"#.into(),
        "output.checkpoint.keep=0".into(),
    ];
    let job = sets.into_iter().fold(Job::new("flyer_2d"), Job::set).ranks(ranks);
    job.run().map(|run| run.summary.decomposition.bytes_per_step)
}
