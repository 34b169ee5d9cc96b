#!/bin/sh
# vdb_render.sh: times of the reference renderer and of OpenVDB's vdb_render, with the same volume, view and
# size, in one run, with one thread and with all; without loading and writing. vdb_render also shades: it
# marches a shadow ray from every sample and stops rays of low transmittance. The reference integrates every
# voxel exactly and does not shade.
#
# usage: bench/vdb_render.sh BUILD_FOLDER VOLUME.vdb [GRID]
set -eu
if [ $# -lt 2 ]; then
    echo "usage: $0 BUILD_FOLDER VOLUME.vdb [GRID]" >&2
    exit 2
fi
command -v vdb_render > /dev/null || { echo "$0: no vdb_render (libopenvdb-tools)" >&2; exit 1; }
bench=$1/bench/reference_bench
export VOG_BENCH_VOLUME=$2 VOG_BENCH_GRID=${3:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for threads in 1 0; do
    "$bench" --benchmark_filter="render/constant/size:512/threads:$threads/" \
        --benchmark_format=json > "$folder/ours.json" 2> "$folder/log"
    view=$(sed -n 's/.*"label": "\(.*\)",*/\1/p' "$folder/ours.json" | head -n 1)
    for run in 1 2 3 4 5 6; do  # the first is the warm-up
        # shellcheck disable=SC2086  # the view is several words
        vdb_render "$VOG_BENCH_VOLUME" "$folder/theirs.exr" -res 512x512 -cpus $threads -v $view |
            sed -n '/ray-tracing/,$ s/.*completed in \(.*\) sec/\1/p' | head -n 1
    done | tail -n 5 | sort -g > "$folder/theirs"
    python3 - "$folder" "$threads" << 'PYTHON'
import json, sys
folder, threads = sys.argv[1], sys.argv[2]
runs = json.load(open(folder + "/ours.json"))["benchmarks"]
ours = {run["aggregate_name"]: run["real_time"] for run in runs}
theirs = [1000 * float(line) for line in open(folder + "/theirs")]
print(json.dumps({
    "size": "512x512", "threads": "all" if threads == "0" else threads,
    "vog_ms": {key: round(ours[key], 2) for key in ("min", "median", "max")},
    "vdb_render_ms": {"min": theirs[0], "median": theirs[2], "max": theirs[4]},
    "ratio_of_medians": round(theirs[2] / ours["median"], 1)}))
PYTHON
done
