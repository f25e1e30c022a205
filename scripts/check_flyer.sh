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
if [ "$(cores)" -lt 4 ]; then
    export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1
fi
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_flyer" "$@"
