#!/usr/bin/env bash
# Sites of procedural clouds of several sizes (docs/streaming.md): time and bytes of sites beside conversions, and the bytes that a
# view reads, for pictures of several sizes, from afar and near.
#
# usage: bench/streaming.sh VOG [SIZE...]     SIZE: voxels along an edge, default 256 512 1024 (needs 3 GB of disk, 2.5 GB of memory)
set -euo pipefail
vog=$1
shift
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

echo "| voxels along an edge | Gaussians | convert, s | export, s | bytes a Gaussian | .vogz with levels | first | view 256² | 512² | 1024² | 512², from 0.3 radii |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
for size in "${@:-256 512 1024}"; do
    for size in $size; do
        "$vog" sample cloud "$made/c.vdb" --size "$size" >/dev/null
        "$vog" convert "$made/c.vdb" -o "$made/c.ply" --block 2 --json >"$made/convert.json" 2>/dev/null
        "$vog" page "$made/c.ply" -o "$made/site/" --json >"$made/export.json"
        "$vog" pack "$made/c.ply" -o "$made/c.vogz" --hierarchy --deflate --json >"$made/file.json"
        n=0
        for view in "--size 256" "--size 512" "--size 1024" "--size 512 --distance 0.3"; do
            "$vog" render "$made/site" -o "$made/p.png" $view --json >"$made/view$n.json"
            n=$((n + 1))
        done
        python3 - "$size" "$made" <<'PYTHON'
import json, os, sys
size, made = sys.argv[1:]
read = lambda name: json.load(open(f"{made}/{name}.json"))
convert, export = read("convert"), read("export")
seconds = lambda report: sum(report["ms"].values()) / 1000
mb = lambda count: f"{count / 1e6:.2f} MB"
views = [mb(read(f"view{n}")["site"]["bytes_read"]) for n in range(4)]
print(f"| {size} | {export['gaussians']:,} | {seconds(convert):.2f} | {seconds(export):.2f} | {export['bytes'] / export['gaussians']:.2f} | "
      f"{os.path.getsize(f'{made}/c.vogz') / export['gaussians']:.2f} | {mb(export['page_bytes'] + export['root_bytes'])} | {' | '.join(views)} |")
PYTHON
        rm -rf "$made/site"
    done
done
