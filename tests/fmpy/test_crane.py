"""A multibody program with a HydraulicSystem FMU: errors of the crane's angles against both as one system."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, program

FOLDER = REPOSITORY / "examples" / "crane"
sys.path.append(str(FOLDER))
import crane  # noqa: E402

ERRORS = (
    (crane.HELD, 1e-3, 2e-6),
    (crane.HELD, 5e-3, 5e-5),
    (crane.CORRECTED, 10e-3, 3e-4),
    (crane.LINE, 1e-3, 8e-9),
    (crane.LINE, 5e-3, 3e-6),
    (crane.TWO_PASSES, 1e-3, 4e-10),
    (crane.TWO_PASSES, 5e-3, 8e-7),
    (crane.TWO_PASSES, 20e-3, 1e-3),
)
"""Scheme, communication step [s], allowed error of an angle [rad]: up to twice the measured error."""


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packed hydraulics of the crane."""
    out = tmp_path_factory.mktemp("crane")
    command = [*program("fmu-build"), "package", str(FOLDER / "network.json"), "--fmi", "2", "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900.0, check=False)
    assert done.returncode == 0, done.stderr
    return out / "CraneHydraulics.fmu"


@pytest.mark.parametrize(("scheme", "step", "allowed"), ERRORS)
def test_the_crane_moves_as_one_system(fmu: Path, scheme: str, step: float, allowed: float) -> None:
    assert 0 < crane.error(fmu, step, scheme) < allowed


def test_one_cylinder_is_not_limited_by_another(fmu: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crane, "ACTIVE", np.ones(2))
    monkeypatch.setattr(crane, "COMMANDS", dict(crane.COMMANDS))
    crane.remove_jib_cylinder()
    assert 0 < crane.error(fmu, 20e-3, crane.TWO_PASSES) < 1.3e-5


def test_a_plain_exchange_is_lost(fmu: Path) -> None:
    assert crane.error(fmu, 1e-3, crane.PLAIN) > 1e-4
    assert crane.error(fmu, 5e-3, crane.PLAIN) == float("inf")


def test_apparent_mass_and_load_are_those_of_the_accelerations() -> None:
    """m s'' = F - W. The apparent mass m is the force divided by the change of s'' that it causes."""
    q, w, forces = np.array([0.7, -1.1]), np.array([0.2, -0.3]), np.array([4e4, 2e4])

    def accelerations(forces: np.ndarray) -> np.ndarray:
        _, j, j_q = crane.lengths(q)
        return j * crane.acceleration(q, w, forces) + j_q * w**2

    mass, load = crane.elements(q, w, forces)
    np.testing.assert_allclose(mass * accelerations(forces), forces - load, rtol=1e-10)
    for one in range(2):
        change = accelerations(forces + 1e3 * np.eye(2)[one]) - accelerations(forces)
        assert mass[one] == pytest.approx(1e3 / change[one], rel=1e-9)
