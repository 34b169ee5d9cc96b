#!/usr/bin/env bash
# Writes the input of tests/gpu/run.sh into one folder, on a machine with the full build.
# tests/gpu/prepare.sh VOLUME.vdb [FOLDER, default gpu-data] [build folder, default build/release]
set -euo pipefail
cd "$(dirname "$0")/../.."

volume=${1:?usage: tests/gpu/prepare.sh VOLUME.vdb [FOLDER] [build folder]}
folder=${2:-gpu-data}
build=${3:-build/release}
cmake --build "$build" --target vog_gpu_prepare
"$build/tests/vog_gpu_prepare" "$volume" "$folder"
mkdir -p "$folder/include"
for headers in nanovdb fmt hwy nlohmann; do
    cp -r "/usr/include/$headers" "$folder/include/"
done
du -sh "$folder"
