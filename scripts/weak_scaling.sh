#!/usr/bin/env bash
# Measures how well a run keeps its speed per worker when the work grows with the workers: cells and
# end are divided by ranks x threads, so that particles per worker and the number of steps stay the
# same. Arguments and results as in strong_scaling.sh.
#
#   scripts/weak_scaling.sh inputs/flyer.json --ranks 1,2,4 --threads 1,2 --repeats 5
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"

"$root/scripts/setup.sh"
cargo build --release --quiet --manifest-path "$root/Cargo.toml"
exec "${CARGO_TARGET_DIR:-$root/target}/release/flyer-mpm" perf study weak --cores "$(cores)" "$@"
