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

status=0
reason=$(scripts/bare_system.sh bookworm "$made/bare") || status=$?
[[ $status -eq 3 ]] && { echo "deb: test skipped: $reason"; exit 0; }
[[ $status -eq 0 ]] || { echo "$reason"; exit 1; }
# The last RUN of the Dockerfile installs it, as in the image.
cp "dist/$package" "$made/bare/tmp"
sed -n 's/^RUN //p' Dockerfile | tail -1 >"$made/bare/root/install.sh"
chroot "$made/bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive /bin/bash -euo pipefail -c '
cd /root
bash -e install.sh >log 2>&1 || { tail -3 log; exit 1; }
vog --version
vog sample cloud cloud.vdb --size 64
vog convert cloud.vdb -o cloud.ply --block 4 >/dev/null
vog render cloud.ply -o cloud.png --size 200
vog view cloud.ply 2>message && exit 1
grep -q "no display to open a window on" message
test -s cloud.png -a -f /usr/share/man/man1/vog-render.1 -a -f /usr/share/bash-completion/completions/vog
test -f /usr/share/zsh/site-functions/_vog -a -f /usr/share/fish/vendor_completions.d/vog.fish
test -f /usr/include/vog/vog.h -a -f /usr/share/doc/vog/copyright
apt-get remove -y -qq vog >log 2>&1 || { tail -3 log; exit 1; }
! test -e /usr/bin/vog
'
echo "deb: works on a bare system, and leaves it"
