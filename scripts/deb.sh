#!/usr/bin/env bash
# Makes a Debian package of the release build and installs it on a bare Debian 12: scripts/deb.sh [--no-test]. The package is written to ./dist.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh release
mkdir -p dist
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
cpack -G DEB --config build/release/CPackConfig.cmake -B "$made" >"$made/log" || { cat "$made/log"; exit 1; }
package=$(basename "$made"/*.deb)
cp "$made/$package" dist
echo "deb: dist/$package, $(stat -c %s "dist/$package") bytes"
[[ ${1:-} == --no-test ]] && exit 0

skip() { echo "deb: test skipped: $1"; exit 0; }
[[ $(id -u) -eq 0 ]] || skip "needs root"
command -v debootstrap >/dev/null || apt-get install -y -qq --no-install-recommends debootstrap >/dev/null 2>&1 || skip "no debootstrap"
mirror=$({ grep -rhE '^(URIs:|deb )' /etc/apt 2>/dev/null || true; } | { grep -oE 'https?://[^ ]+/debian/?( |$)' || true; } | awk 'NR == 1 {print $1}')
debootstrap --variant=minbase bookworm "$made/bare" "${mirror:-http://deb.debian.org/debian}" >"$made/log" 2>&1 ||
    skip "debootstrap cannot make a system ($(tail -1 "$made/log"))"
cp "dist/$package" "$made/bare/root/vog.deb"
cp /etc/resolv.conf "$made/bare/etc/" 2>/dev/null || true
chroot "$made/bare" /bin/bash -euo pipefail -c '
export LANG=C.UTF-8 HOME=/root DEBIAN_FRONTEND=noninteractive
cd /root
apt-get install -y -qq --no-install-recommends ./vog.deb >/dev/null 2>log || { tail -3 log; exit 1; }
vog --version
vog sample cloud cloud.vdb --size 64
vog convert cloud.vdb -o cloud.ply --block 4 >/dev/null
vog render cloud.ply -o cloud.png --size 200
test -s cloud.png -a -f /usr/share/man/man1/vog-render.1 -a -f /usr/share/bash-completion/completions/vog
'
echo "deb: works on a bare system"
