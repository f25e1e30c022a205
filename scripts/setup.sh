#!/usr/bin/env bash
# Installs what a Debian or Ubuntu machine lacks for building and running flyer-mpm: Open MPI,
# HDF5, libclang, a C compiler, pkg-config; with --tests also what makes a Python environment, and
# chromium.
# Says what it does; where all is there it does and says nothing.
set -euo pipefail

missing=()
need() { # need PACKAGE... : these packages are to be installed
    missing+=("$@")
}
have() {
    command -v "$1" >/dev/null 2>&1
}
have_hdf5() {
    [ -n "${HDF5_DIR:-}" ] || have h5cc || { have pkg-config && pkg-config --exists hdf5; }
}
have_libclang() {
    local file
    for file in "${LIBCLANG_PATH:-/nowhere}"/libclang*.so* /usr/lib/llvm-*/lib/libclang*.so* \
        /usr/lib/*-linux-gnu/libclang*.so* /usr/lib/libclang*.so* /usr/lib64/libclang*.so*; do
        [ -e "$file" ] && return 0
    done
    return 1
}

have cc || need gcc libc6-dev
have pkg-config || need pkg-config
have mpirun || need openmpi-bin
have mpicc || need libopenmpi-dev
have_hdf5 || need libhdf5-dev
have_libclang || need libclang-dev
have clang || need clang
if [ "${1:-}" = --tests ] && ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
    need python3 python3-venv
fi
# where apt has no chromium, the test of report.html in a browser is skipped
if [ "${1:-}" = --tests ] && ! have chromium && have apt-cache &&
    apt-cache policy chromium 2>/dev/null | grep -q 'Candidate: [0-9]'; then
    need chromium
fi

if [ ${#missing[@]} -gt 0 ]; then
    if ! have apt-get; then
        echo "setup: please install what these Debian packages hold: ${missing[*]}" >&2
        exit 1
    fi
    as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! have sudo; then
            echo "setup: please install as root: apt-get install ${missing[*]}" >&2
            exit 1
        fi
        as_root=(sudo)
    fi
    echo "setup: installing by apt, which takes a minute or two: ${missing[*]}"
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

if ! have cargo; then
    echo "setup: no cargo found; install a Rust toolchain (see Cargo.toml for the least version)" >&2
    exit 1
fi
