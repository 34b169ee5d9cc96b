#!/usr/bin/env bash
# Sets up, builds and runs all tests: scripts/test.sh [cmake options]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh release "$@"
ctest --preset release
