#!/usr/bin/env bash
# Fits the laws of error_estimate and the errors of the schemes of a plan again after schemes have changed: a quarter
# of an hour to an hour of two cores. Writes src/accuracy/estimate/laws.json, src/accuracy/plan/data.json and
# docs/error_estimate.png. Arguments: impacts (16000), threads (2), folder of the runs (output/calibration), whose
# results an interrupted or repeated call uses again: remove it after schemes have changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo run --release -p calibration -- "$@"
