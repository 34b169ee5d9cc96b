#!/usr/bin/env bash
# Runs all benches, prints tables with ratios within this run, and writes them to docs/performance.md. Needs an
# otherwise idle machine. Fails on a wrong picture or model, never on a time.
# --quick: small sizes, under two minutes; docs are not changed.
#
# usage: bench/run.sh [--quick] [BUILD_FOLDER]     default: build/release
set -euo pipefail
cd "$(dirname "$0")/.."

quick=() few=()
if [[ ${1:-} == --quick ]]; then
    quick=(--quick) few=(--benchmark_min_time=0.01)  # each picture and model is checked before it is timed
    shift
fi
build=${1:-build/release}
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
commit=$(git describe --always --dirty 2>/dev/null || echo unknown)

bench() {  # name, arguments; writes $results/name.json
    local name=$1
    shift
    echo "bench: $name" >&2
    "$build/bench/${name}_bench" --benchmark_format=json --benchmark_context=commit="$commit" "${few[@]}" "$@" \
        >"$results/$name.json" 2>"$results/log" || { cat "$results/log" >&2; exit 1; }
}

if [[ ${#quick[@]} -gt 0 ]]; then
    bench splat --quick
    bench reference --benchmark_filter='render/constant/size:512/threads:0'
    bench trace --benchmark_filter='trace/accumulate/block:8'
    bench convert --benchmark_filter='lod1'
    bench moments --benchmark_filter='block8$|budget3148'
    bench io --benchmark_filter='ply|vogz'
    bench points --benchmark_filter='/100/'
    bench lod --benchmark_filter='size:128/pixels:256/'
else
    bench splat
    bench reference --benchmark_filter='render/constant|build'
    bench trace --benchmark_filter='trace|build'
    bench convert
    bench moments
    bench io
    bench points --benchmark_filter='/100/'
    bench lod --benchmark_filter='size:(128|256|512)/'
fi

# Other renderers, where installed.
data=${VOG_DATA:-../shared/data}
if [[ ${#quick[@]} -gt 0 ]]; then
    :
elif [[ ! -f $data/smoke.vdb ]]; then
    echo "bench: no smoke.vdb: vdb_render and VTK are skipped" >&2
else
    if command -v vdb_render >/dev/null; then
        echo "bench: vdb_render" >&2
        bench/vdb_render.sh "$build" "$data/smoke.vdb" >"$results/vdb_render.lines"
    else
        echo "bench: no vdb_render (libopenvdb-tools): skipped" >&2
    fi
    if command -v xvfb-run >/dev/null && /usr/bin/python3 -c 'import vtkmodules, pyopenvdb' 2>/dev/null; then
        echo "bench: VTK" >&2
        "$build/apps/cli/vog" render "$data/smoke.vdb" --size 8 --depth-out "$results/x.exr" --json >"$results/camera"
        xvfb-run -a /usr/bin/python3 bench/vtk_render.py "$data/smoke.vdb" density "$results/camera" 1024 \
            >"$results/vtk.lines"
    else
        echo "bench: no VTK for Python (python3-vtk9 python3-openvdb xvfb): skipped" >&2
    fi
fi

python3 bench/tables.py "${quick[@]}" "$results" docs/performance.md
