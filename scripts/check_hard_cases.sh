#!/usr/bin/env bash
# Measures what hard cases must keep, and prints each figure beside its bound; exit code 1 where one
# is missed. Arguments: sections, named as the cases of tests/hard_cases/cases/mod.rs; `schemes`
# writes docs/hard_cases.md, every shape function with every transfer; none: all but that.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --example check_hard_cases
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_hard_cases" "$@"
