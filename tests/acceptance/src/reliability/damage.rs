//! A checkpoint that was cut or in which single bits have changed is never continued.

use std::fs;
use std::panic::catch_unwind;

use calibration::random::Random;
use decomp::Serial;
use flyer_mpm::driver::checkpoint::{CheckpointError, file};

use super::runs::{end, folder, scene, with};
use crate::bounds::reliability as bounds;
use crate::table::Table;

/// Places at which it is cut, and bits that are changed.
const CUTS: u64 = bounds::damage::CUTS_REFUSED.number() as u64;
const BITS: u64 = bounds::damage::BITS_REFUSED.number() as u64;

/// Damages a checkpoint of the flyer after two hundred steps, with profiles and histories.
pub fn check(table: &mut Table) {
    let home = folder("damage");
    let args = scene(
        "flyer",
        &["output.profiles.times=[5e-8,1e-6]", "output.checkpoint={\"every_steps\":200}"],
    );
    let at = home.join("run").display().to_string();
    let run = with(
        &args,
        &["--output", &at, "--set", "time.end=1.5e-7", "--set", "output.profiles.times=[5e-8]"],
    );
    end(1, &run);
    let path = home.join("run.checkpoints/checkpoint-000001.hdf5");
    let bytes = table.take("damage: a checkpoint", fs::read(&path).map_err(|e| e.to_string()));
    let Some(bytes) = bytes else { return };
    let whole =
        table.take("damage: it is whole", file::read(&Serial, &path).map_err(|e| e.to_string()));
    if whole.is_none() {
        return;
    }
    let seen = |damaged: &[u8]| {
        let _ = fs::write(&path, damaged);
        matches!(
            catch_unwind(|| file::read(&Serial, &path)),
            Ok(Err(CheckpointError::Damaged { .. }))
        )
    };
    let mut random = Random::new(3);
    let size = bytes.len() as u64;
    let cuts = (0..CUTS).filter(|_| seen(&bytes[..random.below(size) as usize])).count() as u64;
    let figure = "a checkpoint cut: refused, never a panic";
    table.all(figure, cuts, bounds::damage::CUTS_REFUSED);
    let mut bytes = bytes;
    let mut bits = 0;
    for _ in 0..BITS {
        let bit = random.below(8 * size);
        let (byte, mask) = ((bit / 8) as usize, 1 << (bit % 8));
        bytes[byte] ^= mask;
        bits += u64::from(seen(&bytes));
        bytes[byte] ^= mask;
    }
    table.all("one bit of it changed: the same", bits, bounds::damage::BITS_REFUSED);
    // the program says so, and does not start
    let _ = fs::write(&path, &bytes[..bytes.len() - 1]);
    let (code, said) = end(2, &with(&[], &["--restart", &path.display().to_string()]));
    let is_reported = code == Some(2) && said.contains("is damaged");
    table.holds(
        "  what the program says",
        if is_reported { "damaged" } else { "other" },
        "damaged, code 2",
        is_reported,
    );
}
