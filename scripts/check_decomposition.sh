#!/usr/bin/env bash
# Measures what sharing the work over ranks, patches and threads promises, and prints each figure
# beside its bound; exit code 1 where one is missed. Arguments: --full, or sections (bits, schemes,
# speed, balance, quiet, memory, hang).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example check_decomposition
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_decomposition" "$@"
