"""Hooks of the site: pages that stand elsewhere in the repository, and links that lead out of `docs/`.

Links in Markdown are those of the repository, so that they work in an editor and on a forge too. On the site they lead
to the page; a link to a file that the site does not have becomes its text.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from urllib.parse import urlsplit

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
#: Pages and files of the repository outside `docs/`, with their place on the site.
ELSEWHERE = {
    "modelDescription/mechanism.schema.json": "reference/mechanism.schema.json",
    "modelDescription/hydraulics.schema.json": "reference/hydraulics.schema.json",
    "modelDescription/network.schema.json": "reference/network.schema.json",
    "modelDescription/study.schema.json": "reference/study.schema.json",
    "modelDescription/system.schema.json": "reference/system.schema.json",
    "ARCHITECTURE.md": "contributing/architecture.md",
    "CONTRIBUTING.md": "contributing/index.md",
    "SECURITY.md": "contributing/security.md",
    "CHANGELOG.md": "contributing/changes.md",
}
PLACES = {place: path for path, place in ELSEWHERE.items()}
#: Pages of the repository that lead to a page of the site, which stands for them.
MOVED = {
    "modelDescription/FORMAT.md": "reference/mechanism/index.md",
    "modelDescription/HYDRAULICS.md": "reference/hydraulics/index.md",
    "modelDescription/STUDY.md": "reference/study.md",
}
#: README.md becomes the front page's neighbour, not a page: links to it lead to the front page.
FRONT = {"README.md": "index.md", **MOVED}
CODE = re.compile(r"(```.*?```|`[^`\n]*`)", re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the files that stand elsewhere."""
    for path, place in ELSEWHERE.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / path)))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links of the repository into links of the site."""
    place = page.file.src_uri
    source = PLACES.get(place, f"docs/{place}")

    def link(found: re.Match[str]) -> str:
        mark, text, target = found.groups()
        parts = urlsplit(target)
        if parts.scheme or not parts.path:
            return found[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), parts.path))
        wanted = ELSEWHERE.get(path) or FRONT.get(path) or path.removeprefix("docs/")
        if files.get_file_from_path(wanted) is not None:
            anchor = f"#{parts.fragment}" if parts.fragment else ""
            return f"{mark}[{text}]({posixpath.relpath(wanted, posixpath.dirname(place) or '.')}{anchor})"
        return text if (ROOT / path).exists() and not mark else found[0]

    pieces = CODE.split(markdown)
    return "".join(piece if index % 2 else LINK.sub(link, piece) for index, piece in enumerate(pieces))
