"""Calls that the FMU rejects: a rejected call changes nothing."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

import pytest
from conftest import Edit, Instance, Start
from fmpy.fmi1 import FMICallException

STEP = 1e-3
"""Communication step [s]."""
BEFORE = 40
"""Steps before the rejected call."""
ALL = 100
"""Steps of the whole run."""
NOWHERE = 4_000_000_000
"""A value reference that no mechanism has."""

BAD_CALLS: dict[str, Callable[[Instance], Any]] = {
    "input is NaN": lambda i: i.set("actuator.force", math.nan),
    "input is infinite": lambda i: i.set("load_factor", -math.inf),
    "second of two inputs is NaN": lambda i: i.slave.setReal(
        [i.references["actuator.force"], i.references["load_factor"]], [1.0, math.nan]
    ),
    "second of two references is unknown": lambda i: i.slave.setReal(
        [i.references["actuator.force"], NOWHERE], [1.0, 2.0]
    ),
    "set unknown Real": lambda i: i.slave.setReal([NOWHERE], [1.0]),
    "get unknown Real": lambda i: i.slave.getReal([NOWHERE]),
    "get unknown Boolean": lambda i: i.slave.getBoolean([NOWHERE]),
    "get Real as Boolean": lambda i: i.slave.getBoolean([i.references["crank.angle"]]),
    "set an output": lambda i: i.set("crank.angle", 0.1),
    "set a fixed parameter": lambda i: i.set("crank.length", 0.2),
    "step of zero": lambda i: i.slave.doStep(BEFORE * STEP, 0.0),
    "step backwards": lambda i: i.slave.doStep(BEFORE * STEP, -STEP),
    "step of NaN": lambda i: i.slave.doStep(BEFORE * STEP, math.nan),
    "step without end": lambda i: i.slave.doStep(BEFORE * STEP, math.inf),
    "wrong time": lambda i: i.slave.doStep((BEFORE + 1) * STEP, STEP),
    "time is NaN": lambda i: i.slave.doStep(math.nan, STEP),
    "set up again": lambda i: i.slave.setupExperiment(tolerance=1e-4),
    "enter initialization again": lambda i: i.slave.enterInitializationMode(),
    "exit initialization again": lambda i: i.slave.exitInitializationMode(),
}


@pytest.mark.parametrize("name", BAD_CALLS)
def test_rejected_call_changes_nothing(instantiate: Start, name: str) -> None:
    disturbed, undisturbed = instantiate(), instantiate()
    for instance in (disturbed, undisturbed):
        instance.start().run(0, BEFORE, STEP)
    before = disturbed.outputs()
    disturbed.messages.clear()
    with pytest.raises(FMICallException):
        BAD_CALLS[name](disturbed)
    assert disturbed.messages, "nothing was logged"
    assert disturbed.outputs() == before
    disturbed.run(BEFORE, ALL, STEP)
    undisturbed.run(BEFORE, ALL, STEP)
    assert disturbed.outputs() == undisturbed.outputs()


EARLY_CALLS: dict[str, Callable[[Instance], Any]] = {
    "step": lambda i: i.slave.doStep(0.0, STEP),
    "exit initialization": lambda i: i.slave.exitInitializationMode(),
    "terminate": lambda i: i.slave.terminate(),
}


@pytest.mark.parametrize("name", EARLY_CALLS)
def test_call_before_initialization_is_rejected(instantiate: Start, name: str) -> None:
    instance = instantiate()
    with pytest.raises(FMICallException):
        EARLY_CALLS[name](instance)
    assert instance.start().run(0, ALL, STEP).outputs() == instantiate().start().run(0, ALL, STEP).outputs()


def test_step_after_terminate_is_rejected(instantiate: Start) -> None:
    instance = instantiate().start().run(0, BEFORE, STEP)
    instance.slave.terminate()
    with pytest.raises(FMICallException):
        instance.slave.doStep(BEFORE * STEP, STEP)


def test_step_past_the_stop_time_is_rejected(instantiate: Start) -> None:
    instance = instantiate()
    instance.slave.setupExperiment(startTime=0.0, stopTime=0.05)
    instance.slave.enterInitializationMode()
    instance.slave.exitInitializationMode()
    instance.run(0, 50, STEP)
    with pytest.raises(FMICallException):
        instance.slave.doStep(0.05, STEP)


def test_wrong_guid_is_rejected(instantiate: Start) -> None:
    with pytest.raises(RuntimeError, match=r"(?i)guid"):
        instantiate(guid="{00000000-0000-0000-0000-000000000000}")


def test_missing_mechanism_is_rejected(instantiate: Start, copied: Path) -> None:
    (copied / "resources" / "mechanism.json").unlink()
    with pytest.raises(RuntimeError, match=r"mechanism\.json"):
        instantiate(copied)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "\x00\x01"])
def test_text_that_is_no_mechanism_is_rejected(instantiate: Start, copied: Path, text: str) -> None:
    (copied / "resources" / "mechanism.json").write_text(text, encoding="utf-8")
    with pytest.raises(RuntimeError, match=r"."):
        instantiate(copied)


def put(*path: str, value: Any) -> Callable[[dict], None]:  # noqa: ANN401 - any JSON value
    """A mutation that sets one key."""
    return lambda mechanism: reduce(getitem, path[:-1], mechanism).update({path[-1]: value})


def drop(*path: str) -> Callable[[dict], None]:
    """A mutation that removes one key."""
    return lambda mechanism: reduce(getitem, path[:-1], mechanism).pop(path[-1])


MALFORMED = [
    *[(drop(key), key) for key in ("name", "bodies", "joints", "start")],
    (put("jionts", value={}), "jionts"),
    (put("bodies", "crank", "lenght", value=1.0), "lenght"),
    (put("gravity", "direction", value=0.0), "direction"),
    (drop("bodies", "crank", "length"), "length"),
    (put("bodies", "crank", "length", value=0.0), "length"),
    (put("bodies", "crank", "length", value=-0.1755), "length"),
    (put("bodies", "coupler", "mass", value=-1.0), "mass"),
    (put("bodies", "coupler", "shape", value="sphere"), "sphere"),
    (put("bodies", "leg", "fixed_to", value="carnk.origin"), "carnk"),
    (put("joints", "joint2", "type", value="revolut"), "revolut"),
    (put("joints", "joint2", "first", value="crank.nowhere"), "nowhere"),
    (put("joints", "joint2", "second", value="cuopler.origin"), "cuopler"),
    (drop("joints", "joint3", "second"), "second"),
    (put("actuators", "actuator", "first", value="crank.actuatr"), "actuatr"),
    (put("start", "body", value="crnak"), "crnak"),
    (put("guess", "copuler", value=1.0), "copuler"),
    (put("experiment", "stop_time", value=-1.0), "stop_time"),
    (put("experiment", "step_size", value=0.0), "step_size"),
    (put("solver", "tolerance", value=0.0), "tolerance"),
    (put("solver", "tolerance", value=2.0), "tolerance"),
]


@pytest.mark.parametrize(("mutate", "fragment"), MALFORMED, ids=[f"{i}-{m[1]}" for i, m in enumerate(MALFORMED)])
def test_malformed_mechanism_is_rejected_with_its_name(
    instantiate: Start, edited: Edit, mutate: Callable[[dict], None], fragment: str
) -> None:
    folder = edited(mutate)
    with pytest.raises(RuntimeError, match=fragment):
        instantiate(folder)


def test_linkage_that_cannot_close_is_rejected(instantiate: Start, edited: Edit) -> None:
    """The error occurs at the instantiation or at the initialisation. No step is made."""
    folder = edited(put("bodies", "coupler", "length", value=1e-3))
    messages: list[str] = []

    def attempt() -> None:
        instance = instantiate(folder)
        try:
            instance.start()
        finally:
            messages.extend(instance.messages)

    with pytest.raises((RuntimeError, FMICallException)) as refusal:
        attempt()
    assert messages or str(refusal.value)
