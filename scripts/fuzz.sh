#!/usr/bin/env bash
# Searches for inputs that break a property of a reader, a writer or the conversion (docs/reliability.md), by
# Clang's libFuzzer under the address and undefined-behaviour sanitizers. Starts from the inputs in
# tests/fuzz/kept and from samples; finds stay in build/fuzz/corpus, an input that breaks a property in
# build/fuzz/broken. Exits with 1 if there is one.
#
# usage: scripts/fuzz.sh [TARGET|all] [SECONDS] [SEED]
# defaults: all targets, 20 seconds each, two at a time; seed 0, another search each time
set -euo pipefail
cd "$(dirname "$0")/.."

target=${1:-all} seconds=${2:-20} seed=${3:-0}
if [[ $target == all ]]; then
    targets=()
    for source in tests/fuzz/*_fuzz.cpp; do targets+=("$(basename "$source" _fuzz.cpp)"); done
elif [[ -f tests/fuzz/${target}_fuzz.cpp ]]; then
    targets=("$target")
else
    echo "fuzz: no target '$target', expected all or one of:" tests/fuzz/*_fuzz.cpp | sed 's|tests/fuzz/||g; s|_fuzz.cpp||g' >&2
    exit 2
fi
scripts/build.sh sanitize -DVOG_WERROR=ON

folder=build/fuzz programs=build/sanitize/tests/fuzz
mkdir -p "$folder"/{corpus,broken,logs}
for name in "${targets[@]}"; do mkdir -p "$folder/corpus/$name"; done
"$programs/vog_fuzz_seeds" "$folder/corpus"
vog=${VOG_COMMAND:-build/release/apps/cli/vog}
if [[ -x $vog ]]; then
    tests/fuzz/seeds.sh "$vog" "$folder/corpus"
else
    echo "fuzz: no $vog (VOG_COMMAND): without samples" >&2
fi

search() {  # target, seconds, seed
    local name=$1 folder=build/fuzz dictionary=tests/fuzz/dictionaries/$1.dict options=()
    [[ -f $dictionary ]] && options+=("-dict=$dictionary")
    mkdir -p "tests/fuzz/kept/$name"
    # A timeout is of wall-clock time on a busy machine; the target itself limits the processor's time.
    if "build/sanitize/tests/fuzz/${name}_fuzz" -seed="$3" -max_total_time="$2" -timeout=60 -rss_limit_mb=2048 -malloc_limit_mb=8192 -max_len=16384 \
        -print_final_stats=1 -artifact_prefix="$folder/broken/$name-" "${options[@]}" \
        "$folder/corpus/$name" "tests/fuzz/kept/$name" >"$folder/logs/$name.log" 2>&1; then
        awk -v name="$name" '/number_of_executed_units/ {n = $2} /cov: / {for (i = 1; i < NF; ++i) if ($i == "cov:") c = $(i + 1)}
            END {printf "fuzz: %-18s %9d executions, %d edges\n", name, n, c}' "$folder/logs/$name.log"
    else
        echo "fuzz: $name breaks a property; the input is in $folder/broken, the end of the log:"
        tail -n 40 "$folder/logs/$name.log"
        return 1
    fi
}
export -f search
export ASAN_OPTIONS=${ASAN_OPTIONS:-allocator_may_return_null=0} UBSAN_OPTIONS=print_stacktrace=1
printf '%s\n' "${targets[@]}" | xargs -P 2 -I{} bash -c 'search "$1" "$2" "$3"' search {} "$seconds" "$seed"
