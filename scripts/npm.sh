#!/usr/bin/env bash
# Packs the npm package vog-view of the files that were built: scripts/npm.sh [build folder] [folder of the package].
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build/release} into=$(mkdir -p "${2:-.}" && realpath "${2:-.}")
package=$(mktemp -d)
trap 'rm -rf "$package"' EXIT
version=$(sed -n 's/^project(vog VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
cp "$build/share/vog/vog-view.js" src/web/page/view/vog-view.d.ts LICENSE "$package"
cp docs/web_element.md "$package/README.md"
cat >"$package/package.json" <<END
{
  "name": "vog-view",
  "version": "$version",
  "description": "The element <vog-view>: volumes as 3D Gaussians, turning in any page",
  "license": "Apache-2.0",
  "type": "module",
  "main": "vog-view.js",
  "types": "vog-view.d.ts",
  "exports": { ".": { "types": "./vog-view.d.ts", "default": "./vog-view.js" }, "./vog-view.js": "./vog-view.js" },
  "sideEffects": true
}
END
cd "$into" && npm pack --silent "$package"
