#!/usr/bin/env bash
# Conversion of data larger than memory: a cloud of size N (vog sample) and (N / 4)^3 particles, in memory and
# with --memory, one after the other. Prints wall time and peak memory (by the kernel) as a Markdown table.
#
# usage: bench/memory.sh [VOG, default build/release/apps/cli/vog] [N, default 1024] [FOLDER for data, default a
# temporary one]
set -euo pipefail
vog=$(realpath "${1:-build/release/apps/cli/vog}")
size=${2:-1024}
if [[ -n ${3:-} ]]; then
    mkdir -p "$3"
    cd "$3"
else
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
    cd "$folder"
fi
[[ -f cloud$size.vdb ]] || "$vog" sample cloud "cloud$size.vdb" --size "$size" >&2
[[ -f particles$size.xyz ]] || "$vog" sample particles "particles$size.xyz" --size $((size / 4)) >&2

convert() {  # input, options; prints "seconds megabytes" of the faster of two runs
    local best='' report
    for _ in 1 2; do
        report=$("$vog" convert "$@" -o model.ply --json 2>/dev/null | python3 -c '
import json, sys
report = json.load(sys.stdin)
print("%.2f %.0f" % (sum(report["ms"].values()) / 1e3, report["peak_memory"] / 1e6))')
        if [[ -z $best ]] || awk "BEGIN{exit !(${report% *} < ${best% *})}"; then best=$report; fi
    done
    echo "$best"
}

echo "| input | cut | in memory | | \`--memory\` | | | time, ratio to in memory |"
echo "|---|---|---|---|---|---|---|---|"
while read -r input memory cut; do
    read -r free_s free_mb <<<"$(convert "$input" $cut)"
    cp model.ply free.ply
    read -r bound_s bound_mb <<<"$(convert "$input" $cut --memory "$memory" --set scratch=.)"
    cmp model.ply free.ply >&2  # fails unless the models are the same bytes
    ratio=$(awk "BEGIN{printf \"%.2f\", $bound_s / $free_s}")
    echo "| \`$input\` | \`${cut:---error 0.03}\` | $free_s s | $free_mb MB | $memory | $bound_s s | $bound_mb MB | ${ratio}x |"
done <<CASES
cloud$size.vdb 2G --block 2
cloud$size.vdb 2G --block 4
cloud$size.vdb 300M --block 4
cloud$size.vdb 2G --budget 300000
cloud$size.vdb 700M --budget 300000
cloud$size.vdb 2G
particles$size.xyz 700M --no-hierarchy
particles$size.xyz 700M --budget 160000
CASES
