#!/bin/sh
# volume_quality.sh: the table of docs/volume_rendering.md: models rendered by value against the voxels themselves,
# PSNR of RGB over black under three transfer functions (a ramp, three narrow bands, an opaque step) from seven views
# three radii away at 384x384, and the depth slabs against exact order; the voxels interpolated against constant ones likewise:
# two honest readings of the data.
#
# usage: bench/volume_quality.sh VOG DATA_FOLDER
set -eu
if [ $# -ne 2 ]; then
    echo "usage: $0 VOG DATA_FOLDER" >&2
    exit 2
fi
vog=$1 data=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

functions() {  # upper end of the functions' range, bounding radius: writes ramp.json, bands.json, step.json
    python3 - "$folder" "$1" "$2" << 'PYTHON'
import json, math, sys
folder, high, radius = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
unit = radius / 12  # the ramp's extinction at the upper end is 12 a radius
band = lambda q, c, w: max(0.0, 1 - abs(q - c) / w)
def write(name, color, extinction, points):
    rows = [q / (points - 1) for q in range(points)]
    opacity = [[high * q, min(1 - math.exp(-extinction(q)), 0.9999)] for q in rows]
    if name == "step":
        opacity = [[0, 0], [0.3 * high, 0], [0.3 * high, 0.9999], [high, 0.9999]]
    json.dump({"domain": [0, high], "unit_distance": unit, "colors": [[high * q, *color(q)] for q in rows],
               "opacity": opacity}, open(f"{folder}/{name}.json", "w"))
write("ramp", lambda q: [min(1, 3 * q), min(max(3 * q - 1, 0), 1), min(max(3 * q - 2, 0), 1)], lambda q: q, 301)
def bands(q):
    a, c, d = .15 * band(q, .12, .05), .6 * band(q, .45, .08), 2 * band(q, .85, .15)
    s = a + c + d
    return s, [(a * .2 + c + d) / s, (a * .5 + c * .6 + d * .95) / s, (a + c * .1 + d * .8) / s] if s else [0, 0, 0]
write("bands", lambda q: bands(q)[1], lambda q: 2 * bands(q)[0], 1001)
write("step", lambda q: [q, 1 - q, .5], lambda q: 0, 2)
PYTHON
}

picture() {  # input, function, view, output, options
    input=$1 tf=$2 view=$3 output=$4
    shift 4
    "$vog" render "$input" --show volume --tf "$folder/$tf.json" --view "$view" --distance 3 --size 384 --background black \
        -o "$output" "$@" > /dev/null 2> "$folder/log" || { cat "$folder/log" >&2; exit 1; }
}
psnr() { "$vog" compare "$1" "$2" --json | python3 -c 'import json,sys; print(json.load(sys.stdin)["psnr_rgb_db"])'; }

row() {  # data, Gaussians, function: the row of the figures of seven views and, of models, of slabs
    python3 - "$1" "$2" "$3" "$folder/figures" << 'PYTHON'
import sys
volume, count, tf, file = sys.argv[1:]
figures = [float(line) for line in open(file)]
views, slabs = figures[:7], [f"{figure:.1f} dB" for figure in figures[7:]]
print(f"| {volume} | {int(count) if count.isdigit() else count:{',' if count.isdigit() else ''}} | {tf} | {views[0]:.1f} dB | "
      f"{sum(views) / len(views):.1f} dB | {min(views):.1f} dB | {slabs[0] if slabs else ''} |", flush=True)
PYTHON
}

echo "| data | Gaussians | function | paper | mean of seven views | worst | 32 slabs against exact order, paper |"
echo "|---|---|---|---|---|---|---|"
while read -r volume high radius counts; do
    functions "$high" "$radius"
    for tf in ramp bands step; do
        for view in paper +x -x +y -y +z -z; do
            picture "$data/$volume.vdb" $tf $view "$folder/$tf$view.png"
            picture "$data/$volume.vdb" $tf $view "$folder/linear.png" --interpolation linear
            psnr "$folder/$tf$view.png" "$folder/linear.png"
        done > "$folder/figures"
        row "$volume" "interpolated voxels" "$tf"
    done
    for count in $counts; do
        "$vog" convert "$data/$volume.vdb" -o "$folder/m.ply" --budget "$count" --no-hierarchy > /dev/null 2>&1
        for tf in ramp bands step; do
            for view in paper +x -x +y -y +z -z; do
                picture "$folder/m.ply" $tf $view "$folder/m.png"
                psnr "$folder/$tf$view.png" "$folder/m.png"
                if [ $view = paper ]; then cp "$folder/m.png" "$folder/slabs.png"; fi
            done > "$folder/figures"
            picture "$folder/m.ply" $tf paper "$folder/exact.png" --renderer trace
            psnr "$folder/exact.png" "$folder/slabs.png" >> "$folder/figures"
            row "$volume" "$count" "$tf"
        done
    done
done << 'VOLUMES'
smoke 4.13672 64.83 3000 19900
beetle 0.766568 95.1 9900
VOLUMES
