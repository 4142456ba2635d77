"""Bad input: an exception with text and remedy, and no panic."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import linkage_fmu as lf
import numpy as np
import pytest

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
    """The example of Shigley's four-bar linkage, without its masses, along its travel, and under a given motion."""
    whole = lf.example("FourBar")
    given = whole.to_dict()
    for body in given["bodies"].values():
        for key in ("mass", "inertia", "shape", "center"):
            body.pop(key, None)
    bare = lf.Mechanism(given)
    assert bare.to_dict() == given
    with pytest.raises(lf.SimulationError, match="no body has a mass.*crank"):
        bare.simulate()
    with pytest.raises(lf.SimulationError, match="no body has a mass.*crank"):
        bare.linearise()
    assert "no body has a mass" in bare.equilibria()[0].text
    assert not [own.name for own in bare.variables if "mass" in own.name or "force" in own.name]
    angles = [own.name for own in bare.variables if own.name.endswith("angle") and own.causality == "output"]
    first, second = angles[:2]
    travel, other = bare.kinematics(400), whole.kinematics(400)
    order = [np.argsort(one[first]) for one in (travel, other)]
    common = [np.interp(0.1, one[first][k], one[second][k]) for one, k in zip((travel, other), order, strict=True)]
    assert common[0] == pytest.approx(common[1], abs=1e-3)
    drive = next(iter(given["actuators"]))
    given["actuators"][drive]["motion"] = {"profile": "constant_speed", "speed": 3.0}
    moved = lf.Mechanism(given)
    result = moved.simulate(stop_time=2.5, output_interval=0.01)
    rate = moved.kinematics(20).second_influence(second, first)
    by = np.interp(result[first][50], moved.kinematics(4000)[first], moved.kinematics(4000).second_influence(second, first))
    owner = second.rpartition(".")[0]
    assert np.isfinite(rate).all()
    assert result[f"{owner}.acceleration"][50] == pytest.approx(9.0 * by, rel=1e-4)


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
