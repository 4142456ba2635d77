"""Runs have the values of `simulate`, and FMPy accepts the results."""

from __future__ import annotations

import _thread
import csv
import pickle
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import linkage_fmu as lf
import matplotlib as mpl
import numpy as np
import pandas
import pytest

mpl.use("Agg")

OUTPUTS = ["crank.angle", "crank.speed", "joint1.force", "actuator.length", "retracted"]


@pytest.mark.parametrize("name", ["LandingGearRetraction", "SliderCrank", "HydraulicActuator", "MainGear"])
def test_a_run_is_that_of_the_command(name: str, tmp_path: Path) -> None:
    mechanism = lf.example(name)
    path = mechanism.save(tmp_path / mechanism._kind)
    command = [sys.executable, "-m", "linkage_fmu", "simulate", str(path), "--output-file", str(tmp_path / "run.csv")]
    subprocess.run(command, check=True, capture_output=True)
    with (tmp_path / "run.csv").open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lf.LinkageWarning)
        result = mechanism.simulate()
    assert result.names == names
    table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    own = np.column_stack([result[own].astype(float) for own in names])
    assert np.array_equal(own, table, equal_nan=True)


def test_start_values_and_inputs_are_those_of_the_command(gear: lf.Mechanism, tmp_path: Path) -> None:
    path = gear.save(tmp_path / "mechanism.json")
    (tmp_path / "in.csv").write_text("time,actuator.force\n0,30000\n0.05,36000\n0.05,31000\n0.1,30000\n")
    words = ["--start-values", "crank.start_angle", "45deg", "friction.enabled", "true", "load_factor", "1"]
    command = [sys.executable, "-m", "linkage_fmu", "simulate", str(path), "--output-file", str(tmp_path / "run.csv")]
    command += [*words, "--input-file", str(tmp_path / "in.csv"), "--stop-time", "0.1", "--output-interval", "0.002"]
    subprocess.run([*command, "--output-variables", *OUTPUTS], check=True, capture_output=True)
    table = np.genfromtxt(tmp_path / "run.csv", delimiter=",", skip_header=1)
    signal = {"time": [0, 0.05, 0.05, 0.1], "actuator.force": [30000, 36000, 31000, 30000]}
    starts = {"crank.start_angle": "45 deg", "friction.enabled": True, "load_factor": 1}
    result = gear.simulate(0.0, 0.1, 0.002, start_values=starts, input=signal, output=OUTPUTS)
    assert np.array_equal(np.column_stack([result[name].astype(float) for name in result.names]), table)
    frame = pandas.DataFrame(signal).set_index("time")
    assert np.array_equal(gear.simulate(0.0, 0.1, 0.002, start_values=starts, input=frame, output=OUTPUTS), result)
    fields = np.array(list(zip(*signal.values(), strict=True)), dtype=[("time", float), ("actuator.force", float)])
    assert np.array_equal(gear.simulate(0.0, 0.1, 0.002, start_values=starts, input=fields, output=OUTPUTS), result)


def test_a_result_is_one_of_fmpy(gear: lf.Mechanism, tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    from fmpy.util import create_plotly_figure

    fmu = gear.package(tmp_path, fmi=2, animation=False, results=False)[0]
    assert lf.validate(fmu), lf.validate(fmu)
    other = fmpy.simulate_fmu(str(fmu), stop_time=0.13, output_interval=1e-3, output=OUTPUTS)
    result = gear.simulate(stop_time=0.13, output_interval=1e-3, output=OUTPUTS)
    assert result.dtype == other.dtype
    assert np.array_equal(np.asarray(result), other)
    assert len(create_plotly_figure(result).data) == len(OUTPUTS)


def test_a_result_converts_to_other_formats(gear: lf.Mechanism) -> None:
    result = gear.simulate(stop_time=0.13, output=OUTPUTS)
    frame = result.to_pandas()
    assert list(frame.columns) == OUTPUTS
    assert frame.index.name == "time"
    assert frame.attrs["units"]["crank.angle"] == "rad"
    assert frame["crank.angle"].iloc[-1] == result["crank.angle"][-1]
    assert result[-1]["time"] == 0.13
    copy = pickle.loads(pickle.dumps(result))
    assert isinstance(copy, lf.Result)
    assert np.array_equal(copy, result)
    assert "crank" in copy.animate().html
    assert pickle.loads(pickle.dumps(gear)).name == gear.name
    figure = result.plot("crank.angle", "joint1.force", x="actuator.length")
    assert [axis.get_ylabel() for axis in figure.axes] == ["[rad]", "[N]"]
    assert figure.axes[1].get_xlabel() == "actuator.length [m]"
    with pytest.raises(lf.InputError, match=r"crank\.angel.*most similar names are crank\.angle"):
        result.plot("crank.angel")


def test_a_run_that_ends_early_keeps_its_rows() -> None:
    gear = lf.example("LandingGearRetraction").to_dict()
    gear["solver"] = {**gear.get("solver", {}), "max_steps": 3}
    with pytest.raises(lf.SimulationError, match=r"max_steps") as caught:
        lf.Mechanism(gear).simulate(stop_time=0.1, output_interval=0.1, output=["crank.angle"])
    assert caught.value.result is not None
    assert 0.0 < caught.value.result["time"][-1] < 0.1


def test_a_run_is_as_long_wherever_it_starts(gear: lf.Mechanism) -> None:
    signal = {"time": [0, 0.05, 0.05, 0.1], "load_factor": [3, 3, 1, 1]}
    expected = gear.simulate(0.0, 0.1, 1e-3, input=signal, output=["crank.angle"])
    for start in (1e5, 1e7):
        moved = {"time": [start + time for time in signal["time"]], "load_factor": signal["load_factor"]}
        result = gear.simulate(start, start + 0.1, 1e-3, input=moved, output=["crank.angle"])
        assert len(result) == len(expected) == 101
        assert np.allclose(result["crank.angle"], expected["crank.angle"], rtol=0, atol=1e-16 * start / 1e-3)


def test_ctrl_c_ends_a_run(gear: lf.Mechanism) -> None:
    timer = threading.Timer(0.05, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        gear.simulate(0.0, 1e4, 1e-3, output=["crank.angle"])
    timer.join()


def test_threads_run_at_the_same_time(gear: lf.Mechanism) -> None:
    alone = gear.simulate(output=OUTPUTS)
    results: list[lf.Result] = []
    threads = [threading.Thread(target=lambda: results.append(gear.simulate(output=OUTPUTS))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8
    assert all(np.array_equal(result, alone) for result in results)


def test_the_lock_is_free_in_a_run(gear: lf.Mechanism) -> None:
    """Another thread counts during a run."""
    counts = 0
    done = threading.Event()

    def run() -> None:
        gear.simulate(stop_time=20.0, output_interval=1e-4, output=["crank.angle"])
        done.set()

    thread = threading.Thread(target=run)
    thread.start()
    while not done.is_set():
        counts += 1
    thread.join()
    assert counts > 100
