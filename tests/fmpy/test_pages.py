"""Every command, program and JSON block of the documentation works as the page states."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pages
import pytest
from conftest import FMU_FOLDER, REPOSITORY

DOCS = REPOSITORY / "docs"
KINDS = ("tutorials", "how-to", "reference", "explanation")
PAGES = [
    REPOSITORY / "README.md",
    DOCS / "index.md",
    DOCS / "install.md",
    *sorted(page for kind in KINDS for page in (DOCS / kind).rglob("*.md") if page.name != "python.md"),
]
"""The pages about Python need the module. `tests/python` runs them."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}/{page.stem}")
def test_a_page_runs(page: Path, tmp_path: Path) -> None:
    pages.run(page, tmp_path, FMU_FOLDER)


def test_the_tutorial_ends_with_the_example(tmp_path: Path) -> None:
    """The tutorial of the landing gear leads to the definition file of the repository."""
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


def test_the_example_of_rust_is_compiled() -> None:
    """The page shows the example of the module, which the compiler compiles in every test run."""
    source = (REPOSITORY / "src" / "simulation.rs").read_text(encoding="utf-8")
    lines = [line.removeprefix("//!").removeprefix(" ") for line in source.splitlines() if line.startswith("//!")]
    start, end = lines.index("```no_run"), lines.index("```")
    shown = [line for line in lines[start + 1 : end] if not line.startswith("# ")]
    (block,) = [
        b for b in pages.blocks((DOCS / "how-to" / "rust.md").read_text(encoding="utf-8")) if b.language == "rust"
    ]
    assert block.body.splitlines() == shown


def test_every_command_has_its_line() -> None:
    """The page of the commands names all tasks of the command line."""
    source = (REPOSITORY / "fmu-build" / "cli" / "src" / "lib.rs").read_text(encoding="utf-8")
    tasks = re.search(r"pub enum Task \{(.*?)\n\}", source, re.DOTALL)
    assert tasks
    names = {task.lower() for task in re.findall(r"^    (\w+)(?:\(|,)", tasks[1], re.MULTILINE)}
    page = (DOCS / "reference" / "commands.md").read_text(encoding="utf-8")
    assert names <= set(re.findall(r"^\| `(\w+)", page, re.MULTILINE))


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
