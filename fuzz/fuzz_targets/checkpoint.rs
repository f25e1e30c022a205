//! Whatever stands in a checkpoint's file, it is read or refused in one line.
#![no_main]

use decomp::Serial;
use flyer_mpm::driver::checkpoint::file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let home = tempfile::tempdir().expect("a folder");
    let path = home.path().join("checkpoint.hdf5");
    std::fs::write(&path, bytes).expect("a file");
    if let Err(error) = file::read(&Serial, &path) {
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
    }
});
