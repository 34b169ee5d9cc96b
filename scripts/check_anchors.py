#!/usr/bin/env python3
"""Checks a site's links: every file, picture and heading that a page links to is there. check_anchors.py FOLDER"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Links and ids of a page."""

    def __init__(self, file):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(file.read_text())

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.ids.update(value for key, value in attributes if key in ("id", "name") and value)
        link = named.get("href") if tag == "a" else named.get("src") if tag == "img" else None
        if link:
            self.links.append(link)


def main(folder):
    site = Path(folder).resolve()
    # Pages that vog itself writes are one file with scripts.
    files = [file for file in site.rglob("*.html") if "pages" not in file.relative_to(site).parts]
    pages = {file: Page(file) for file in files}
    faults = []
    for file, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if target.is_dir():
                target = target / "index.html"
            if not target.exists():
                faults.append(f"{file.relative_to(site)}: {link}: no such file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                faults.append(f"{file.relative_to(site)}: {link}: no such heading")
    for fault in faults:
        print(fault)
    print(f"links: {sum(len(page.links) for page in pages.values())} in {len(pages)} pages, {len(faults)} broken")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
