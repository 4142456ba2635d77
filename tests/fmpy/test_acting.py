"""Stops, locks, friction and air of the default gear through FMPy."""

from __future__ import annotations

import math

import pytest
from conftest import Start
from fmpy.fmi1 import FMICallException

UP = -1.3
"""Angle of the crank at the up stop [rad]."""
WITHOUT_FRICTION = 0.13205985274426
"""Time at which the crank reaches this angle, by quadrature [s]."""
WITH_FRICTION = 0.134488353
"""The same time with friction, 1.84 % more, by an independent program with Lagrange multipliers [s]."""
SPEED = 30.0
"""Approximate angular speed of the crank at this angle [rad/s]."""
TIME = 1e-8
"""Accuracy of the reference time with friction, with the default tolerance 1e-9 [s]."""


def test_the_gear_goes_up_and_stays(instantiate: Start) -> None:
    instance = instantiate().start()
    assert instance.boolean("extended")
    assert not instance.boolean("retracted")
    instance.run(0, 1, 0.2)
    assert instance.boolean("retracted")
    assert not instance.boolean("extended")
    angle, speed, torque = instance.get("crank.angle", "crank.speed", "upstop.torque")
    assert angle == pytest.approx(UP, abs=1e-12)
    assert speed == 0.0
    assert torque > 0.0


@pytest.mark.parametrize(("friction", "time"), [(False, WITHOUT_FRICTION), (True, WITH_FRICTION)])
def test_a_retraction_with_friction_has_the_reference_time(instantiate: Start, friction: bool, time: float) -> None:
    instance = instantiate()
    instance.set("upstop.enabled", False)
    instance.set("friction.enabled", friction)
    instance.start().run(0, 1, time)
    angle, speed = instance.get("crank.angle", "crank.speed")
    assert angle == pytest.approx(UP, abs=TIME * SPEED)
    assert abs(speed) == pytest.approx(SPEED, rel=0.05)


def test_drag_has_its_closed_form(instantiate: Start) -> None:
    """1/2 rho v2 S c with S = S0 |sin|. The leg has the direction theta - 2.4, the air flows along 1.13 - pi/2."""
    facing = abs(math.sin(0.8 - 2.4 - (1.13 - math.pi / 2)))
    instance = instantiate().start(airspeed=70.0)
    leg, wheel = instance.get("leg.drag", "wheel.drag")
    assert leg == pytest.approx(0.5 * 1.225 * 70.0**2 * 0.759 * 0.10 * 0.5 * facing, rel=1e-12)
    assert wheel == pytest.approx(0.5 * 1.225 * 70.0**2 * 0.09 * 0.5 * facing, rel=1e-12)
    still = instantiate().start()
    for each in (instance, still):
        each.run(0, 1, 0.13)
    assert instance.get("crank.angle")[0] > still.get("crank.angle")[0] + 0.01


def test_uplock_holds_and_releases(instantiate: Start) -> None:
    instance = instantiate().start()
    instance.set("uplock.engage", True)
    instance.run(0, 2, 0.1)
    instance.set("actuator.force", 0.0)
    instance.run(2, 4, 0.1)
    assert instance.boolean("retracted")
    speed, torque, force = instance.get("crank.speed", "upstop.torque", "uplock.force")
    assert (speed, torque) == (0.0, 0.0)
    assert force > 0.0
    instance.set("uplock.engage", False)
    instance.run(4, 5, 0.1)
    assert not instance.boolean("retracted")
    assert instance.get("crank.speed")[0] > 0.0


def test_downlock_holds_against_the_actuator(instantiate: Start) -> None:
    """Virtual work: the excess over the holding force times the speed of the actuator, divided by the speed of the
    wheel."""
    instance = instantiate()
    instance.set("downlock.engage", True)
    instance.start().run(0, 3, 0.1)
    assert instance.boolean("extended")
    angle, speed, force, holding = instance.get(
        "crank.angle", "crank.speed", "downlock.force", "actuator.holding_force"
    )
    assert angle == pytest.approx(0.8, abs=1e-12)
    assert speed == 0.0
    moving = instantiate().start(crank__start_speed=-1.0)
    rate, x, y = moving.get("actuator.speed", "wheel.velocity_x", "wheel.velocity_y")
    assert force == pytest.approx((30000.0 - holding) * rate / math.hypot(x, y), rel=1e-9)


def test_dropped_gear_comes_to_rest(instantiate: Start) -> None:
    instance = instantiate().start(crank__start_angle=0.5, actuator__force=-20000.0, downstop__restitution=0.5)
    speeds = []
    for i in range(400):
        instance.run(i, i + 1, 5e-3)
        speeds += instance.get("crank.speed")
    assert min(speeds) < -0.1, "it bounced"
    assert speeds[-1] == 0.0
    assert instance.boolean("extended")
    assert instance.get("crank.angle")[0] == pytest.approx(0.8, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("friction.static_coefficient", -0.1),
        ("friction.kinetic_coefficient", -0.1),
        ("friction.static_speed", 0.0),
        ("joint1.pin_radius", -0.01),
        ("upstop.restitution", 1.5),
        ("upstop.stiffness", -1.0),
        ("air.density", -1.0),
        ("leg.width", -0.1),
    ],
)
def test_value_out_of_range_is_rejected_with_its_name(instantiate: Start, name: str, value: float) -> None:
    instance = instantiate()
    with pytest.raises(FMICallException):
        instance.set(name, value)
    assert any(name in message for message in instance.messages), instance.messages


@pytest.mark.parametrize(
    ("values", "fragment"),
    [
        ({"friction__kinetic_speed": 0.01}, "friction.kinetic_speed = 0.01"),
        ({"crank__start_angle": 0.9}, "downstop.angle = 0.8"),
        ({"crank__start_angle": -1.31}, "upstop.angle = -1.3"),
    ],
)
def test_contradiction_is_rejected_with_its_name(instantiate: Start, values: dict[str, float], fragment: str) -> None:
    instance = instantiate()
    with pytest.raises(FMICallException):
        instance.start(**values)
    assert any(fragment in message for message in instance.messages), instance.messages
