#!/usr/bin/env bash
# Measures what checkpoints and faults promise, and prints each figure beside its bound; exit code 1
# where one is missed. Arguments: sections (restarts, kills, full, damage, cost). `full` mounts a
# small tmpfs and so needs root.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OMPI_MCA_mpi_yield_when_idle=1
cargo build --release --quiet --bin flyer-mpm --example check_reliability
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_reliability" "$@"
