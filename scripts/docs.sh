#!/usr/bin/env bash
# Builds the documents as a site of static pages with a search in build/site: scripts/docs.sh. Links and headings are checked.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install-deps.sh docs
mkdocs build --quiet --clean
rm build/site/404.html  # for servers alone: its links begin at their root
# The sample page, by the lines of docs/web.md that make it.
mkdir -p build/site/pages
if vog=$(command -v "${VOG_COMMAND:-build/release/apps/cli/vog}" || command -v vog); then
    made=$(mktemp -d)
    ln -s "$(realpath "$vog")" "$made/vog"
    sed -n '/^vog sample cloud /,/ --title /p' docs/web.md | (cd "$made" && PATH=$made:$PATH bash -e >/dev/null)
    mv "$made/cloud.html" build/site/pages/
    rm -r "$made"
else
    echo "docs: no vog command (scripts/build.sh, VOG_COMMAND): without the sample page of docs/web.md" >&2
    echo "<p>Left out: this site was built without a vog command.</p>" >build/site/pages/cloud.html
fi
scripts/check_anchors.py build/site
echo "docs: build/site/index.html, $(find build/site -name '*.html' | wc -l) pages"
