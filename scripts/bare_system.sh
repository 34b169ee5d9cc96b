#!/usr/bin/env bash
# Makes a bare Debian with python3, pip and venv alone, for tests of packages: scripts/bare_system.sh RELEASE FOLDER.
# Kept for a week in build/bare, so that the next test needs no downloads. Needs root and debootstrap; exits with 3, and says why,
# where none can be made.
set -euo pipefail
cd "$(dirname "$0")/.."

release=$1 folder=$2
skip() { echo "$release: $1"; exit 3; }
[[ $(id -u) -eq 0 ]] || skip "needs root"
kept=build/bare/$release.tar
mkdir -p build/bare "$folder"
if [[ -z $(find "$kept" -mtime -7 2>/dev/null) ]]; then
    command -v debootstrap >/dev/null || apt-get install -y -qq --no-install-recommends debootstrap >/dev/null 2>&1 || skip "no debootstrap"
    mirror=$({ grep -rhE '^(URIs:|deb )' /etc/apt 2>/dev/null || true; } | { grep -oE 'https?://[^ ]+/debian/?( |$)' || true; } | awk 'NR == 1 {print $1}')
    made=$(mktemp -d)
    trap 'rm -rf "$made"' EXIT
    debootstrap --variant=minbase --include=python3,python3-pip,python3-venv "$release" "$made/system" "${mirror:-http://deb.debian.org/debian}" \
        >"$made/log" 2>&1 || skip "debootstrap cannot make a system ($(tail -1 "$made/log"))"
    rm -f "$made"/system/var/cache/apt/archives/*.deb
    tar -C "$made/system" -cf "$made/tar" .
    mv "$made/tar" "$kept"
fi
tar -C "$folder" -xf "$kept"
cp /etc/resolv.conf "$folder/etc/" 2>/dev/null || true
