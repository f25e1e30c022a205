#!/usr/bin/env bash
# Measures how a scene's run speeds up on more ranks and threads: a table, a CSV, scaling.json and
# a picture in output/strong_scaling_<scene>/.
#
#   scripts/strong_scaling.sh inputs/flyer.json --ranks 1,2,4 --threads 1,2 --repeats 5
#   scripts/strong_scaling.sh --help
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"

"$root/scripts/setup.sh"
cargo build --release --quiet --manifest-path "$root/Cargo.toml"
exec "${CARGO_TARGET_DIR:-$root/target}/release/flyer-mpm" perf study strong --cores "$(cores)" "$@"
