#!/usr/bin/env bash
# Measures every figure that the flyer problem must show and prints it beside its bound; exit code
# 1 where one is missed. Arguments: --quick, or sections (flyer, cpdi, impacts, ...).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example check_flyer
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_flyer" "$@"
