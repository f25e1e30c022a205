#!/usr/bin/env bash
# Fits the laws of error_estimate again after schemes have changed: some minutes of two cores.
# Writes src/accuracy/estimate/laws.json and docs/error_estimate.png. Arguments: impacts (1250), threads (2).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo run --release --example calibrate_estimates -- "$@"
