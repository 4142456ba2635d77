"""Bad input gives an exception with text and remedy, and no panic."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import linkage_fmu as lf
import numpy as np
import pytest
from linkage_fmu import build

INPUTS = ["actuator.force", "load_factor", "airspeed", "wheel.force_x"]


def test_all_findings_come_with_the_exception() -> None:
    gear = lf.example("LandingGearRetraction").to_dict()
    del gear["bodies"]["coupler"]["mass"]
    gear["joints"]["joint1"]["first"] = "grond.origin"
    with pytest.raises(lf.MechanismError) as caught:
        lf.Mechanism(gear)
    assert isinstance(caught.value, ValueError)
    report = caught.value.report
    assert len(report.errors) >= 1
    assert "grond" in str(caught.value)
    assert all(finding.message for finding in report.findings)
    assert "grond" in report._repr_html_()
    assert len(lf.check(gear).errors) == len(report.errors)


def test_a_mechanism_without_masses_has_no_dynamics() -> None:
    """The four-bar linkage without its masses: along its travel, and under a prescribed motion."""
    whole = lf.example("FourBar")
    given = whole.to_dict()
    for body in given["bodies"].values():
        for key in ("mass", "inertia", "shape", "center"):
            body.pop(key, None)
    bare = lf.Mechanism(given)
    assert bare.to_dict() == given
    for call in (bare.simulate, bare.linearise):
        with pytest.raises(lf.SimulationError, match=r"no body has a mass.*crank"):
            call()
    assert "no body has a mass" in bare.equilibria()[0].text
    assert not [own.name for own in bare.variables if "mass" in own.name or "force" in own.name]
    ratios = []
    for mechanism in (bare, whole):
        travel = mechanism.kinematics(400, ["crank.angle", "rocker.angle"])
        ratio = travel.influence("rocker.angle", "crank.angle")
        ratios.append(np.interp(1.5, travel["crank.angle"], ratio, period=2.0 * np.pi))
    assert ratios[0] == pytest.approx(ratios[1], abs=1e-4)
    given["actuators"]["drive"] = {"joint": "S", "motion": {"profile": "constant_speed", "speed": 3.0}}
    moved = lf.Mechanism(given)
    result = moved.simulate(stop_time=0.5, output_interval=0.1)
    travel = moved.kinematics(4000, ["crank.angle", "rocker.angle"])
    second = travel.second_influence("rocker.angle", "crank.angle")
    expected = 9.0 * np.interp(result["crank.angle"], travel["crank.angle"], second, period=2.0 * np.pi)
    np.testing.assert_allclose(result["rocker.acceleration"], expected, atol=1e-4)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda g, s: g.simulate(start_values={"crank.mas": 1}), "most similar names are crank.mass"),
        (lambda g, s: g.simulate(start_values={"crank.mass": -1}), "crank.mass = -1"),
        (lambda g, s: g.simulate(start_values={"crank.mass": "12 lb"}), "the unit of crank.mass is kg"),
        (lambda g, s: g.simulate(start_values={"crank.mass": [1]}), "crank.mass"),
        (lambda g, s: g.simulate(output=["crank.angel"]), "most similar names are crank.angle"),
        (lambda g, s: g.simulate(output="crank.angle"), "list of names"),
        (lambda g, s: g.simulate(stop_time=-1), "stop_time"),
        (lambda g, s: g.simulate(stop_time=float("nan")), "stop_time"),
        (lambda g, s: g.simulate(output_interval=0), "output_interval"),
        (lambda g, s: g.simulate(0, 1e9, 1e-3), "GB, but a result has at most 2.0 GB"),
        (lambda g, s: g.simulate(stop_time="1"), "stop_time = '1': must be a number"),
        (lambda g, s: g.simulate(stop_time=10**400), "is too large for a number"),
        (lambda g, s: g.simulate(start_time=1e16, output_interval=1e-3), "nearer to 0 s"),
        (lambda g, s: g.simulate(start_values=[1]), "start_values = [1]: must be a dict"),
        (lambda g, s: g.simulate(output=5), "output = 5: must be a list of names"),
        (lambda g, s: g.simulate(output=["crank.angle"] * 2), "crank.angle occurs twice"),
        (lambda g, s: s.get(["crank.angle"] * 2), "crank.angle occurs twice"),
        (lambda g, s: s.set(["load_factor"] * 2, [1, 2]), "load_factor occurs twice"),
        (lambda g, s: s.prepare(["crank.angle"] * 2), "crank.angle occurs twice"),
        (lambda g, s: g.kinematics(4, ["crank.angle"] * 2), "crank.angle occurs twice"),
        (lambda g, s: g.linearise(outputs=["crank.angle"] * 2), "crank.angle occurs twice"),
        (lambda g, s: g.linearise_travel(10**9), "count = 1000000000: must be a whole number from 1 to 100000"),
        (lambda g, s: g.kinematics(10**6, (v.name for v in g.variables)), "has at most 2.0 GB"),
        (lambda g, s: s.set_derivative("actuator.force", 1.0, 2**40), "order"),
        (lambda g, s: s.step("1"), "h = '1': must be a number"),
        (lambda g, s: s.step(10**400), "too large"),
        (lambda g, s: s["\udc80"], "name"),
        (lambda g, s: s.set(["friction.enabled", "crank.mass"], ["maybe", 20]), "is not true or false"),
        (lambda g, s: lf.Mechanism({"name": {1, 2}}), "a value of the type set has no form in JSON"),
        (lambda g, s: lf.Mechanism({"bodies": {"crank": {"mass": np.nan}}}), "source: bodies.crank.mass = nan"),
        (
            lambda g, s: lf.sweep({"factors": {"a": {"values": np.array([1, np.inf])}}}),
            "study: factors.a.values.1 = inf",
        ),
        (lambda g, s: lf.sweep({"factors": {}}, g), "study: not a valid study: the key `responses` is missing"),
        (lambda g, s: build.mechanism("A", build.pin("a", "ground", "b", at=np.array(8))), "is not a point"),
        (lambda g, s: g.simulate(set_input_derivatives="no"), "set_input_derivatives = 'no': must be True or False"),
        (lambda g, s: g.package(animation="no"), "animation = 'no': must be True or False"),
        (lambda g, s: lf.sweep(5), "study = 5: must be a path"),
        (lambda g, s: lf.info(None), "path = None: must be a path"),
        (lambda g, s: g.simulate(relative_tolerance=-1), "relative_tolerance"),
        (lambda g, s: g.simulate(input=[1, 2]), "structured array"),
        (lambda g, s: g.simulate(input={"time": [0], "crank.mass": [1]}), "is not an input"),
        (lambda g, s: g.simulate(input={"time": [1, 0], "load_factor": [1, 1]}), "decreases"),
        (lambda g, s: g.simulate(input={"time": [0, 1], "load_factor": [1]}), "1 values at 2 times"),
        (lambda g, s: g.simulate(input={"time": [0], "load_factor": [np.nan]}), "finite"),
        (lambda g, s: g.simulate(input={"time": [0], "load_factor": [[1]]}), "one column"),
        (lambda g, s: s.get("crank.angel"), "most similar names are crank.angle"),
        (lambda g, s: s.get(["crank.angle"], np.empty(2)), "1 numbers"),
        (lambda g, s: s.get(["crank.angle"], [0.0]), "writable array"),
        (lambda g, s: s.set("crank.angle", 1.0), "crank.angle"),
        (lambda g, s: s.set("actuator.force", float("inf")), "finite"),
        (lambda g, s: s.set("actuator.force", True), "must be a number, or a text with a unit"),
        (lambda g, s: s.set("actuator.force", None), "must be a number, or a text with a unit"),
        (lambda g, s: s.set("actuator.force", "3 lbf"), 'is N or kN, not "lbf"; convert the value to N or kN'),
        (lambda g, s: g.package("gear.fmu"), "the folder for the FMUs has the name of an FMU"),
        (lambda g, s: s.set("friction.enabled", "yes"), "is not true or false"),
        (lambda g, s: s.set("friction.enabled", 2), "True or False"),
        (lambda g, s: s.set("solver.method", "magic"), "magic"),
        (lambda g, s: s.set(INPUTS, [1.0, 2.0]), "2 values, but there are 4 names"),
        (lambda g, s: s.set(INPUTS, np.zeros((2, 2))), "2 dimensions"),
        (lambda g, s: s.set(INPUTS, 5.0), "array or a list"),
        (lambda g, s: s.set(INPUTS, [1, 2, 3, np.nan]), "finite"),
        (lambda g, s: s.step(-1.0), ""),
        (lambda g, s: s.step(float("nan")), ""),
        (lambda g, s: s.run_until(-1.0), "not before the present time"),
        (lambda g, s: s.set_derivative("actuator.force", 1.0, 9), ""),
        (lambda g, s: s.directional_derivative(["crank.angle"], ["crank.mass"], [1.0]), ""),
        (lambda g, s: s.directional_derivative(["crank.speed"], ["load_factor"], [1.0, 2.0]), "2 numbers"),
        (lambda g, s: g.kinematics(0), "count"),
        (lambda g, s: g.kinematics(10, ["crank.mass"]), "not an output"),
        (lambda g, s: g.kinematics(10, "crank.angle"), "list of names"),
        (lambda g, s: g.linearise("crank.angel"), "most similar names are crank.angle"),
        (lambda g, s: g.view(start_values={"a": 1}), "most similar names"),
        (lambda g, s: lf.Mechanism("nowhere.json"), "no such file"),
        (lambda g, s: lf.example("Nothing"), "the examples are"),
        (lambda g, s: lf.example("HydraulicActuator").view(), "no mechanism that can be drawn"),
        (lambda g, s: lf.example("HydraulicActuator").kinematics(), "no travel"),
        (lambda g, s: lf.validate("nowhere.fmu"), "nowhere.fmu"),
        (lambda g, s: lf.info("nowhere.fmu"), "nowhere.fmu"),
        (lambda g, s: lf.sweep({"mechanism": "nowhere", "responses": {}}), "responses"),
        (lambda g, s: g.package("/dev/null/x"), ""),
        (lambda g, s: g.package(fmi=4), "fmi"),
        (lambda g, s: g.package(platforms=["amiga"]), "there is no platform amiga"),
    ],
)
def test_bad_input_has_a_text(
    gear: lf.Mechanism,
    simulation: lf.Simulation,
    call: Callable[[lf.Mechanism, lf.Simulation], Any],
    text: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = simulation.get(["crank.angle", *INPUTS])
    with pytest.raises(lf.LinkageError) as caught:
        call(gear, simulation)
    assert text in str(caught.value)
    assert "--" not in str(caught.value), "an option of the command line"
    assert np.array_equal(simulation.get(["crank.angle", *INPUTS]), before), "a refused call has changed something"


def test_types_are_checked(gear: lf.Mechanism) -> None:
    for kind in (TypeError, ValueError, lf.LinkageError):
        with pytest.raises(kind, match="source = 5: must be a path, a dict or a text"):
            lf.Mechanism(5)  # type: ignore[arg-type]


def test_a_closed_simulation_raises_an_error(gear: lf.Mechanism) -> None:
    with gear.simulation() as simulation:
        simulation.initialize()
    with pytest.raises(lf.SimulationError, match=r"closed; create a new simulation"):
        simulation.step(1e-3)
    assert repr(simulation) == "<Simulation, closed>"
    simulation.close()


def test_a_panic_is_an_exception() -> None:
    with pytest.raises(lf.InternalError, match="please report it"):
        lf._engine.panics()
    assert lf.example("FourBar").simulate(stop_time=0.01, output=["crank.angle"])["crank.angle"].size > 1


def test_a_remedy_has_no_option_of_the_command_line(gear: lf.Mechanism, tmp_path: Path) -> None:
    with pytest.raises(lf.InputError) as caught:
        gear.package(tmp_path, platforms=["x86_64-darwin", "x86_64-windows", "aarch64-linux"])
    assert re.search(r"libraries for: [^;]*; install a wheel [^;,]*$", str(caught.value).splitlines()[0])


def test_names_belong_to_their_mechanism(simulation: lf.Simulation) -> None:
    other = lf.example("FourBar").simulation()
    with pytest.raises(lf.InputError, match="call prepare"):
        other.get(simulation.prepare(["crank.angle"]))


def test_wrong_arguments_are_named() -> None:
    study = {"factors": {}, "responses": {"end": {"final": "crank.angle"}}}
    with pytest.raises(lf.InputError, match="must be a Mechanism"):
        lf.sweep(study, "gear.json")  # type: ignore[arg-type]
    with pytest.raises(lf.InputError, match="height"):
        lf.example("FourBar").view(height='"><script>')  # type: ignore[arg-type]
