#!/usr/bin/env bash
# Builds the documents as a site of static pages with a search in build/site: scripts/docs.sh. Links and headings are checked.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install-deps.sh docs
mkdocs build --quiet --clean
rm build/site/404.html  # for servers alone: its links begin at their root
scripts/check_anchors.py build/site
echo "docs: build/site/index.html, $(find build/site -name '*.html' | wc -l) pages"
