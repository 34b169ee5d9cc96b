#!/usr/bin/env bash
# Tests a wheel on a bare Debian 12, made by debootstrap with python3 and pip alone: scripts/test_wheel.sh WHEEL
set -euo pipefail
cd "$(dirname "$0")/.."

wheel=$1
skip() { echo "wheel: test skipped: $1"; exit 0; }
[[ $(id -u) -eq 0 ]] || skip "needs root"
command -v debootstrap >/dev/null || apt-get install -y -qq --no-install-recommends debootstrap >/dev/null 2>&1 || skip "no debootstrap"
bare=$(mktemp -d)
trap 'rm -rf "$bare"' EXIT
mirror=$({ grep -rhE '^(URIs:|deb )' /etc/apt 2>/dev/null || true; } | { grep -oE 'https?://[^ ]+/debian/?( |$)' || true; } | awk 'NR == 1 {print $1}')
debootstrap --variant=minbase --include=python3,python3-pip,python3-venv bookworm "$bare" "${mirror:-http://deb.debian.org/debian}" >/tmp/vog-debootstrap.log 2>&1 ||
    skip "debootstrap cannot make a system ($(tail -1 /tmp/vog-debootstrap.log))"
mkdir "$bare/wheels"
cp "$wheel" "$bare/wheels"
/usr/bin/python3 -m pip download --quiet --disable-pip-version-check --only-binary :all: -d "$bare/wheels" numpy 2>/dev/null || skip "pip has no NumPy"
mount --bind /proc "$bare/proc" 2>/dev/null || mkdir -p "$bare/proc"
trap 'umount "$bare/proc" 2>/dev/null; rm -rf "$bare"' EXIT
chroot "$bare" /bin/bash -euo pipefail -c '
export LANG=C.UTF-8 HOME=/root
python3 -m venv /venv
/venv/bin/pip install --quiet --no-index --find-links /wheels vog
cd /root
cat >first.py <<PYTHON
import time
start = time.perf_counter()
import numpy
numpy_s = time.perf_counter() - start
import vog
print(f"import: {time.perf_counter() - start:.2f} s, of it NumPy {numpy_s:.2f} s")
model = vog.convert(vog.sample_cloud(64), block=4)
vog.render(model, size=256).shade("inferno").save("cloud.png")
vog.render(model, size=64, renderer="trace")
page = vog.show(model, live=False)
page.save("cloud.html")
print(f"first picture and page: {time.perf_counter() - start:.1f} s")
PYTHON
/venv/bin/python first.py   # compiles what Python caches
/venv/bin/python first.py
/venv/bin/vog --version
/venv/bin/vog sample fire fire.vdb --size 64
/venv/bin/vog convert fire.vdb --grid density --field temperature -o fire.ply --block 4 >/dev/null
/venv/bin/vog render fire.ply -o fire.png --size 200
/venv/bin/vog export fire.ply -o fire.html >/dev/null
/venv/bin/vog doctor | head -6
ls /venv/lib/python3*/site-packages/vog/licenses | wc -l
'
cp "$bare/root/fire.html" "$bare/root/cloud.png" /tmp/
# The page opens in a browser.
if command -v chromium >/dev/null; then
    chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=20000 --screenshot=/tmp/vog-wheel-page.png \
        --window-size=400,300 file:///tmp/fire.html >/dev/null 2>&1
    [[ $(stat -c %s /tmp/vog-wheel-page.png) -gt 5000 ]] || { echo "wheel: the page is blank"; exit 1; }
fi
echo "wheel: works on a bare system"
