"""`cargo fmu simulate`: results bit-identical to the FMU through FMPy, readable files, errors in one line."""

from __future__ import annotations

import json
import subprocess
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as parquet
import pytest
from conftest import FMU_FOLDER, REPOSITORY, program
from fmpy import read_csv, simulate_fmu, simulation
from PIL import Image

VERSION = tomllib.loads((REPOSITORY / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]
Command = Callable[..., subprocess.CompletedProcess[str]]
FAST = ["time", "crank.angle", "joint1.force", "actuator.length", "energy.drift", "retracted"]


@pytest.fixture
def simulate(tmp_path: Path) -> Command:
    """`cargo fmu simulate` with these arguments, called in a separate folder."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [*program("fmu-studies"), "simulate", *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", timeout=900.0)

    return run


def agrees(done: subprocess.CompletedProcess[str], written: Path, expected: np.ndarray) -> None:
    """Every row and column is bit-identical to FMPy's recording."""
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


@pytest.fixture
def derivatives_of_any_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """FMPy 0.3.32 supports the derivatives of nine signals and rejects any other number. This fixture supports all
    numbers."""
    begin = simulation.Input.__init__

    def fitted(self: simulation.Input, *arguments: Any, **options: Any) -> None:  # noqa: ANN401
        begin(self, *arguments, **options)
        self.continuous = [
            part._replace(derivatives=(part.derivatives._type_ * len(part.values))()) for part in self.continuous
        ]

    monkeypatch.setattr(simulation.Input, "__init__", fitted)


@pytest.mark.usefixtures("derivatives_of_any_number")
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
        "start_values": {"crank.start_angle": (40.0, "deg"), "friction.enabled": True, "airspeed": 70.0},
        "output": FAST[1:],
    }
    arguments = ["--stop-time", 0.1503, "--output-interval", 1e-3, "--relative-tolerance", 1e-7]
    arguments += ["--input-file", "signals.csv", "--output-file", "with signals.csv", "--output-variables", *FAST[1:]]
    arguments += ["--start-values", "crank.start_angle", "40deg", "friction.enabled", "true", "airspeed=70"]
    # For slopes FMPy needs each corner twice and a time before 0, because it sets the slope of the interval before.
    corners = [(-1.0, *rows[0][1:]), *(row for row in rows for _ in range(1 if row[0] == 0.0305 else 2))]
    for slopes, signals in [(False, rows), (True, corners)]:
        settings["input"] = np.array(signals, dtype=kinds)
        done = simulate(fmu, *arguments, *["--set-input-derivatives"] * slopes)
        agrees(done, tmp_path / "with signals.csv", simulate_fmu(str(fmu), set_input_derivatives=slopes, **settings))


def test_plots_are_pictures(simulate: Command, tmp_path: Path) -> None:
    mechanism = REPOSITORY / "modelDescription" / "FourBar"
    beginnings = {"run.png": b"\x89PNG", "run.svg": b"<?xml", "run.pdf": b"%PDF"}
    for name, beginning in beginnings.items():
        done = simulate(mechanism, "--plot", name, "--output-variables", "crank.angle", "crank.speed")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / name).read_bytes().startswith(beginning)
    svg = (tmp_path / "run.svg").read_text(encoding="utf-8")
    for text in ("FourBar", "crank.angle", "Angle [deg]", "[deg/s]", "time [s]"):
        assert text in svg, text


def test_a_plot_over_a_variable_records_it(simulate: Command, tmp_path: Path) -> None:
    mechanism = REPOSITORY / "modelDescription" / "FourBar"
    arguments = ["--plot", "run.svg", "--x", "crank.angle", "--output-file", "run.csv"]
    done = simulate(mechanism, *arguments, "--output-variables", "rocker.angle")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run.csv").read_text(encoding="utf-8").startswith('"time","rocker.angle","crank.angle"')
    assert "crank.angle [deg]" in (tmp_path / "run.svg").read_text(encoding="utf-8")
    done = simulate(mechanism, *arguments[:3], "crank.angel")
    assert done.returncode == 1
    assert "--x: " in done.stderr


