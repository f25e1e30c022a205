#!/usr/bin/env bash
# Faults of tests/data/mutants.json put into a copy of the sources, one at a time, and the tests run
# until one fails: which test finds which, in docs/mutants.md. Hours on few cores.
#   scripts/mutants.sh              builds, runs all tests without a fault, then every fault
#   scripts/mutants.sh try WORD...  faults with a word in their text or file, with the last build
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"
export OMPI_MCA_rmaps_base_oversubscribe=1
if [ "$(cores)" -lt 4 ]; then
    export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1
fi

folder=$root/target/mutants
tree=$folder/tree
mkdir -p "$folder"
if [ "${1:-}" = try ]; then
    shift
    python3 scripts/mutants.py try "$folder" "$@"
else
    scripts/setup.sh --tests
    rm -rf "$tree"
    mkdir -p "$tree"
    git ls-files --cached --others --exclude-standard -z |
        xargs -0 cp --parents --preserve=mode,timestamps -t "$tree"
    python3 scripts/mutants.py write "$folder"
    # guards in every loop: what the last optimizations gain they cost in building
    (cd "$tree" && CARGO_TARGET_DIR="$folder/build" cargo test --workspace --release --no-run \
        --lib --bins --test '*' --message-format=json \
        --config 'profile.release.package.flyer-mpm.codegen-units=8' \
        --config 'profile.release.package.flyer-mpm.opt-level=2' >"$folder/build.json")
    python3 scripts/mutants.py baseline "$folder"
fi
python3 scripts/mutants.py table "$folder"
