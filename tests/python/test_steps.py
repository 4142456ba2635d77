"""Simulations step by step."""

from __future__ import annotations

import copy
import threading

import linkage_fmu as lf
import numpy as np
import pytest

INPUTS = ["actuator.force", "load_factor", "airspeed", "wheel.force_x"]
OUTPUTS = ["crank.angle", "crank.speed", "joint1.force", "actuator.length"]


def test_steps_are_a_run(gear: lf.Mechanism, simulation: lf.Simulation) -> None:
    inputs, outputs = simulation.prepare(INPUTS), simulation.prepare(OUTPUTS)
    assert list(inputs) == INPUTS
    run = gear.simulate(stop_time=0.05, output_interval=1e-3, output=OUTPUTS)
    values, given = np.empty(4), np.array([30000.0, 3.0, 0.0, 0.0])
    for row in run[1:]:
        simulation.set(inputs, given)
        simulation.step(row["time"] - simulation.time)
        assert simulation.get(outputs, values) is values
        assert np.allclose(values, [row[name] for name in OUTPUTS], rtol=1e-9)
        assert np.array_equal(simulation.get(OUTPUTS), values)
    assert simulation.get("crank.angle") == simulation["crank.angle"] == values[0]


def test_every_kind_is_set_and_read(gear: lf.Mechanism) -> None:
    simulation = gear.simulation({"crank.start_angle": "30 deg"})
    assert simulation["crank.start_angle"] == pytest.approx(np.pi / 6)
    simulation["crank.start_angle"] = "-10deg"
    simulation["friction.enabled"] = True
    simulation["solver.method"] = "rigid_fem"
    simulation.set("actuator.force", 31000)
    simulation.set(["crank.mass", "load_factor"], [20, 1])
    assert simulation["friction.enabled"] is True
    simulation.set(["crank.start_angle", "friction.enabled", "solver.method"], ["-10 deg", "false", 1])
    assert simulation["friction.enabled"] is False
    assert simulation["solver.method"] == "reduced"
    simulation.set(["friction.enabled", "solver.method"], simulation.get(["friction.enabled", "solver.method"]))
    simulation.set(["friction.enabled", "solver.method"], np.array([1.0, 2.0]))
    assert simulation["friction.enabled"] is True
    assert simulation["solver.method"] == "rigid_fem"
    assert simulation["crank.start_angle"] == pytest.approx(-np.pi / 18)
    assert list(simulation.get(["crank.mass", "load_factor", "friction.enabled"])) == [20, 1, 1]
    simulation.reset()
    assert simulation["crank.mass"] == pytest.approx(13.689)
    assert "crank.mass" in simulation
    assert "crank.mas" not in simulation


def test_a_parameter_ends_a_run(simulation: lf.Simulation) -> None:
    simulation.step(1e-3)
    simulation["actuator.force"] = 2e4
    simulation.step(1e-3)
    simulation["crank.mass"] = 20.0
    with pytest.raises(lf.SimulationError, match=r"call initialize\(\)"):
        simulation.step(1e-3)
    simulation.initialize()
    assert simulation.time == 0.0
    simulation.step(1e-3)


def test_events_end_a_run_until(simulation: lf.Simulation) -> None:
    simulation.run_until(0.02)
    events = simulation.run_until(1.0, at_event=True)
    assert events, "nothing happened"
    assert all("t = 0.13205985" in line for line in events)
    assert "upstop" in " ".join(events)
    assert simulation.time == pytest.approx(0.132059852, abs=1e-8)
    assert simulation.run_until(simulation.time) == []


def test_saved_states_continue_identically(gear: lf.Mechanism, simulation: lf.Simulation) -> None:
    simulation.run_until(0.05)
    state, twin = simulation.save(), simulation.copy()
    assert copy.copy(simulation).time == copy.deepcopy(simulation).time == 0.05
    simulation.run_until(0.1)
    expected = simulation.get(OUTPUTS)
    twin.run_until(0.1)
    assert np.array_equal(twin.get(OUTPUTS), expected)
    other = gear.simulation()
    other.restore(other.state_from_bytes(state.to_bytes()))
    assert other.time == state.time == 0.05
    other.run_until(0.1)
    assert np.array_equal(other.get(OUTPUTS), expected)
    with pytest.raises(lf.InputError, match="saved state"):
        other.state_from_bytes(b"no state")
    with pytest.raises(lf.InputError):
        lf.example("FourBar").simulation().restore(state)


def test_derivatives_agree_with_differences(simulation: lf.Simulation) -> None:
    simulation.run_until(0.05)
    assert simulation.derivative("crank.angle") == pytest.approx(simulation["crank.speed"])
    outputs, inputs = ["crank.acceleration", "joint1.force"], ["actuator.force", "load_factor"]
    seeds = [1000.0, 0.1]
    found = simulation.directional_derivative(outputs, inputs, seeds)
    present, h = simulation.get(inputs), 1e-3
    sides = []
    for sign in (1, -1):
        simulation.set(inputs, present + sign * h * np.array(seeds))
        sides.append(simulation.get(outputs))
    assert found == pytest.approx((sides[0] - sides[1]) / (2 * h), rel=1e-6)
    simulation.set_derivative("actuator.force", 1e6)
    simulation.step(1e-3)
    assert simulation["actuator.force"] == pytest.approx(present[0] - h * seeds[0] + 1e3)


def test_derivatives_by_parameters_are_those_of_the_start(gear: lf.Mechanism) -> None:
    simulation = gear.simulation()
    (found,) = simulation.directional_derivative(["actuator.holding_force"], ["leg.mass"], [1.0])
    values = []
    for mass in (36.9, 36.7):
        simulation["leg.mass"] = mass
        values.append(simulation["actuator.holding_force"])
    assert found == pytest.approx((values[0] - values[1]) / 0.2, rel=1e-6)


def test_one_thread_at_a_time(gear: lf.Mechanism) -> None:
    """Calls from other threads are made, or rejected with a remedy. None does harm."""
    simulation = gear.simulation({"friction.enabled": True, "solver.tolerance": 1e-12})
    simulation.initialize()
    refused: list[str] = []
    done = threading.Event()

    def look() -> None:
        while not done.is_set():
            try:
                simulation.get("crank.angle")
            except lf.SimulationError as error:
                refused.append(str(error))

    thread = threading.Thread(target=look)
    thread.start()
    for k in range(200):
        try:
            simulation.run_until(0.0005 * (k + 1))
        except lf.SimulationError as error:
            refused.append(str(error))
    done.set()
    thread.join()
    assert all("another thread uses this simulation" in text for text in refused)
    assert np.isfinite(simulation["crank.angle"])


def test_a_missing_value_has_a_reason(simulation: lf.Simulation) -> None:
    assert simulation.undefined("crank.angle") is None
