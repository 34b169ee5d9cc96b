#!/usr/bin/env bash
# Strong and weak scaling of vog-mpi with one thread per rank, as Markdown tables of median times of three
# runs. Fails unless models and T of every run equal those of one rank.
# usage: bench/mpi.sh [FOLDER for data] [SIZE, largest]
# On a machine with other load: chrt -r 5 bench/mpi.sh (real-time priority).
set -euo pipefail
cd "$(dirname "$0")/.."

vog=$PWD/build/release/apps/cli/vog vog_mpi=$PWD/build/release/apps/mpi/vog-mpi
data=${1:-$(mktemp -d)} size=${2:-512}
mkdir -p "$data"
cd "$data"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
run() { mpirun --oversubscribe -n "$1" "$vog_mpi" "${@:2}" --threads 1 --json; }
sample() { [[ -f $1.vdb ]] || "$vog" sample cloud "$1.vdb" --size "$1"; }

# value FILE KEY...: one number of a JSON report
value() { python3 -c 'import json, sys
at = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: at = at[key]
print(at)' "$@"; }

measure() {  # ranks, volume; prints a row: times of load, convert, save and render, ms
    local ranks=$1 volume=$2 n
    for n in 1 2 3; do
        run "$ranks" convert "$volume.vdb" -o "m$ranks.ply" --block 4 --no-hierarchy >"c$n.json"
        for stage in load convert save; do value "c$n.json" ms $stage >>"$stage.ms"; done
    done
    run "$ranks" render "$volume.vdb" --extinction 1 --depth-out "t$ranks.exr" --repeat 3 >r.json
    echo "| $ranks | $volume | $(value c1.json active_voxels) | $(for stage in load convert save; do
        sort -g "$stage.ms" | sed -n 2p | xargs printf '%.0f | '; done)$(value r.json render_ms median | xargs printf '%.0f') |"
    rm -f ./*.ms
}

echo "Strong scaling, cloud of size $size; times of the root rank in ms"
echo '| ranks | size | active voxels | load | convert | save | render |'
echo '|---|---|---|---|---|---|---|'
sample "$size"
for ranks in 1 2 4; do
    measure "$ranks" "$size"
    [[ $ranks -eq 1 ]] && continue
    cmp m1.ply "m$ranks.ply"
    "$vog" compare t1.exr "t$ranks.exr" --json >d.json
    python3 -c 'import sys; sys.exit(not float(sys.argv[1]) < 1e-6)' "$(value d.json relative_l2)" ||
        { echo "T of $ranks ranks differs" >&2; exit 1; }
done
echo
echo 'Weak scaling: equal voxels per rank; times of the root rank in ms'
echo '| ranks | size | active voxels | load | convert | save | render |'
echo '|---|---|---|---|---|---|---|'
for ranks in 1 2 4; do
    # The number of voxels grows with the cube of the size.
    edge=$(python3 -c 'import sys; print(round(int(sys.argv[1]) * (int(sys.argv[2]) / 4) ** (1 / 3) / 8) * 8)' "$size" "$ranks")
    sample "$edge"
    measure "$ranks" "$edge"
done
