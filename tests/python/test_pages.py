"""The pages of the documentation about Python work as they state. The reference agrees with the docstrings."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

import linkage_fmu as lf
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def module(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = found
    spec.loader.exec_module(found)
    return found


@pytest.mark.parametrize("page", ["how-to/python.md", "tutorials/python.md"])
def test_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pages = module(REPOSITORY / "tests" / "fmpy" / "pages.py")
    (tmp_path / "fmus").mkdir()
    (tmp_path / "here").mkdir()
    # Shells and their tools can be found, Rust cannot.
    monkeypatch.setenv("PATH", os.defpath)
    pages.run(REPOSITORY / "docs" / page, tmp_path / "here", tmp_path / "fmus")


def test_the_reference_is_that_of_the_docstrings() -> None:
    reference = module(Path(__file__).parent / "reference.py")
    written = reference.PAGE.read_text(encoding="utf-8")
    assert written == reference.page(), "run python tests/python/reference.py --write"
    for name in lf.__all__:
        assert name in written, name
