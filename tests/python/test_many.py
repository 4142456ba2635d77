"""Many runs: each run has the values of a separate simulation."""

from __future__ import annotations

import linkage_fmu as lf
import numpy as np
import pytest

FORCES = np.linspace(2.0e4, 4.0e4, 200)
OUTPUTS = ["crank.angle", "retracted", "upstop.impact_time"]


def test_each_run_has_the_values_of_one_step(gear: lf.Mechanism) -> None:
    given = {"actuator.force": FORCES, "load_factor": 3 - FORCES / 2e4, "airspeed": "70 m/s"}
    runs = gear.simulate_many(given, 0.14, OUTPUTS)
    assert runs.names == ["actuator.force", "load_factor", *OUTPUTS]
    assert runs.units["actuator.force"] == "N"
    assert runs.units["crank.angle"] == "rad"
    assert runs["retracted"].dtype == bool
    for run in range(0, 200, 33):
        alone = gear.simulation({"actuator.force": FORCES[run], "load_factor": 3 - FORCES[run] / 2e4, "airspeed": 70.0})
        alone.initialize()
        alone.step(0.14)
        assert np.array_equal(alone.get(OUTPUTS), [runs[name][run] for name in OUTPUTS])
    assert gear.simulate_many(given, 0.14, OUTPUTS, threads=1).tobytes() == runs.tobytes()
    frame = runs.to_pandas()
    assert frame.index.name == "run"
    assert frame.attrs["units"]["upstop.impact_time"] == "s"


def test_the_stop_time_zero_gives_the_start(gear: lf.Mechanism) -> None:
    runs = gear.simulate_many({"load_factor": [1, 2, 3]}, 0, ["actuator.holding_force"])
    assert np.diff(runs["actuator.holding_force"], 2) == pytest.approx(0.0, abs=1e-8)
    assert np.ptp(runs["actuator.holding_force"]) > 1e3


def test_hydraulic_systems_too() -> None:
    actuator = lf.example("HydraulicActuator")
    runs = actuator.simulate_many({"valve.command": [0.0, 0.5, 1.0]}, 0.01, ["actuator.force"])
    assert np.all(np.diff(runs["actuator.force"]) > 0)


@pytest.mark.parametrize(
    ("given", "stop_time", "output", "text"),
    [
        ({"load_factor": 1.0}, 0.1, None, "no value is an array"),
        ({"load_factor": [1.0, 2.0], "airspeed": [1.0]}, 0.1, None, "load_factor has 2, airspeed has 1"),
        ({"load_factor": [[1.0, 2.0]]}, 0.1, None, "load_factor must be one number, or one column"),
        ({"load_factor": [[1], [1, 2]]}, 0.1, None, "load_factor must be one number, or one column"),
        ({"load_factor": []}, 0.1, None, "load_factor must be one number, or one column"),
        ({"load_factor": ["1", "2"]}, 0.1, None, "load_factor must be one number, or one column"),
        ({"load_facter": [1.0]}, 0.1, None, "load_factor"),
        ({"crank.angle": [1.0]}, 0.1, None, "crank.angle"),
        ({"load_factor": [1.0]}, -0.1, None, "stop_time = -0.1 s: must be finite and not negative"),
        ({"load_factor": [1.0]}, float("nan"), None, "stop_time"),
        ({"load_factor": [1.0]}, 0.1, "crank.angle", "a list of names"),
        ({"load_factor": np.ones(10_000_000)}, 0.1, None, "GB"),
        ([1.0], 0.1, None, "a dict of names and values"),
    ],
)
def test_impossible_runs_are_rejected(
    gear: lf.Mechanism, given: object, stop_time: float, output: object, text: str
) -> None:
    with pytest.raises(lf.InputError, match=text.replace("(", r"\(")):
        gear.simulate_many(given, stop_time, output)  # type: ignore[arg-type]


def test_a_run_that_fails_has_no_values(gear: lf.Mechanism) -> None:
    with pytest.warns(lf.LinkageWarning, match=r"1 of 3 runs .* Run 1 \(load_factor = nan\): .*load_factor"):
        runs = gear.simulate_many({"load_factor": [1.0, np.nan, 3.0]}, 0.14, ["crank.angle", "retracted"])
    assert np.isnan(runs["crank.angle"]).tolist() == [False, True, False]
    assert np.isnan(runs["retracted"]).tolist() == [False, True, False]


def test_an_output_without_a_value_is_named(gear: lf.Mechanism) -> None:
    given = {"friction.static_coefficient": [0.2, 8.0], "friction.enabled": True}
    with pytest.warns(lf.LinkageWarning, match=r"1 of 2 runs .* Run 1 .*breakaway_force_forward: friction locks"):
        runs = gear.simulate_many(given, 0, ["actuator.breakaway_force_forward", "crank.angle"])
    assert np.isnan(runs["actuator.breakaway_force_forward"]).tolist() == [False, True]
    assert runs["crank.angle"].tolist() == [0.8, 0.8]
