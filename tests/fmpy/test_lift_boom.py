"""The lift boom of a published crane: its holding force, its pressures, and its coupling against a single system."""

from __future__ import annotations

import subprocess
import sys
from math import pi
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, program

FOLDER = REPOSITORY / "examples" / "lift_boom"
sys.path.append(str(FOLDER))
import lift_boom  # noqa: E402

HOLDING_FORCE = 5632.52
"""Force that holds the boom at the start [N], according to the published model."""
K = 2.1597e-7
"""Flow of the open valve, divided by the root of the pressure drop [m3/(s sqrt(Pa))], according to the published model.
"""
SUPPLY, TANK = 10e6, 1e5
AREAS = (pi / 4 * 0.1**2, pi / 4 * (0.1**2 - 0.056**2))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the FMUs of boom and hydraulics."""
    out = tmp_path_factory.mktemp("lift boom")
    paths = [str(FOLDER / name) for name in ("mechanism.json", "network.json")]
    options = ["--fmi", "2", "--no-animation", "--out", str(out)]
    command = [*program("fmu-build"), "package", *paths, *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900.0, check=False)
    assert done.returncode == 0, done.stderr
    return out


def test_the_boom_has_the_published_weight(folder: Path) -> None:
    assert lift_boom.holding_force(folder) == pytest.approx(HOLDING_FORCE, abs=0.005)


@pytest.mark.parametrize("speed", [0.0725, -0.0638])
def test_pressures_at_constant_speed_are_those_of_the_published_law(folder: Path, speed: float) -> None:
    """Q = K sqrt(pressure drop) at both edges, plus the oil for a changing volume: none at constant pressure."""
    with lift_boom.Fmu(folder / "LiftBoomHydraulics.fmu") as oil:
        oil.set(valve__command=np.sign(speed), lift__reduced_mass=0.0, lift__length=1.0, lift__speed=speed)
        oil.slave.exitInitializationMode()
        for step in range(1000):
            oil.slave.doStep(step * 1e-3, 1e-3)
        found = oil.get("lift.chamber_a.pressure", "lift.chamber_b.pressure")
    drops = [(area * speed / K) ** 2 for area in AREAS]
    expected = (SUPPLY - drops[0], TANK + drops[1]) if speed > 0 else (TANK + drops[0], SUPPLY - drops[1])
    assert found == pytest.approx(expected, abs=140.0)


@pytest.mark.parametrize(("step", "angle", "pressure"), [(1e-3, 2e-6, 10.0), (5e-3, 5e-5, 1e3)])
def test_the_coupling_agrees_with_one_system(folder: Path, step: float, angle: float, pressure: float) -> None:
    errors = lift_boom.errors(lift_boom.couple(folder, step))
    assert errors[0] < angle
    assert max(errors[1:]) < pressure
