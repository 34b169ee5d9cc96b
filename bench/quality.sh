#!/bin/sh
# quality.sh: the table of docs/moments.md: every volume converted by uniform cells and by budgets, its T at
# 512x512 in the paper view measured against that of the voxels, and the mean and the worst error of twelve views
# along axes, diagonals and others, far and near (vog convert --set measure-error=1).
#
# usage: bench/quality.sh VOG DATA_FOLDER [OPTION...]     further options are passed to every --budget
set -eu
if [ $# -lt 2 ]; then
    echo "usage: $0 VOG DATA_FOLDER [OPTION...]" >&2
    exit 2
fi
vog=$1 data=$2
shift 2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

row() {  # volume, options of the grid, options of the conversion
    # shellcheck disable=SC2086  # options are several words
    "$vog" convert "$data/$1.vdb" $2 -o "$folder/m.ply" --set measure-error=1 --no-hierarchy --no-fields --json $3 > "$folder/convert.json"
    "$vog" render "$folder/m.ply" -o "$folder/m.png" --size 512 --view paper --depth-out "$folder/m.exr" > /dev/null
    "$vog" compare "$folder/exact.exr" "$folder/m.exr" --json > "$folder/compare.json"
    python3 - "$folder" "$1" "$3" << 'PYTHON'
import json, sys
folder, volume, options = sys.argv[1:]
made = json.load(open(folder + "/convert.json"))
seen = json.load(open(folder + "/compare.json"))
print(f"| {volume} | `{options}` | {made['gaussians']:,} | {100 * made['share']:.2f} % | "
      f"{seen['psnr_v_db']:.2f} dB | {seen['relative_l2']:.4f} | "
      f"{made['mean_error']:.4f} | {made['measured_error']:.4f} |", flush=True)
PYTHON
}

echo "| data | cells | Gaussians | share | PSNR of V | L2 of T | mean of 12 views | worst |"
echo "|---|---|---|---|---|---|---|---|"
while read -r volume coarse middle fine grid; do
    # shellcheck disable=SC2086
    "$vog" render "$data/$volume.vdb" $grid -o "$folder/r.png" --size 512 --view paper \
        --depth-out "$folder/exact.exr" > /dev/null
    for cells in "--block 8" "--block 4" "--block 2"; do row "$volume" "$grid" "$cells"; done
    for count in "$coarse" "$middle" "$fine"; do row "$volume" "$grid" "--budget $count${*:+ $*}"; done
done << 'VOLUMES'
smoke 3148 19936 141652
cloud 1247 7482 50708
aquarius 3158 22738 166748
fire 922 5061 27691 --grid flames
VOLUMES
