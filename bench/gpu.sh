#!/usr/bin/env bash
# Checks, then times the GPU renderers: a table on standard output and a JSON file.
# usage: bench/gpu.sh [FOLDER, default gpu-data] [OUT.json, default gpu-bench.json]
# Requirements: those of tests/gpu/run.sh.
set -euo pipefail
cd "$(dirname "$0")/.."

VOG_COMMIT=$(git rev-parse --short HEAD 2>/dev/null || true)
export VOG_COMMIT
tests/gpu/run.sh "${1:-gpu-data}" --bench "$(realpath -m "${2:-gpu-bench.json}")"