def test_parquet_has_the_bits_of_the_csv(simulate: Command, fmu: Path, tmp_path: Path) -> None:
    # Several row groups of 2^20 values each.
    fine = ["--output-interval", 1e-5, "--output-variables", *FAST[1:], "joint1.slip_speed", "crank.speed"]
    for name, arguments, groups in [("whole", [], 1), ("fine", [*fine, "--stop-time", 2.0], 2)]:
        for ending in ("csv", "parquet"):
            done = simulate(fmu, *arguments, "--output-file", f"{name}.{ending}")
            assert done.returncode == 0, done.stderr
        expected = np.genfromtxt(tmp_path / f"{name}.csv", delimiter=",", names=True, deletechars="")
        file = parquet.ParquetFile(tmp_path / f"{name}.parquet")
        assert file.metadata.num_row_groups == groups
        table = file.read()
        assert tuple(table.column_names) == expected.dtype.names
        units = json.loads(table.schema.metadata[b"linkage_fmu.units"])
        assert (units["time"], units["crank.speed"]) == ("s", "rad/s")
        assert table.schema.metadata[b"linkage_fmu.version"] == VERSION.encode()
        kinds = {str(field.type) for field in table.schema}
        assert kinds == {"double", "bool"}
        for column in table.column_names:
            values = table[column].to_numpy().astype(float)
            np.testing.assert_array_equal(values.view(np.uint64), expected[column].view(np.uint64), err_msg=column)


def test_a_film_shows_the_motion(simulate: Command, fmu: Path, tmp_path: Path) -> None:
    done = simulate(fmu, "--gif", "gear up.gif")
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "gear up.gif") as film:
        assert film.info["loop"] == 0
        frames = film.n_frames
        pictures = []
        duration = 0
        for frame in range(frames):
            film.seek(frame)
            duration += film.info["duration"]
            pictures.append(film.convert("RGB").tobytes())
    assert 60 <= frames <= 121
    assert 3000 <= duration <= 9000
    assert len(set(pictures)) == frames
    # The blue of the first body, and white around it.
    whole = np.frombuffer(pictures[0], dtype=np.uint8).reshape(-1, 3)
    assert np.mean(np.all(whole == (0x3F, 0x7F, 0xC1), axis=1)) > 0.005
    assert np.mean(np.all(whole == 255, axis=1)) > 0.5


def test_an_actuator_without_a_linkage_has_no_film(simulate: Command) -> None:
    done = simulate(FMU_FOLDER / "HydraulicActuator.fmu", "--gif", "oil.gif")
    assert done.returncode == 1
    assert "HydraulicActuator has no mechanism that can be drawn" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--stop-time", "-1"], "stop time must be finite and not before the start time"),
        (["--output-interval", "0"], "must be finite and > 0"),
        (["--start-values", "crank.start_angle"], "has no value"),
        (["--start-values", "crank.mass", "-1"], "crank.mass"),
        (["--output-variables", "crank.angel"], "most similar names are crank.angle"),
        (["--input-file", "missing.csv"], "missing.csv"),
        (["--input-file", "wrong.csv"], "line 3: the time decreases to 0 s"),
        (["--plot", "run.bmp"], "must end in .png, .svg or .pdf"),
        (["--output-file", "wrong.csv/run.csv"], "the folder cannot be created; give another folder"),
        (["--output-file", "run.xlsx"], "must end in .csv or .parquet"),
        (["--gif", "run.mp4"], "must end in .gif"),
        (["--output-variables", "crank.angle", "crank.angle"], "crank.angle occurs twice"),
        (["--input-file", "wrong.csv", "--output-file", "wrong.csv"], "this is --input-file"),
    ],
)
def test_wrong_arguments_are_reported_in_one_line(
    simulate: Command, fmu: Path, tmp_path: Path, arguments: list[str], said: str
) -> None:
    (tmp_path / "wrong.csv").write_text("time,actuator.force\n1,0\n0,0\n")
    done = simulate(fmu, *arguments)
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")
    assert said in done.stderr


def test_a_run_that_ends_early_writes_its_rows(simulate: Command, fmu: Path, tmp_path: Path) -> None:
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
