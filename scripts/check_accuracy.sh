#!/usr/bin/env bash
# Measures what is promised of accuracy and its price, and prints each figure beside its bound;
# exit code 1 where one is missed. Arguments: sections (standard, order, impacts,
# noh, smooth, cost, estimate, plan) to run them alone.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example check_accuracy
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_accuracy" "$@"
