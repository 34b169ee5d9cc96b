#!/usr/bin/env bash
# Sets up and builds one preset: scripts/build.sh [preset] [cmake options]. Default: release.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
shift || true
scripts/install-deps.sh
cmake --preset "$preset" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@" >"/tmp/vog-configure-$$.log" ||
    { cat "/tmp/vog-configure-$$.log"; exit 1; }
rm -f "/tmp/vog-configure-$$.log"
cmake --build "build/$preset"
