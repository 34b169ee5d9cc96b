#!/usr/bin/env bash
# Sets up, builds, and makes real pictures and numbers from nothing but the clone, in ./out-demo.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh release
vog=build/release/apps/cli/vog
out=out-demo
mkdir -p "$out"

step() {
    printf '\n$ vog %s\n' "$*"
    "$vog" "$@"
}
step sample cloud "$out/cloud.vdb" --size 256
step info "$out/cloud.vdb"
step convert "$out/cloud.vdb" -o "$out/cloud.ply" --method paper --lod 1 --amplitude mass
step info "$out/cloud.ply"
step render "$out/cloud.ply" -o "$out/cloud.png" --size 1024x1024 --tf blue-white
step render "$out/cloud.ply" -o "$out/cloud-inferno.png" --size 1024x1024 --tf inferno \
    --depth-out "$out/cloud-T.exr"
step render "$out/cloud.ply" --size 1024x1024 --repeat 5

printf '\nMade in %s:\n' "$out"
ls -l "$out" | awk 'NR > 1 {printf "  %-20s %10d bytes\n", $NF, $5}'
