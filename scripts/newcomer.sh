#!/usr/bin/env bash
# Times the way of a newcomer to the first result, part by part.
#
#   scripts/newcomer.sh archive ARCHIVE [ROOT]   unpack a release archive, write a scene, run it
#   scripts/newcomer.sh clone [REPOSITORY]       clone, install packages, build, write a scene, run it
#
# With ROOT, a folder with a bare Debian (debootstrap --variant=minbase), all commands run in it by chroot.
# The parts are printed in seconds.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
way=${1:-}
bare=""

in_home() { # in_home COMMAND: in the folder of the newcomer, on the bare machine if there is one
    if [ -n "$bare" ]; then
        chroot "$bare" /usr/bin/env -i PATH=/usr/bin:/bin sh -c "cd /newcomer && $1"
    else
        (cd "$home" && sh -c "$1")
    fi
}
part() { # part NAME COMMAND
    local start end
    start=$(date +%s.%N)
    in_home "$2" >"$home/log" 2>&1 || { cat "$home/log" >&2 && exit 1; }
    end=$(date +%s.%N)
    awk -v name="$1" -v s="$start" -v e="$end" 'BEGIN { printf "%-28s %8.2f s\n", name, e - s }'
}
first_scene() { # first_scene PROGRAM
    part "write a scene" "$1 new plate_impact"
    part "own change, check" "$1 check plate_impact.json --set bodies.flyer.velocity='[\"800 m/s\"]'"
    part "run, pictures, report" \
        "$1 plate_impact.json --set bodies.flyer.velocity='[\"800 m/s\"]' --report --quiet"
    part "picture and report are there" "ls output/plate_impact/x_t_diagram.png output/plate_impact/report.html"
}

begun=$(date +%s.%N)
case $way in
    archive)
        archive=$2
        bare=${3:-}
        if [ -n "$bare" ]; then
            home="$bare/newcomer"
            rm -rf "$home"
            mkdir "$home"
        else
            home=$(mktemp -d)
        fi
        trap 'rm -rf "$home"' EXIT
        cp "$archive" "$home/archive.tar.gz"
        part "unpack" "mkdir flyer && tar -xzf archive.tar.gz -C flyer --strip-components 1"
        first_scene ./flyer/flyer-mpm
        ;;
    clone)
        home=$(mktemp -d)
        trap 'rm -rf "$home"' EXIT
        part "clone" "git clone --quiet '${2:-$root}' flyer"
        part "packages" "flyer/scripts/setup.sh"
        part "build" "cd flyer && cargo build --release --quiet"
        first_scene ./flyer/target/release/flyer-mpm
        ;;
    *)
        echo "usage: scripts/newcomer.sh archive ARCHIVE [ROOT] | clone [REPOSITORY]" >&2
        exit 2
        ;;
esac
awk -v s="$begun" -v e="$(date +%s.%N)" 'BEGIN { printf "%-28s %8.2f s\n", "all", e - s }'
