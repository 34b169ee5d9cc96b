#!/usr/bin/env bash
# Small valid files of every format, by `vog sample` and the other commands, for scripts/fuzz.sh.
#
# usage: tests/fuzz/seeds.sh VOG FOLDER     files go to FOLDER/TARGET
set -euo pipefail
vog=$1 folder=$2
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
mkdir -p "$folder"/{scan,points_text,ply,vogz,site,splats,image,camera,transfer_function,results,record,surface}

"$vog" sample cloud "$made/cloud.vdb" --size 64 >/dev/null
# The first byte of a text stands for its extension (points_text_fuzz.cpp).
format=0
for extension in xyz csv tsv; do
    "$vog" sample particles "$made/particles.$extension" --size 8 >/dev/null
    { printf "\\x0$format"; head -n 12 "$made/particles.$extension"; } >"$folder/points_text/$extension"
    format=$((format + 1))
done
"$vog" convert "$made/cloud.vdb" -o "$folder/ply/hierarchy.ply" --block 16 >/dev/null
"$vog" convert "$made/cloud.vdb" -o "$folder/ply/plain.ply" --block 32 --no-hierarchy >/dev/null
"$vog" convert "$made/cloud.vdb" -o "$folder/ply/aligned.ply" --block 16 --set axis-aligned=1 >/dev/null
# The first byte says how the rest is read: 0, as a file.
for options in "" --hierarchy --deflate; do
    "$vog" pack "$folder/ply/aligned.ply" -o "$made/model.vogz" $options >/dev/null
    { printf '\x00'; cat "$made/model.vogz"; } >"$folder/vogz/model$options"
done
# A site's manifest, its root as a table, and a chunk behind its length and number of Gaussians, less 1 and doubled.
"$vog" page "$folder/ply/aligned.ply" -o "$made/site/" >/dev/null
{ printf '\x00'; cat "$made/site/manifest.json"; } >"$folder/site/manifest"
{ printf '\x01'; sed 's/.*"root":\(.*\)}]}$/{"parts":[\1]}/' "$made/site/manifest.json"; } >"$folder/site/table"
chunk=$(ls "$made"/site/chunks/*.vogz)
length=$(stat -c %s "$chunk") count=$(sed 's/.*"gaussians":\([0-9]*\),"error":0.0,"box".*/\1/' "$made/site/manifest.json")
{ printf '\x02'; printf "\\x$(printf %02x $((length % 256)))\\x$(printf %02x $((length / 256)))\\x$(printf %02x $((2 * (count - 1))))"
    cat "$chunk" "${chunk%.vogz}.0"; } >"$folder/site/chunk"
format=0
for extension in stl obj ply; do
    "$vog" export "$made/cloud.vdb" --iso 0.6 -o "$made/surface.$extension" >/dev/null
    { printf "\\x0$format"; head -c 4000 "$made/surface.$extension"; } >"$folder/surface/$extension"
    format=$((format + 1))
done
for extension in spz glb usda; do
    "$vog" export "$folder/ply/plain.ply" -o "$made/model.$extension" >/dev/null
done
{ printf '\x00'; cat "$made/model.spz"; } >"$folder/splats/spz"
{ printf '\x01'; gzip -dc "$made/model.spz"; } >"$folder/splats/unpacked"
{ printf '\x02'; cat "$made/model.glb"; } >"$folder/splats/glb"
{ printf '\xf0'; cat "$made/model.usda"; } >"$folder/splats/usda"
"$vog" render "$folder/ply/plain.ply" -o "$folder/image/picture.png" --size 16 --depth-out "$folder/image/depth.exr" --json \
    >"$folder/camera/perspective.json"
"$vog" render "$folder/ply/plain.ply" --size 16 --show column --values-out "$folder/image/column.npy" >/dev/null
"$vog" render "$folder/ply/plain.ply" -o "$folder/image/picture.exr" --size 16 --orthographic --json \
    >"$folder/camera/orthographic.json"
cat >"$folder/transfer_function/own.json" <<'JSON'
{"name": "two", "colors": [[0, 0, 0, 0.5], [0.25, 0.5, 0, 0], [1, 1, 1, 1]], "opacity": [[0, 0], [1, 1]]}
JSON
cat >"$folder/transfer_function/paraview.json" <<'JSON'
[{"Name": "warm", "ColorSpace": "Diverging", "RGBPoints": [0, 0.2, 0.3, 0.8, 50, 0.9, 0.9, 0.9, 100, 0.7, 0, 0.1],
  "Points": [0, 0, 0.5, 0, 100, 1, 0.5, 0]}]
JSON
# Raw values behind a head: the first byte chooses them, two hold its length.
head='{"size": [2, 2, 2], "type": "uint16", "channels": 1, "skip": 1}'
{ printf '\xfa'; printf "\\x$(printf %02x ${#head})\x00"; printf '%s.abcdefghijklmnop' "$head"; } >"$folder/scan/raw"
cat >"$folder/results/index.json" <<'JSON'
{"vog_models": ["model.0.ply", "model.1.ply"]}
JSON
for show in T "volume --light head --clip 1,0,0,0" "maximum --background white"; do
    "$vog" render "$made/cloud.vdb" --show $show --size 8 -o "$made/record.png" >/dev/null
    "$vog" render --request "$made/record.png" -o "$folder/record/${show%% *}.exr" >/dev/null
    cp "$made/record.png" "$folder/record/${show%% *}.png"
done
