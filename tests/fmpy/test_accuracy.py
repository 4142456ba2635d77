"""Scene S1 (30 kN, load factor 3, from rest) against the 34-digit quadrature of the energy equation."""

from __future__ import annotations

import pytest
from conftest import Start

REFERENCE = {
    0.02: 0.75457503788320041,
    0.05: 0.50930198670390647,
    0.10: -0.40913523120016843,
    0.13: -1.2377117266891367,
}
"""Angle of the crank [rad] at a time [s]."""
STEP = 1e-3
"""Communication step [s]."""
FORCE = 30000.0
"""Force of the actuator [N]."""
ROUND_OFF = 1e-11
"""Angle error at tolerance 1e-13 [rad]: 100 x the tolerance, or the relative error 1e-13 of the tables, grown over the
run."""
GLOBAL_OVER_LOCAL = 100.0
"""Stated ratio of the angle error at 0.13 s to the tolerance of one step [rad]."""
DRIFT_OF_WORK = 1e-9
"""Energy drift divided by the work at tolerance 1e-12: the stated 100 x 1e-12, and a factor 10 for the scale of angle
and energy."""


@pytest.mark.parametrize("time", REFERENCE)
def test_angle_at_the_tightest_tolerance(instantiate: Start, time: float) -> None:
    instance = instantiate().start(tolerance=1e-13).run(0, round(time / STEP), STEP)
    assert instance.get("crank.angle")[0] == pytest.approx(REFERENCE[time], abs=ROUND_OFF, rel=0.0)


@pytest.mark.parametrize("exponent", range(4, 13))
def test_error_follows_the_tolerance(instantiate: Start, exponent: int) -> None:
    tolerance = 10.0**-exponent
    instance = instantiate().start(tolerance=tolerance).run(0, 130, STEP)
    assert abs(instance.get("crank.angle")[0] - REFERENCE[0.13]) <= GLOBAL_OVER_LOCAL * tolerance


def test_tolerance_parameter_is_the_default(instantiate: Start) -> None:
    by_parameter = instantiate().start(solver__tolerance=1e-6).run(0, 100, STEP)
    by_experiment = instantiate().start(tolerance=1e-6).run(0, 100, STEP)
    assert by_parameter.outputs() == by_experiment.outputs()


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
def test_splitting_a_step_changes_no_more_than_the_tolerance(instantiate: Start, tolerance: float) -> None:
    """The error is relative to the size of the state: 1.24 rad and 30 rad/s at 0.13 s."""
    names = ("crank.angle", "crank.speed")
    whole = instantiate().start(tolerance=tolerance).run(0, 1, 0.13).get(*names)
    for steps in (130, 13000):
        parts = instantiate().start(tolerance=tolerance).run(0, steps, 0.13 / steps).get(*names)
        assert parts == pytest.approx(whole, rel=tolerance, abs=0.0), steps


def test_energy_is_kept(instantiate: Start) -> None:
    instance = instantiate().start(tolerance=1e-12)
    kinetic, potential, length = instance.get("energy.kinetic", "energy.potential", "actuator.length")
    for i in range(130):
        instance.run(i, i + 1, STEP)
        now = instance.get("energy.kinetic", "energy.potential", "actuator.length", "energy.drift")
        work = FORCE * (now[2] - length)
        assert work > 0.0
        # A drift within the rounding of the energies is not an error.
        bound = DRIFT_OF_WORK * work + 1e-15 * (abs(potential) + now[0] + abs(now[1]))
        assert abs(now[3]) <= bound, i
        assert abs(now[0] - kinetic + now[1] - potential - work) <= bound, i
    assert work > 9000.0


def test_same_run_same_bits(instantiate: Start) -> None:
    first, second = (instantiate().start().run(0, 130, STEP).outputs() for _ in range(2))
    assert first == second


def test_reset_gives_a_fresh_instance(instantiate: Start) -> None:
    used, fresh = instantiate(), instantiate()
    used.start(load_factor=2.0, crank__start_angle=0.7).run(0, 50, STEP)
    used.slave.reset()
    assert used.start().run(0, 130, STEP).outputs() == fresh.start().run(0, 130, STEP).outputs()
