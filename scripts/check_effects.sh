#!/usr/bin/env bash
# Measures what materials and effects promise, and prints each figure
# beside its bound; exit code 1 where one is missed. Arguments: sections (equations, porous,
# tables, products, burn, paths, strength_paths, objectivity, piston, flyer, taylor, taylor_fine,
# spall, heat, plates, window, wave, books);
# none: all but taylor_fine, which takes hours.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example check_effects
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_effects" "$@"
