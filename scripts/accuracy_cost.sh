#!/usr/bin/env bash
# Cost of accuracy in time: runs the studies of inputs/studies/ into output/studies/ (cases that an
# earlier call has run are not run again), and checks the statements of Burghardt (2010) on viscosity.
# --quick: the shorter study of schemes and the viscosity sweep, a few minutes.
# scripts/accuracy_cost.py then writes tables and pictures to docs/.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

studies=(schemes impacts_cost plane_vortex plane_noh plane_disk plane_oblique plane_flyer plane_sphere
    impacts edge_mask viscosity viscosity_default courant price)
case "${1:-}" in
    --quick) studies=(quick viscosity) ;;
    "") ;;
    *) echo "usage: scripts/accuracy_cost.sh [--quick]" >&2; exit 2 ;;
esac
scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example viscosity_claims
target="${CARGO_TARGET_DIR:-target}/release"
for study in "${studies[@]}"; do
    "$target/flyer-mpm" study "inputs/studies/$study.json"
done
"$target/examples/viscosity_claims" output/studies/viscosity
