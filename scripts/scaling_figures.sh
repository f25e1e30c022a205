#!/usr/bin/env bash
# Renews docs/strong_scaling.png and docs/weak_scaling.png: measures the constants of this machine for
# inputs/flyer_2d.json, then runs a strong-scaling study on its cores with the model's line beside it,
# and a weak one on up to 64 ranks, whose bytes and messages are counted beside those of the model.
#
#   scripts/scaling_figures.sh            # some ten minutes on two cores
#   REPEATS=9 scripts/scaling_figures.sh
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh
cargo build --release --quiet
program="${CARGO_TARGET_DIR:-target}/release/flyer-mpm"
scene=inputs/flyer_2d.json
machine=output/scaling_figures/machine.json
options=(--machine "$machine" --cores "$(cores)" --set reference=null)

# 1, 2, 4, ... up to the number of cores
ranks=1
for ((n = 2; n <= $(cores); n *= 2)); do ranks+=,$n; done

mpirun -n 2 --oversubscribe --bind-to none "$program" perf calibrate "$scene" --output "$machine"
"$program" perf study strong "$scene" "${options[@]}" --repeats "${REPEATS:-5}" \
    --ranks "$ranks" --threads "$ranks" --output output/scaling_figures/strong \
    --set domain.cell_size=4e-5 --set time.end=4e-8 \
    --set 'output.profiles={"times":[4e-8],"max_particles":2000}'
"$program" perf predict "$scene" --machine "$machine" \
    --set reference=null --against output/scaling_figures/strong/scaling.json
"$program" perf study weak "$scene" "${options[@]}" --repeats 1 \
    --ranks 1,4,16,64 --output output/scaling_figures/weak \
    --set domain.cell_size=1.2e-4 --set time.end=6e-8 \
    --set 'output.profiles={"times":[6e-8],"max_particles":2000}'
for kind in strong weak; do
    cp "output/scaling_figures/$kind/scaling.png" "docs/${kind}_scaling.png"
done
