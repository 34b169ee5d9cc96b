#!/usr/bin/env bash
# Tests a wheel: scripts/test_wheel.sh WHEEL [PYTHON]. Wheels of Python 3.11 and 3.13 on a bare Debian 12 and 13 (scripts/bare_system.sh), which have
# these Pythons, pip and nothing of ours; others with PYTHON, in a virtual environment on this machine.
set -euo pipefail
cd "$(dirname "$0")/.."

wheel=$1 python=${2:-}
skip() { echo "wheel: test skipped: $1"; exit 0; }
# Debian's Embree, with kernels of five instruction sets for all kinds of geometry, is half of it.
most=35000000
size=$(stat -c %s "$wheel")
[[ $size -le $most ]] || { echo "wheel: $size bytes, expected at most $most"; exit 1; }
tag=$(basename "$wheel" | cut -d- -f3)
work=$(mktemp -d)
trap 'umount "$work/system/proc" 2>/dev/null || true; rm -rf "$work"' EXIT

system=
case $tag in
    cp311) system=bookworm ;;
    cp313) system=trixie ;;
esac
root=$work
if [[ -n $system ]]; then
    status=0
    reason=$(scripts/bare_system.sh "$system" "$work/system") || status=$?
    if [[ $status -eq 0 ]]; then
        root=$work/system
    elif [[ $status -eq 3 ]]; then
        echo "wheel: no bare system: $reason"
        system=
    else
        echo "$reason"
        exit 1
    fi
fi
[[ -n $system || -n $python ]] || skip "no interpreter for $tag"

mkdir "$root/wheels"
cp "$wheel" scripts/try_wheel.py "$root/wheels"
loader=${python:-/usr/bin/python3}
"$loader" -m pip download --quiet --disable-pip-version-check --only-binary :all: --python-version "${tag:2:1}.${tag:3}" --implementation cp \
    -d "$root/wheels" numpy 2>"$work/log" || skip "pip has no NumPy ($(tail -1 "$work/log"))"
if [[ -n $system ]]; then
    echo "wheel: $tag on a bare $system"
    mount --bind /proc "$root/proc" 2>/dev/null || true
    chroot "$root" env -i PATH=/usr/bin:/bin HOME=/root LANG=C.UTF-8 python3 /wheels/try_wheel.py /wheels /out
else
    echo "wheel: $tag with $python"
    env -i PATH=/usr/bin:/bin HOME="$work" LANG=C.UTF-8 "$python" "$root/wheels/try_wheel.py" "$root/wheels" "$root/out"
fi
# Beside other copies of its libraries, which this machine has.
if [[ -n $python ]]; then
    for each in "$root"/wheels/*.whl; do "$python" -m zipfile -e "$each" "$work/beside"; done
    "$python" scripts/try_wheel.py --beside "$work/beside"
fi
# The pages draw in a browser.
if command -v chromium >/dev/null; then
    for page in cloud fire; do python3 tests/web/draws.py "$root/out/$page.html"; done
fi
echo "wheel: $tag works"
