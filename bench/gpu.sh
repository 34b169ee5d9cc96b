#!/usr/bin/env bash
# The GPU renderers, checked and then timed: one table on standard output, one JSON file.
# bench/gpu.sh [FOLDER, default gpu-data] [OUT.json, default gpu-bench.json]; needs what
# tests/gpu/run.sh needs.
set -euo pipefail
cd "$(dirname "$0")/.."

VOG_COMMIT=$(git rev-parse --short HEAD 2>/dev/null || true)
export VOG_COMMIT
tests/gpu/run.sh "${1:-gpu-data}" --bench "$(realpath -m "${2:-gpu-bench.json}")"
