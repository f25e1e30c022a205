#!/usr/bin/env bash
# Writes a release archive that needs no Rust: the program, the libraries that it needs beside the C
# library, inputs, the guide and the Python package.
#
#   scripts/release.sh [FOLDER]          FOLDER of the archive: target/release-archive unless said
#
# The archive runs on Linux with the C library of this machine or a newer one. For more than one rank it
# needs Open MPI on the search path; one rank needs nothing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
folder=${1:-target/release-archive}

"$root/scripts/setup.sh"
# results record the commit of the program
if commit=$(git -C "$root" describe --always --dirty 2>/dev/null); then
    export FLYER_MPM_COMMIT=$commit
fi
cargo build --release --quiet

program="${CARGO_TARGET_DIR:-$root/target}/release/flyer-mpm"
version=$("$program" --version | cut -d ' ' -f 2)
name="flyer-mpm-$version-$(uname -m)-linux"
place="$folder/$name"
rm -rf "$place"
mkdir -p "$place/lib/mpi"
strip --strip-debug -o "$place/lib/flyer-mpm" "$program"

# The C library and the loader stay those of the machine; libraries of MPI are used without mpirun only.
ldd "$program" | awk '$2 == "=>" && $3 ~ /^\// { print $1, $3 }' | while read -r short path; do
    case $short in
        libc.so.* | libm.so.* | libpthread.so.* | libdl.so.* | librt.so.* | libresolv.so.*) ;;
        libmpi* | libopen-* | libhwloc* | libevent* | libpmix*) cp -L "$path" "$place/lib/mpi/$short" ;;
        *) cp -L "$path" "$place/lib/$short" ;;
    esac
done

cat >"$place/flyer-mpm" <<'PROGRAM'
#!/bin/sh
# Starts the program with the libraries of this folder; under mpirun with the Open MPI of the machine.
here=$(dirname "$(readlink -f "$0")")
libraries="$here/lib"
if [ -z "${OMPI_COMM_WORLD_SIZE:-}${PMI_SIZE:-}${SLURM_PROCID:-}" ]; then
    libraries="$libraries:$here/lib/mpi"
fi
LD_LIBRARY_PATH="${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$libraries" exec "$here/lib/flyer-mpm" "$@"
PROGRAM
chmod +x "$place/flyer-mpm"

cp README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT "$place/"
git ls-files docs inputs python | while read -r file; do
    mkdir -p "$place/$(dirname "$file")"
    cp "$file" "$place/$file"
done
tar -C "$folder" -czf "$folder/$name.tar.gz" "$name"
rm -rf "$place"
echo "$folder/$name.tar.gz"
