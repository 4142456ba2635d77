"""Every command, program and JSON block of the documentation does what the page says."""

from __future__ import annotations

import json
from pathlib import Path

import pages
import pytest
from conftest import FMU_FOLDER, REPOSITORY

DOCS = REPOSITORY / "docs"
PAGES = [
    REPOSITORY / "README.md",
    DOCS / "index.md",
    *sorted(page for kind in ("tutorials", "how-to", "reference", "explanation") for page in (DOCS / kind).glob("*.md")),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}/{page.stem}")
def test_a_page_runs(page: Path, tmp_path: Path) -> None:
    pages.run(page, tmp_path, FMU_FOLDER)


def test_the_tutorial_ends_with_the_example(tmp_path: Path) -> None:
    """Whoever follows the tutorial of the landing gear has the file of the repository in the end."""
    written: dict[str, object] = {}
    for block in pages.blocks((DOCS / "tutorials" / "landing-gear.md").read_text(encoding="utf-8")):
        if block.title == "gear.json":
            written = json.loads(block.body)
        elif block.title == "add to gear.json":
            pages.merge(written, json.loads(block.body))
    example = REPOSITORY / "modelDescription" / "MainGear" / "resources" / "mechanism.json"
    kept = json.loads(example.read_text(encoding="utf-8"))
    kept.pop("$schema")
    assert written == kept


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("time 0.132 s", "time 0.13206 s", True),
        ("time 0.132 s", "time 0.1341 s", False),
        ("a ...", "a b 2", True),
        ("a c ...", "a b 2", False),
        ("3 joints", "4 joints", False),
        ("1.2e-3", "1.25e-3", True),
    ],
)
def test_numbers_are_held_to_the_last_digit_shown(shown: str, printed: str, same: bool) -> None:
    assert pages.agree(shown, printed) == same
