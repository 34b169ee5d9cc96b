#!/usr/bin/env bash
# Volumes larger than memory: `vog sample cloud --size N` converted in memory and under --memory, one after
# the other: wall time and the most memory held, measured by the kernel. Prints a Markdown table.
#
# usage: bench/memory.sh [VOG, default build/release/apps/cli/vog] [SIZE, default 1024] [FOLDER for data, default
# a temporary one]
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

convert() {  # options: "seconds megabytes" of the faster of two runs
    local best='' report
    for _ in 1 2; do
        report=$("$vog" convert "cloud$size.vdb" -o model.ply --json "$@" 2>/dev/null | python3 -c '
import json, sys
report = json.load(sys.stdin)
print("%.2f %.0f" % (sum(report["ms"].values()) / 1e3, report["peak_memory"] / 1e6))')
        if [[ -z $best ]] || awk "BEGIN{exit !(${report% *} < ${best% *})}"; then best=$report; fi
    done
    echo "$best"
}

echo "| cut of \`cloud$size\` | in memory | | \`--memory\` | | | time against in memory |"
echo "|---|---|---|---|---|---|---|"
while read -r memory cut; do
    read -r free_s free_mb <<<"$(convert $cut)"
    cp model.ply free.ply
    read -r bound_s bound_mb <<<"$(convert $cut --memory "$memory" --scratch .)"
    cmp model.ply free.ply >&2  # the same bytes, or an error
    ratio=$(awk "BEGIN{printf \"%.2f\", $bound_s / $free_s}")
    echo "| \`${cut:---error 0.03}\` | $free_s s | $free_mb MB | $memory | $bound_s s | $bound_mb MB | ${ratio}x |"
done <<'CASES'
2G --block 2
2G --block 4
300M --block 4
2G --budget 300000
700M --budget 300000
2G
CASES
