"""FMPy's own simulate_fmu: defaults, inputs, start values; and the demo."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, Edit, Start
from fmpy import read_model_description, simulate_fmu

STEP = 1e-3
"""Communication step [s]."""
TOLERANCE = 1e-9
"""Default tolerance of the integration."""
FINAL_ANGLE = -1.2377117266891367
"""Angle of the crank at 0.13 s by quadrature [rad]."""
RETRACTION_TIME = 0.1320598527442597
"""Time at which the crank is at -1.3 rad by quadrature [s]."""
GLOBAL_OVER_LOCAL = 100.0
"""Stated ratio of the angle error at 0.13 s to the tolerance of one step [rad]."""


def table(times: list[float], forces: list[float]) -> np.ndarray:
    """FMPy's input array for actuator.force."""
    return np.array(list(zip(times, forces, strict=True)), dtype=[("time", float), ("actuator.force", float)])


def test_defaults_run(fmu: Path) -> None:
    result = simulate_fmu(str(fmu))
    stop = float(read_model_description(str(fmu)).defaultExperiment.stopTime)
    assert result["time"][-1] == pytest.approx(stop, rel=1e-9)
    for name in result.dtype.names:
        assert np.all(np.isfinite(result[name])), name
    assert result["crank.angle"][0] == pytest.approx(0.8, rel=1e-14)


def test_final_angle(fmu: Path) -> None:
    result = simulate_fmu(str(fmu), stop_time=0.13, output_interval=STEP)
    assert abs(result["crank.angle"][-1] - FINAL_ANGLE) <= GLOBAL_OVER_LOCAL * TOLERANCE


def test_constant_input_is_the_start_value(fmu: Path) -> None:
    settings = {"stop_time": 0.1, "output_interval": STEP, "output": ["crank.angle", "joint2.force"]}
    by_input = simulate_fmu(str(fmu), input=table([0.0, 0.1], [25000.0, 25000.0]), **settings)
    by_start = simulate_fmu(str(fmu), start_values={"actuator.force": 25000.0}, **settings)
    by_default = simulate_fmu(str(fmu), **settings)
    # Setting an input again may end the integrator's step: one step more or less, each within the tolerance.
    for name in ("crank.angle", "joint2.force"):
        scale = float(np.max(np.abs(by_start[name])))
        np.testing.assert_allclose(by_input[name], by_start[name], rtol=0.0, atol=TOLERANCE * scale)
    assert by_input["crank.angle"][-1] > by_default["crank.angle"][-1] + 0.05


def test_input_is_applied_step_by_step(fmu: Path, instantiate: Start) -> None:
    times, forces = [0.0, 0.04, 0.1], [30000.0, 20000.0, 36000.0]
    result = simulate_fmu(
        str(fmu), stop_time=0.1, output_interval=STEP, input=table(times, forces), output=["crank.angle"]
    )
    instance = instantiate().start()
    for i in range(100):
        instance.set("actuator.force", float(np.interp(i * STEP, times, forces)))
        instance.run(i, i + 1, STEP)
    assert result["crank.angle"][-1] == pytest.approx(instance.get("crank.angle")[0], rel=10 * TOLERANCE)


def test_start_values(fmu: Path) -> None:
    start = {"crank.start_angle": 0.7, "crank.start_speed": -1.5}
    result = simulate_fmu(
        str(fmu), stop_time=0.01, output_interval=STEP, start_values=start, output=["crank.angle", "crank.speed"]
    )
    assert result["crank.angle"][0] == pytest.approx(0.7, rel=1e-14)
    assert result["crank.speed"][0] == pytest.approx(-1.5, rel=1e-13)


def test_acceleration_from_rest_is_affine_in_the_load(instantiate: Start) -> None:
    """At rest th'' = Q / I, and Q is affine in the load factor and in the force of the actuator."""
    accelerations = []
    for factor, force in ((0.0, 30000.0), (3.0, 30000.0), (6.0, 30000.0), (3.0, 0.0), (3.0, 60000.0)):
        instance = instantiate().start(load_factor=factor, actuator__force=force)
        accelerations += instance.get("crank.acceleration")
    none, middle, heavy, free, strong = accelerations
    largest = max(map(abs, accelerations))
    assert heavy - middle == pytest.approx(middle - none, abs=1e-11 * largest)
    assert strong - middle == pytest.approx(middle - free, abs=1e-11 * largest)
    assert abs(heavy - none) > 1e-3 * largest
    assert strong < middle < free


def test_edited_mechanism_is_honoured(instantiate: Start, edited: Edit) -> None:
    """A number in resources/mechanism.json has the same effect as the parameter of its name."""

    def lengthen(mechanism: dict) -> None:
        mechanism["bodies"]["crank"]["length"] *= 1.01

    by_file = instantiate(edited(lengthen))
    plain, by_parameter = instantiate(), instantiate()
    by_parameter.set("crank.length", by_file.get("crank.length")[0])
    ends = [instance.start().run(0, 50, STEP).get("crank.angle")[0] for instance in (plain, by_parameter, by_file)]
    assert ends[1] == ends[2]
    assert abs(ends[0] - ends[1]) > 1e-4


def test_parameter_wins_over_the_file(instantiate: Start, edited: Edit) -> None:
    def change(mechanism: dict) -> None:
        mechanism["start"]["angle"] = 0.6

    instance = instantiate(edited(change))
    assert instance.get("crank.start_angle") == [0.6]
    instance.start(crank__start_angle=0.7)
    assert instance.get("crank.angle")[0] == pytest.approx(0.7, rel=1e-14)


def test_demo(fmu: Path, tmp_path: Path) -> None:
    script = REPOSITORY / "fmu-build" / "python" / "demo.py"
    # A separate folder for Matplotlib's font cache: the demo must run without a home folder.
    environment = {**os.environ, "MPLCONFIGDIR": str(tmp_path / "matplotlib")}
    command = [sys.executable, str(script), str(fmu), "--out", str(tmp_path / "demo")]
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, timeout=300.0)
    words = done.stdout.split("retraction time")[1].split()
    # 100 x tolerance in the angle at 30 rad/s, and the resolution of 1 ns of the approximation.
    assert float(words[0]) == pytest.approx(RETRACTION_TIME, abs=GLOBAL_OVER_LOCAL * TOLERANCE / 30.0 + 1e-11, rel=0.0)
    assert "2.1000000" in done.stdout
    with (tmp_path / "demo" / "retraction.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 134
    assert float(rows[130]["crank.angle"]) == pytest.approx(FINAL_ANGLE, abs=GLOBAL_OVER_LOCAL * TOLERANCE, rel=0.0)
    assert (tmp_path / "demo" / "retraction.png").read_bytes().startswith(b"\x89PNG")


def test_second_formulation(fmu: Path) -> None:
    """The number of an item selects the second formulation. It differs from the first by the strain of its rods."""
    settings = {"stop_time": 0.13, "output_interval": STEP, "output": ["crank.angle", "energy.drift"]}
    result = simulate_fmu(str(fmu), start_values={"solver.method": 2}, **settings)
    # tests/engine/rigid_fem: 1.389e-4 rad, and the error of the step 4e2 rad/s2 (1e-5 s)^2.
    assert result["crank.angle"][-1] - FINAL_ANGLE == pytest.approx(1.389484e-4, abs=5e-8, rel=0.0)
    assert np.max(np.abs(result["energy.drift"])) < 1e-2
    plain = simulate_fmu(str(fmu), start_values={"solver.method": 1}, **settings)
    assert abs(plain["crank.angle"][-1] - FINAL_ANGLE) <= GLOBAL_OVER_LOCAL * TOLERANCE
