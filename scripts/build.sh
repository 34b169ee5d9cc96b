#!/usr/bin/env bash
# Sets up and builds one preset: scripts/build.sh [preset] [cmake options]. Default: release.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
shift || true
case $preset in
    demo) scripts/install-deps.sh command ;;
    sanitize) scripts/install-deps.sh sanitize ;;
    *) scripts/install-deps.sh all ;;
esac

# One compiler cache for every preset and every clone: paths relative to the clone, precompiled headers by content.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
cmake --preset "$preset" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@" >"/tmp/vog-configure-$$.log" ||
    { cat "/tmp/vog-configure-$$.log"; exit 1; }
rm -f "/tmp/vog-configure-$$.log"
cmake --build --preset "$preset"
