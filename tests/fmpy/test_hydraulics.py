"""The packed HydraulicActuator in FMPy: description, defaults, reference run H0, saved states, rejected calls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import FMU_FOLDER, Instance
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

FMU = FMU_FOLDER / "HydraulicActuator.fmu"
AMBIENT = 101325.0
"""Ambient pressure, the difference between absolute and gauge pressures [Pa]."""
AREAS = (0.0015904312808798326, 0.0010995574287564274)
"""Areas of the piston on the sides of chamber A and B [m2]."""
H0 = {
    0.01: (472875.119061, 10911388.8511, 0.392357384677, -11544.873288),
    0.05: (-13523.705699, 15140206.36684, 0.400000108367, -16965.2849082),
    0.1: (-25100.951360, 16924908.07686, 0.4, -18942.3297473),
    0.3: (1077695.348164, 10525627.85258, 0.4, -10137.1098407),
    0.6: (19288133.03338, 1180703.038019, 0.4, 29019.5746193),
    0.7: (20758479.10734, 407524.025005, 0.4, 32867.0547105),
    1.0: (28266440.30796, 40292.352995, 0.4, 45186.8166759),
}
"""Pressures of A and B [Pa], spool, force [N] at some times [s]: two methods agree to 5e-12 of the pressures."""
DIGITS = 1e-10
"""Allowed relative error: a pressure relative to its absolute value, a force relative to the larger of both pressure
forces."""

Actuator = Iterator[Instance]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU's files, which a test must not change."""
    assert FMU.is_file(), f"{FMU} is missing; run `cargo fmu package HydraulicActuator`"
    return Path(extract(FMU, str(tmp_path_factory.mktemp("hydraulics"))))


@pytest.fixture
def actuator(folder: Path) -> Actuator:
    """An instance before its initialisation."""
    instance = Instance(folder)
    yield instance
    instance.slave.freeInstance()


def start_h0(instance: Instance) -> Instance:
    """Initialised for H0: the motion is given, the command is 0.4 from the start on."""
    instance.set("chamber_b.start_pressure", 8e6)
    instance.set("actuator.length", 0.50)
    instance.set("actuator.speed", 0.10)
    instance.set("valve.command", 0.4)
    return instance.start(tolerance=1e-12)


def move(instance: Instance, now: float, step: float) -> None:
    """One step under the motion of H0: length 0.50 + 0.10 t - 0.075 t^2, and its speed with the derivative -0.15."""
    instance.set("actuator.length", 0.50 + 0.10 * now - 0.075 * now * now)
    instance.set("actuator.speed", 0.10 - 0.15 * now)
    instance.slave.setRealInputDerivatives([instance.references["actuator.speed"]], [1], [-0.15])
    instance.slave.doStep(now, step)


def test_the_description_is_valid() -> None:
    assert validate_fmu(str(FMU)) == []
    description = read_model_description(str(FMU), validate=True, validate_variable_names=True)
    slave = description.coSimulation
    assert description.modelName == slave.modelIdentifier == "HydraulicActuator"
    assert slave.canInterpolateInputs
    assert slave.canGetAndSetFMUstate
    assert slave.canSerializeFMUstate
    assert slave.providesDirectionalDerivative
    assert slave.maxOutputDerivativeOrder == 1


def test_start_values_are_those_of_the_binary(actuator: Instance) -> None:
    checked = 0
    for name, variable in actuator.variables.items():
        if variable.type == "Real" and variable.start is not None:
            assert actuator.get(name) == [float(variable.start)], name
            checked += 1
    assert checked > 50


