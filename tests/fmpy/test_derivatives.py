"""Directional derivatives, rates of outputs and inputs that change within a step, through FMPy."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from conftest import Start
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

STEP = 1e-3
"""Communication step [s]."""
OUTPUTS = ["crank.acceleration", "joint2.force", "actuator.static_load", "wheel.acceleration_x", "crank.angle"]
INPUTS = ["actuator.force", "load_factor", "wheel.force_x"]


def test_the_xml_declares_them(fmu: Path) -> None:
    slave = read_model_description(str(fmu)).coSimulation
    assert slave.providesDirectionalDerivative
    assert slave.canInterpolateInputs
    assert int(slave.maxOutputDerivativeOrder) == 1


def test_directional_derivatives_are_those_of_differences(instantiate: Start) -> None:
    instance = instantiate().start().run(0, 50, STEP)
    unknowns = [instance.references[name] for name in OUTPUTS]
    knowns = [instance.references[name] for name in INPUTS]
    values = instance.get(*INPUTS)
    seeds = [300.0, 0.02, -50.0]
    derivatives = instance.slave.getDirectionalDerivative(unknowns, knowns, seeds)
    ends = []
    for sign in (1.0, -1.0):
        instance.slave.setReal(knowns, [value + sign * seed for value, seed in zip(values, seeds, strict=True)])
        ends.append(instance.get(*OUTPUTS))
    for name, slope, high, low in zip(OUTPUTS, derivatives, *ends, strict=True):
        # All outputs but the size of a force are affine in the inputs. The second derivative of this size is small
        # here.
        assert slope == pytest.approx((high - low) / 2.0, rel=1e-3 if name == "joint2.force" else 1e-9, abs=1e-9), name
    assert derivatives[-1] == 0.0
    with pytest.raises(FMICallException):
        instance.slave.getDirectionalDerivative(knowns, knowns, seeds)
    assert "actuator.force" in instance.messages[-1]


def test_the_rate_of_an_angle_is_a_speed(instantiate: Start) -> None:
    instance = instantiate().start().run(0, 50, STEP)
    names = ["crank.angle", "crank.speed", "actuator.length"]
    rates = instance.slave.getRealOutputDerivatives([instance.references[name] for name in names], [1, 1, 1])
    assert list(rates) == pytest.approx(instance.get("crank.speed", "crank.acceleration", "actuator.speed"), rel=1e-12)


def test_a_derivative_of_an_input_holds_for_one_step(instantiate: Start) -> None:
    def run(steps: int, order: int) -> float:
        instance = instantiate().start()
        step = 0.08 / steps
        force = instance.references["actuator.force"]
        for n in range(steps):
            phase = 300.0 * n * step
            instance.slave.setReal([force], [3e4 + 1e4 * math.sin(phase)])
            derivatives = [3e6 * math.cos(phase), -9e8 * math.sin(phase)][:order]
            for i, derivative in enumerate(derivatives, start=1):
                instance.slave.setRealInputDerivatives([force], [i], [derivative])
            instance.slave.doStep(n * step, step)
        return instance.get("crank.angle")[0]

    exact = run(2000, 2)
    errors = [abs(run(160, order) - exact) for order in range(3)]
    assert errors[2] < 0.1 * errors[1] < 0.1 * 1.1 * errors[0]

    instance = instantiate().start()
    force = instance.references["actuator.force"]
    instance.slave.setRealInputDerivatives([force], [1], [1e6])
    for n in range(2):
        instance.slave.doStep(n * STEP, STEP)
        assert instance.get("actuator.force") == [31_000.0]
