#!/usr/bin/env bash
# Measures what runs in a plane and bodies in contact promise, and prints each figure beside its
# bound; exit code 1 where one is missed. Arguments: sections (column, bits, finite, oblique, sides,
# contact, vortex, disk, shear, gresho, disks, noh, sod, speed).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet --bin flyer-mpm --example check_2d
exec "${CARGO_TARGET_DIR:-target}/release/examples/check_2d" "$@"
