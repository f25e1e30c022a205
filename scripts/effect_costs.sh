#!/usr/bin/env bash
# What each effect costs: instructions of a particle and step with it and without, and its bytes of a
# particle, as a table in Markdown. Each pair is one shipped scene with two settings; the set-up
# cancels between two lengths of run. Counted by valgrind's callgrind, so that it is the same number
# on a busy machine. Needs valgrind and jq.
set -euo pipefail
shopt -s inherit_errexit
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
program=${PROGRAM:-${CARGO_TARGET_DIR:-target}/release/flyer-mpm}
[ -x "$program" ] || cargo build --release --quiet --bin flyer-mpm
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# instructions and steps of a run of scene $1 that ends at $2, with the settings that follow
count() {
    local scene=$1 end=$2 sets=()
    shift 2
    for set in "time.end=$end" 'output={"profiles":{"times":['"$end"']},"hdf5":false,"pictures":false}' \
        'output.checkpoint.keep=0' decomposition.skip_quiescent=false 'domain.patches=null' "$@"; do
        sets+=(--set "$set")
    done
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "inputs/$scene.json" \
        --quiet --output "$work/$scene" "${sets[@]}" 2>"$work/log" >/dev/null ||
        { cat "$work/log" >&2; exit 1; }
    local instructions
    instructions=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$work/log")
    jq -r --arg i "$instructions" \
        '[$i, .steps, .particles, ([.effects[].bytes_per_particle] | add)] | @tsv' \
        "$work/$scene/summary.json"
}

# instructions of a particle and step, and bytes of a particle
cost() {
    local scene=$1 end=$2
    shift 2
    local short long
    short=$(count "$scene" "$(awk "BEGIN {print 0.25 * $end}")" "$@")
    long=$(count "$scene" "$end" "$@")
    awk -v a="$short" -v b="$long" 'BEGIN {
        split(a, s); split(b, l); printf "%.0f %d", (l[1] - s[1]) / ((l[2] - s[2]) * l[3]), l[4] }'
}

# effect, scene, end, setting without it, setting with it; settings are parted by |
row() {
    local effect=$1 scene=$2 end=$3 without with
    IFS='|' read -r -a without <<<"$4"
    IFS='|' read -r -a with <<<"$5"
    # assigned first, so that a failed run ends the script
    off_cost=$(cost "$scene" "$end" "${without[@]}")
    on_cost=$(cost "$scene" "$end" "${with[@]}")
    read -r off off_bytes <<<"$off_cost"
    read -r on on_bytes <<<"$on_cost"
    # shellcheck disable=SC2016 # the quotes are of Markdown
    printf '| %s | `%s.json` | %d | %d | %+d | %+d |\n' \
        "$effect" "$scene" "$off" "$on" "$((on - off))" "$((on_bytes - off_bytes))"
}

none='decomposition.threads=1'
textbook='method.edge_mask=null|method.filter_heat=false|method.energy=textbook'
metal='materials.aluminium.thermal={"specific_heat":900,"reference_temperature":300}'
warm='materials.aluminium.thermal={"specific_heat":900,"reference_temperature":300,"conductivity":200}'
echo '| effect | scene | without | with | instructions more | bytes more |'
echo '|---|---|---|---|---|---|'
row 'artificial viscosity' flyer 5e-8 'artificial_viscosity=null' "$none"
row 'pressure relaxation' flyer 5e-8 'method.pressure_relaxation=null' "$none"
row 'affine velocity (APIC against FLIP)' flyer 5e-8 \
    "method.transfer=flip|$textbook" "method.transfer=apic|$textbook"
row 'strength, von Mises, with its stress tensor' piston_elastic_plastic 5e-8 \
    'materials.aluminium.strength=null' "$none"
row 'failure, tension limit' spall 5e-8 'materials.aluminium.failure=null' "$none"
row 'erosion, a limit that is not reached' piston_elastic_plastic 5e-8 "$none" \
    'materials.aluminium.erosion={"plastic_strain":10}'
row 'temperature' piston_elastic_plastic 5e-8 "$none" "$metal"
row 'conduction' piston_elastic_plastic 5e-8 "$metal" "$warm"
row 'pores, P-alpha' porous_impact 2e-7 \
    'materials."porous copper".eos={"type":"mie_gruneisen","c0":3940,"s":1.489,"gamma0":1.96}|reference=null' "$none"
row 'burn by a front' detonation 2e-7 'materials.tnt.eos.burn=complete' "$none"
row 'contact, two bodies' gap 2e-8 'contact=null|reference=null' "$none"
row 'body force' simple_wave 1e-7 'boundary.x_lower.velocity=0|reference=null' \
    'boundary.x_lower.velocity=0|reference=null|body_force={"gravity":[-9.81]}'
row 'accelerated grid' simple_wave 1e-7 'boundary.x_lower.velocity=0|reference=null' "$none"
row 'transmitting side' simple_wave 1e-7 \
    'boundary.x_lower.velocity=0|reference=null|domain.upper=[0.003]|boundary.x_upper=outflow' \
    'boundary.x_lower.velocity=0|reference=null|domain.upper=[0.003]|boundary.x_upper=transmitting'
row 'loaded side' simple_wave 1e-7 'boundary.x_lower=free|reference=null' \
    'boundary.x_lower={"pressure":1e9}|reference=null'