def test_with_defaults_the_cylinder_is_held() -> None:
    """Without command and motion only leakage changes the pressures, and the energies balance."""
    result = simulate_fmu(str(FMU))
    assert result["time"][-1] == pytest.approx(float(read_model_description(str(FMU)).defaultExperiment.stopTime))
    for name in result.dtype.names:
        assert np.all(np.isfinite(result[name])), name
    assert np.all(result["valve.position"] == 0.0)
    assert np.all(result["energy.piston"] == 0.0)
    assert np.all(result["supply.flow"] > 0.0)
    assert np.max(np.abs(result["energy.balance"])) < 1e-8 * np.max(np.abs(result["energy.throttling"]))
    force = AREAS[0] * result["chamber_a.pressure"] - AREAS[1] * result["chamber_b.pressure"]
    assert np.allclose(result["actuator.force"], force, rtol=1e-12)


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_h0_with_derivatives_of_the_speed(actuator: Instance, step: float) -> None:
    start_h0(actuator)
    seen = 0
    for i in range(round(1.0 / step)):
        move(actuator, i * step, step)
        end = (i + 1) * step
        reference = next((values for time, values in H0.items() if math.isclose(time, end, rel_tol=1e-9)), None)
        if reference is None:
            continue
        seen += 1
        actuator.set("actuator.speed", 0.10 - 0.15 * end)
        a, b, spool, force = actuator.get(
            "chamber_a.pressure", "chamber_b.pressure", "valve.position", "actuator.force"
        )
        assert abs(a - reference[0]) <= DIGITS * (reference[0] + AMBIENT), end
        assert abs(b - reference[1]) <= DIGITS * (reference[1] + AMBIENT), end
        assert abs(spool - reference[2]) <= 1e-10, end
        scale = max(area * abs(pressure) for area, pressure in zip(AREAS, reference, strict=False))
        assert abs(force - reference[3]) <= DIGITS * scale, end
    assert seen == len(H0)


def test_without_derivatives_the_speed_is_held(actuator: Instance) -> None:
    """Without derivatives of the speed the error is far larger than the test above allows."""
    start_h0(actuator)
    for i in range(100):
        actuator.set("actuator.length", 0.50 + 0.10 * i * 1e-3 - 0.075 * (i * 1e-3) ** 2)
        actuator.set("actuator.speed", 0.10 - 0.15 * i * 1e-3)
        actuator.slave.doStep(i * 1e-3, 1e-3)
    assert abs(actuator.get("chamber_b.pressure")[0] - H0[0.1][1]) > 1e3 * DIGITS * H0[0.1][1]


def test_a_run_is_repeated_from_a_serialised_state(actuator: Instance, folder: Path) -> None:
    def continued(instance: Instance) -> list[dict[str, str]]:
        seen = []
        for i in range(45, 90):
            move(instance, i * 1e-3, 1e-3)
            seen.append({name: float(value).hex() for name, value in instance.outputs().items()})
        return seen

    start_h0(actuator)
    for i in range(45):
        move(actuator, i * 1e-3, 1e-3)
    state = actuator.slave.getFMUstate()
    text = actuator.slave.serializeFMUstate(state)
    first = continued(actuator)
    actuator.slave.setFMUstate(state)
    assert continued(actuator) == first
    actuator.slave.freeFMUstate(state)
    other = Instance(folder)
    try:
        other.start()
        state = other.slave.deSerializeFMUstate(text)
        other.slave.setFMUstate(state)
        other.slave.freeFMUstate(state)
        assert continued(other) == first
        with pytest.raises(FMICallException):
            other.slave.deSerializeFMUstate(text[:-1])
    finally:
        other.slave.freeInstance()


@pytest.mark.parametrize("length", [0.40, 0.75])
def test_a_length_beyond_the_cylinder_is_rejected(actuator: Instance, length: float) -> None:
    actuator.start()
    actuator.slave.doStep(0.0, 1e-3)
    before, valid = actuator.outputs(), actuator.get("actuator.length")[0]
    actuator.set("actuator.length", length)
    actuator.messages.clear()
    with pytest.raises(FMICallException):
        actuator.slave.doStep(1e-3, 1e-3)
    text = "\n".join(actuator.messages)
    for piece in (f"actuator.length = {length:g} m", "0.412 m", "0.742 m", "cylinder.closed_length", "cylinder.stroke"):
        assert piece in text, text
    actuator.set("actuator.length", valid)
    assert actuator.outputs() == before
    actuator.slave.doStep(1e-3, 1e-3)


def test_a_step_that_leaves_the_cylinder_is_rejected(actuator: Instance) -> None:
    actuator.set("actuator.length", 0.7415)
    actuator.set("actuator.speed", 1.0)
    actuator.start()
    with pytest.raises(FMICallException):
        actuator.slave.doStep(0.0, 1e-3)
    assert "0.742 m" in "\n".join(actuator.messages), actuator.messages
