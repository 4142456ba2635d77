"""The programs of docs/studies/examples, with few runs, in a separate environment."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

FOLDER = REPOSITORY / "docs" / "studies" / "examples"
ENVIRONMENT = REPOSITORY / "target" / "venv-examples"


@pytest.fixture(scope="module")
def python() -> Path:
    """The interpreter of an environment with the requirements. It is created again when they change."""
    requirements, stamp = FOLDER / "requirements.txt", ENVIRONMENT / "made-from.txt"
    own = ENVIRONMENT / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    wanted = requirements.read_text(encoding="utf-8")
    if not stamp.is_file() or stamp.read_text(encoding="utf-8") != wanted:
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(ENVIRONMENT)], check=True)
        install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement", str(requirements)]
        subprocess.run([str(own), *install], check=True)
        stamp.write_text(wanted, encoding="utf-8")
    return own


def said(python: Path, name: str, fmu: Path, count: str) -> str:
    """The output of a program."""
    command = [str(python), str(FOLDER / name), str(fmu), count]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(text: str) -> list[float]:
    """All numbers of a text."""
    return [float(number) for number in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", text)]


def test_salib_finds_the_force(python: Path, fmu: Path) -> None:
    force, load = said(python, "salib_sobol.py", fmu, "64").splitlines()
    first, total = numbers(force)
    assert 0.8 < first < 1.1
    assert 0.8 < total < 1.1
    assert all(abs(index) < 0.1 for index in numbers(load))


def test_scipy_finds_the_force_for_a_time(python: Path, fmu: Path) -> None:
    root, slowest = said(python, "scipy_optimize.py", fmu, "0.132").splitlines()
    force, time = numbers(root)
    assert time == pytest.approx(0.132, abs=1e-11)
    assert 28e3 < force < 36e3
    assert 0.0 <= numbers(slowest)[0] <= 6.0


def test_optuna_trades_mass_for_time(python: Path, fmu: Path) -> None:
    lines = said(python, "optuna_search.py", fmu, "60").splitlines()
    pairs = [tuple(numbers(line)[:2]) for line in lines]
    assert len(pairs) > 1
    # On the front, a larger mass takes longer.
    assert [mass for mass, _ in pairs] == sorted(mass for mass, _ in pairs)
    assert all(30.0 <= mass <= 90.0 and 0.05 < time < 0.6 for mass, time in pairs)


def test_dask_makes_a_grid(python: Path, fmu: Path) -> None:
    count, fastest, slowest = said(python, "dask_runs.py", fmu, "8").splitlines()
    assert numbers(count) == [64.0]
    assert 0.05 < numbers(fastest)[0] < numbers(slowest)[0] < 0.6
