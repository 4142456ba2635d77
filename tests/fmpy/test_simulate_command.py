"""`cargo fmu simulate`: the same bits as the FMU through FMPy, files that others read, refusals in one line."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy.simulation
import numpy as np
import pytest
from conftest import CARGO, FMU_FOLDER, REPOSITORY
from fmpy import read_csv, simulate_fmu

Command = Callable[..., subprocess.CompletedProcess[str]]
FAST = ["time", "crank.angle", "joint1.force", "actuator.length", "energy.drift", "retracted"]


@pytest.fixture
def simulate(tmp_path: Path) -> Command:
    """`cargo fmu simulate` with these arguments, called in a folder of its own."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [*CARGO, "fmu-build", "--", "simulate", *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", timeout=900.0)

    return run


@pytest.fixture
def slopes_of_any_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """FMPy keeps room for nine slopes of inputs, and takes no other number of them: give it the room it needs."""
    original = fmpy.simulation.Input.__init__

    def with_room(self: fmpy.simulation.Input, *arguments: object, **options: object) -> None:
        original(self, *arguments, **options)
        self.continuous = [
            signals._replace(derivatives=(ctypes.c_double * len(signals.vrs))()) for signals in self.continuous
        ]

    monkeypatch.setattr(fmpy.simulation.Input, "__init__", with_room)


def agrees(done: subprocess.CompletedProcess[str], written: Path, expected: np.ndarray) -> None:
    """Every row and column is the one that FMPy recorded, to the last bit."""
    assert done.returncode == 0, done.stderr
    table = read_csv(written)
    assert table.dtype.names == expected.dtype.names
    assert len(table) == len(expected)
    for name in expected.dtype.names:
        np.testing.assert_array_equal(table[name], expected[name].astype(float), err_msg=name)


@pytest.mark.parametrize("name", ["LandingGearRetraction", "SliderCrank", "HydraulicActuator"])
def test_defaults_have_the_bits_of_the_fmu(simulate: Command, tmp_path: Path, name: str) -> None:
    fmu = FMU_FOLDER / f"{name}.fmu"
    done = simulate(fmu, "--output-file", "defaults.csv")
    agrees(done, tmp_path / "defaults.csv", simulate_fmu(str(fmu)))


@pytest.mark.usefixtures("slopes_of_any_number")
def test_signals_and_start_values_have_the_bits_of_the_fmu(simulate: Command, fmu: Path, tmp_path: Path) -> None:
    rows = [(0.0, 3e4, 0), (0.0305, 2e4, 0), (0.0305, 3.2e4, 0), (0.07, 3.1e4, 1), (0.1, 2.9e4, 1), (0.16, 3e4, 0)]
    (tmp_path / "signals.csv").write_text(
        '"time","actuator.force","uplock.engage"\n' + "".join(f"{t},{f},{lock}\n" for t, f, lock in rows)
    )
    kinds = [("time", float), ("actuator.force", float), ("uplock.engage", bool)]
    settings: dict[str, Any] = {
        "stop_time": 0.1503,
        "output_interval": 1e-3,
        "relative_tolerance": 1e-7,
        "input": np.array(rows, dtype=kinds),
        "start_values": {"crank.start_angle": (40.0, "deg"), "friction.enabled": True, "airspeed": 70.0},
        "output": FAST[1:],
    }
    arguments = ["--stop-time", 0.1503, "--output-interval", 1e-3, "--relative-tolerance", 1e-7]
    arguments += ["--input-file", "signals.csv", "--output-file", "with signals.csv", "--output-variables", *FAST[1:]]
    arguments += ["--start-values", "crank.start_angle", "40deg", "friction.enabled", "true", "airspeed=70"]
    for slopes in [False, True]:
        done = simulate(fmu, *arguments, *["--set-input-derivatives"] * slopes)
        agrees(done, tmp_path / "with signals.csv", simulate_fmu(str(fmu), set_input_derivatives=slopes, **settings))


def test_plots_are_pictures(simulate: Command, tmp_path: Path) -> None:
    mechanism = REPOSITORY / "modelDescription" / "FourBar"
    for name, beginning in [("run.png", b"\x89PNG"), ("run.svg", b"<svg")]:
        done = simulate(mechanism, "--plot", name, "--output-variables", "crank.angle", "crank.speed")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / name).read_bytes().startswith(beginning)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--stop-time", "-1"], "stop time must be finite and after the start time"),
        (["--output-interval", "0"], "must be finite and > 0"),
        (["--start-values", "crank.start_angle"], "has no value"),
        (["--start-values", "crank.mass", "-1"], "crank.mass"),
        (["--output-variables", "crank.angel"], "nearest are crank.angle"),
        (["--input-file", "missing.csv"], "missing.csv"),
        (["--input-file", "wrong.csv"], "line 3: the time goes back to 0 s"),
        (["--plot", "run.bmp"], "must end in .png or .svg"),
        (["--output-file", "no/such/folder.csv"], "cannot be made"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(
    simulate: Command, fmu: Path, tmp_path: Path, arguments: list[str], said: str
) -> None:
    (tmp_path / "wrong.csv").write_text("time,actuator.force\n1,0\n0,0\n")
    done = simulate(fmu, *arguments)
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")
    assert said in done.stderr


def test_a_run_that_ends_early_leaves_its_rows(simulate: Command, fmu: Path, tmp_path: Path) -> None:
    done = simulate(
        fmu,
        "--start-values",
        "solver.max_steps=3",
        "--stop-time",
        0.2,
        "--output-interval",
        0.1,
        "--output-file",
        "part.csv",
    )
    assert done.returncode == 1
    assert "solver.max_steps" in done.stderr
    times = read_csv(tmp_path / "part.csv")["time"]
    assert times[0] == 0.0
    assert 0.0 < times[-1] < 0.2
