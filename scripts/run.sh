#!/usr/bin/env bash
# Sets up what is missing, builds in release and runs a scene on two ranks.
#
#   scripts/run.sh [SCENE] [ARGS]        SCENE: inputs/flyer.json unless said
#   RANKS=4 scripts/run.sh ...           on four ranks
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"

"$root/scripts/setup.sh"
# results record the commit of the program
if commit=$(git -C "$root" describe --always --dirty 2>/dev/null); then
    export FLYER_MPM_COMMIT=$commit
fi
cargo build --release --quiet --manifest-path "$root/Cargo.toml"

if [ $# -eq 0 ] || [[ $1 == -* ]]; then
    set -- "$root/inputs/flyer.json" "$@"
fi
ranks=${RANKS:-2}
options=(--quiet --oversubscribe -n "$ranks")
if [ "$ranks" -gt "$(cores)" ]; then
    # Ranks that wait give way to those that work.
    options+=(--bind-to none --mca mpi_yield_when_idle 1)
elif [[ " $* " == *" --threads"* ]]; then
    options+=(--bind-to none)
else
    options+=(--bind-to core:if-supported)
fi
exec mpirun "${options[@]}" "${CARGO_TARGET_DIR:-$root/target}/release/flyer-mpm" "$@"
