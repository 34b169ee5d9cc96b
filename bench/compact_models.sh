#!/usr/bin/env bash
# Bytes and losses of compact models (docs/compact.md): models of several sizes of each volume, as PLY and as .vogz at a loss of
# at most 0.1 dB of V against the voxels in any of seven views.
#
# usage: bench/compact_models.sh VOG DATA     DATA: smoke.vdb, cloud.vdb, beetle.vdb, aquarius.vdb, plume/plume_0030.vdb
set -euo pipefail
vog=$1 data=$2
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

echo "| data | Gaussians | PSNR of V, dB | PLY, bytes each | .vogz | of it fields | loss, dB | hierarchy beside |"
echo "|---|---|---|---|---|---|---|---|"
# file:grid budgets
while read -r volume budgets; do
    file=${volume%%:*} grid=${volume#*:}
    for budget in $budgets; do
        "$vog" convert "$data/$file" --grid "$grid" --budget "$budget" --no-hierarchy -o "$made/m.ply" >/dev/null 2>&1
        "$vog" pack "$made/m.ply" -o "$made/m.vogz" --max-loss 0.1 --reference "$data/$file:$grid" --json >"$made/m.json"
        "$vog" pack "$made/m.ply" -o "$made/h.vogz" --hierarchy --json >"$made/h.json"
        python3 - "$file" "$made" <<'PYTHON'
import json, os, sys
name, made = sys.argv[1:]
m, h = (json.load(open(f"{made}/{f}.json")) for f in "mh")
each = m["bytes_each"]
fields = sum(v for k, v in each.items() if k != "shapes")
ply = os.path.getsize(f"{made}/m.ply") / m["gaussians"]
print(f"| {os.path.basename(name)} | {m['gaussians']:,} | {m['model_db']:.1f} | {ply:.1f} | {m['bytes'] / m['gaussians']:.2f} | "
      f"{fields:.2f} | {m['loss_db']:.3f} | {h['bytes_each']['hierarchy']:.2f} |")
PYTHON
    done
done <<'DATA'
smoke.vdb:density 3000 20000 140000
cloud.vdb:density 3000 20000 100000
plume/plume_0030.vdb:density 3000 13000 60000
beetle.vdb:density 10000 30000
aquarius.vdb:density 20000 100000
DATA
