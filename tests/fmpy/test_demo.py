"""The demo of gear and hydraulic actuator: each scheme has its measured accuracy; the demo writes table and plot."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import FMU_FOLDER, REPOSITORY

SCRIPT = REPOSITORY / "fmu-build" / "python" / "demo_hydraulic.py"
ERRORS = {
    "preview, mean force held": (1e-5, 3e-3),
    "preview, force with its rate": (2e-7, 2e-4),
    "preview, two passes": (5e-9, 2e-5),
}
"""Allowed error of the angle [rad], and energy that the coupling may add [J] of 792 J, in steps of 1 ms."""
RETRACTION_TIME = 4.065842490726519
"""Time at which the gear is up [s], by an independent integration of gear and hydraulics as a single system."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """The output of the demo, and the folder with its files."""
    out = tmp_path_factory.mktemp("demo")
    names = ("LandingGearRetraction", "HydraulicActuator", "LandingGearRetractionHydraulic")
    fmus = [str(FMU_FOLDER / f"{name}.fmu") for name in names]
    command = [sys.executable, str(SCRIPT), *fmus, "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout, out


@pytest.mark.parametrize("scheme", ERRORS)
def test_each_preview_has_its_stated_accuracy(made: tuple[str, Path], scheme: str) -> None:
    number = r"(\S+)"
    line = (
        rf"{scheme} +up after {number} s +largest errors {number} rad, \S+ N, energy created by the coupling {number} J"
    )
    found = re.search(line, made[0])
    assert found, made[0]
    time, angle, energy = map(float, found.groups())
    # Error of the angle divided by the speed of 0.13 rad/s, and the error of the extrapolation over the last 0.5 ms.
    assert time == pytest.approx(RETRACTION_TIME, abs=1e-8 + ERRORS[scheme][0] / 0.13)
    assert 0.0 < angle <= ERRORS[scheme][0]
    assert 0.0 < energy <= ERRORS[scheme][1]


def test_the_whole_system_is_the_reference(made: tuple[str, Path]) -> None:
    """All errors refer to the single system."""
    found = re.search(r"as one system +differs from the reference by (\S+) rad, (\S+) N", made[0])
    assert found, made[0]
    assert float(found[1]) < 1e-11
    assert float(found[2]) < 1e-5


def test_a_plain_exchange_is_worse_by_far(made: tuple[str, Path]) -> None:
    found = re.search(r"plain exchange.*largest errors (\S+) rad", made[0])
    assert found, made[0]
    assert float(found[1]) > 1e-4


def test_table_and_plot_are_written(made: tuple[str, Path]) -> None:
    with (made[1] / "hydraulic.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4066
    assert float(rows[1000]["crank.angle"]) == pytest.approx(0.253250298772210, abs=1e-5)
    assert abs(float(rows[-1]["interface_energy"])) < 3e-3
    assert (made[1] / "hydraulic.png").read_bytes().startswith(b"\x89PNG\r\n")
