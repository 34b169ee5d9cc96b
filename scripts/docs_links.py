"""Links of the documents' site: what lies outside docs/ is named, not linked, and its files are checked to exist."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"(^```.*?^```)", re.M | re.S)


def outside(page_folder, target):
    """Whether a relative link leaves docs/. Raises FileNotFoundError for a file that is not there."""
    if re.match(r"[a-z]+:", target):
        return False
    file = (page_folder / target).resolve()
    if not file.exists():
        raise FileNotFoundError(f"{page_folder}: a link to {target}, expected a file of the clone")
    return not file.is_relative_to(DOCS) or file.is_dir()


def on_page_markdown(markdown, page, **_):
    """MkDocs calls this for every page before it is made."""
    folder = (DOCS / page.file.src_path).parent

    def link(found):
        image, text, target, _ = found.groups()
        if image or not outside(folder, target):
            return found.group(0)
        return text if text.startswith("`") else f"{text} (`{(folder / target).resolve().relative_to(DOCS.parent)}`)"

    # Fenced blocks are code.
    return "".join(part if part.startswith("```") else LINK.sub(link, part) for part in FENCE.split(markdown))
