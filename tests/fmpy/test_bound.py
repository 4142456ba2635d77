"""The bound on the work of a step: FMPy ends a discarded step with a message, and the FMU reports the time reached."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import Start
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2DoStepStatus, fmi2LastSuccessfulTime, fmi2Terminated

SPAN = 0.13
"""Communication step that needs more integration steps than the bound allows [s]."""


def test_a_discarded_step_returns_the_time_reached(instantiate: Start) -> None:
    instance = instantiate().start(solver__max_steps=5.0)
    with pytest.raises(FMICallException) as refused:
        instance.slave.doStep(0.0, SPAN)
    assert refused.value.status == fmi2Discard
    assert "solver.max_steps = 5 was reached" in instance.messages[-1]
    time = instance.slave.getRealStatus(fmi2LastSuccessfulTime)
    assert 0.0 < time < SPAN
    assert instance.slave.getStatus(fmi2DoStepStatus) == fmi2Discard
    assert not instance.slave.getBooleanStatus(fmi2Terminated)
    other = instantiate().start()
    other.slave.doStep(0.0, time)
    assert instance.get("crank.angle") == pytest.approx(other.get("crank.angle"), abs=1e-7)


def test_simulate_fmu_ends_with_the_remedy(fmu: Path) -> None:
    messages: list[str] = []

    def log(_environment: int, _name: bytes, _status: int, _category: bytes, message: bytes) -> None:
        messages.append(message.decode())

    with pytest.raises(FMICallException):
        simulate_fmu(
            str(fmu), start_values={"solver.max_steps": 5}, stop_time=2 * SPAN, output_interval=SPAN, logger=log
        )
    assert any("was reached" in message for message in messages), messages
    assert all("solver.max_steps" in message for message in messages if "fmi2DoStep" in message), messages
