#!/usr/bin/env bash
# Sets up what is missing, then runs every test; arguments go to cargo test.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/mpi_env.sh
. "$root/scripts/mpi_env.sh"
cd "$root"

scripts/setup.sh --tests

# Tests start more ranks than a small machine has cores.
export OMPI_MCA_rmaps_base_oversubscribe=1
if [ "$(cores)" -lt 4 ]; then
    export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1
fi

# VTK's own reader, h5py and what executes notebooks, from pip, for tests/vtk_reader.rs and
# tests/python.rs.
if [ -z "${FLYER_MPM_VTK_PYTHON:-}" ]; then
    venv="$root/target/vtk-venv"
    needed='import vtkmodules.vtkIOHDF, h5py, matplotlib, nbclient, nbformat, ipykernel'
    if ! "$venv/bin/python" -c "$needed" 2>/dev/null; then
        echo "test: making a Python environment with vtk, h5py and nbclient in target/vtk-venv"
        rm -rf "$venv"
        mkdir -p "$root/target"
        python3 -m venv "$venv"
        "$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
            'vtk>=9.4' numpy h5py matplotlib nbclient nbformat ipykernel ||
            echo "test: vtk, h5py and nbclient cannot be installed; their tests will be skipped" >&2
    fi
    if "$venv/bin/python" -c 'import vtkmodules.vtkIOHDF, h5py' 2>/dev/null; then
        export FLYER_MPM_VTK_PYTHON="$venv/bin/python"
    fi
fi

# Many tests wait for processes.
export RUST_TEST_THREADS="${RUST_TEST_THREADS:-$((2 * $(nproc)))}"

if [ $# -gt 0 ]; then
    cargo test --workspace --release "$@"
    exit
fi
# The unit tests need no speed, and the library is compiled once more for them.
cargo test --workspace --release --lib --config 'profile.release.package.flyer-mpm.opt-level=0'
cargo test --workspace --release --bins --test '*'
cargo test --workspace --release --doc
