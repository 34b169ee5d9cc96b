#!/usr/bin/env bash
# Sets up, builds, and makes real pictures and numbers from nothing but the clone, in ./out-demo.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh demo
vog=build/demo/apps/cli/vog
out=out-demo
mkdir -p "$out"

step() {
    printf '\n$ vog %s\n' "$*"
    "$vog" "$@"
}
step sample cloud "$out/cloud.vdb" --size 256
step info "$out/cloud.vdb"
step convert "$out/cloud.vdb" -o "$out/cloud.ply" --block 4 --verbose
step info "$out/cloud.ply"
step render "$out/cloud.ply" -o "$out/cloud.png" --size 1024x768 --tf blue-white --blend \
    --depth-out "$out/cloud-T.exr"
step render "$out/cloud.ply" -o "$out/cloud-inferno.png" --size 1024x768 --tf inferno
step render "$out/cloud.vdb" -o "$out/voxels.png" --size 1024x768 --tf blue-white --blend \
    --depth-out "$out/voxels-T.exr"
step compare "$out/voxels-T.exr" "$out/cloud-T.exr" --diff "$out/difference.png"
step render "$out/cloud.ply" --size 1024x768 --repeat 5
step page "$out/cloud.ply" -o "$out/cloud.html" --title "A cloud" --tf blue-white --blend
step sample particles "$out/particles.xyz"
step convert "$out/particles.xyz" -o "$out/particles.ply" --budget 8000
step render "$out/particles.ply" -o "$out/particles.png" --size 1024x768 --tf magma

printf '\nMade in %s:\n' "$out"
ls -l "$out" | awk 'NR > 1 {printf "  %-20s %10d bytes\n", $NF, $5}'
