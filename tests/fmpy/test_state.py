"""Saved states by FMPy's own methods: after a state is restored, the run is bit-identical to the run after it was
saved."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import Instance, Start
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

STEP = 1e-3
"""Communication step [s]."""
SAVED = 45
"""Steps before the state is saved."""
ALL = 150
"""Steps of the whole run: the gear is up after 131."""

KINDS: dict[str, dict[str, float | bool | str]] = {
    "no loss": {},
    "friction and bouncing": {"friction.enabled": True, "upstop.restitution": 0.6, "crank.length": 0.1756},
    "rigid_fem": {"solver.method": "rigid_fem", "solver.fem_step": 5e-5, "upstop.enabled": False},
}


def started(instance: Instance, kind: str) -> Instance:
    """Initialised, with the parameters of this kind."""
    for name, value in KINDS[kind].items():
        instance.set(name, value)
    return instance.start()


def on(instance: Instance, last: int = ALL) -> list[dict[str, str]]:
    """Steps from the saved state on under a changing force. Returns the bits of each output after some of the steps."""
    seen = []
    for i in range(SAVED, last):
        instance.set("actuator.force", 30_000.0 + 10.0 * i)
        instance.slave.doStep(i * STEP, STEP)
        if i % 7 == 0 or i == last - 1:
            seen.append({name: float(value).hex() for name, value in instance.outputs().items()})
    return seen


def test_the_description_declares_states(extracted: Path) -> None:
    description = read_model_description(extracted)
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_is_repeated_from_a_state(instantiate: Start, kind: str) -> None:
    last = 100 if kind == "rigid_fem" else ALL
    instance = started(instantiate(), kind).run(0, SAVED, STEP)
    state = instance.slave.getFMUstate()
    first = on(instance, last)
    instance.slave.setFMUstate(state)
    assert on(instance, last) == first
    fresh = instantiate()
    fresh.slave.setFMUstate(state)
    assert on(fresh, last) == first
    instance.slave.freeFMUstate(state)


IN_ANOTHER_PROCESS = """
import json, sys
from pathlib import Path
from conftest import Instance
from test_state import on, started
instance = Instance(Path(sys.argv[1]))
if sys.argv[3] != "instantiated":
    started(instance, sys.argv[3])
state = instance.slave.deSerializeFMUstate(Path(sys.argv[2]).read_bytes())
instance.slave.setFMUstate(state)
instance.slave.freeFMUstate(state)
print(json.dumps(on(instance, int(sys.argv[4]))))
"""


@pytest.mark.parametrize("other", ["instantiated", "no loss"])
@pytest.mark.parametrize("kind", KINDS)
def test_another_process_continues(instantiate: Start, extracted: Path, tmp_path: Path, kind: str, other: str) -> None:
    last = 100 if kind == "rigid_fem" else ALL
    instance = started(instantiate(), kind).run(0, SAVED, STEP)
    state = instance.slave.getFMUstate()
    file = tmp_path / "state"
    file.write_bytes(instance.slave.serializeFMUstate(state))
    instance.slave.freeFMUstate(state)
    command = [sys.executable, "-c", IN_ANOTHER_PROCESS, str(extracted), str(file), other, str(last)]
    process = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stderr
    assert json.loads(process.stdout.splitlines()[-1]) == on(instance, last)


def test_a_damaged_state_is_rejected(instantiate: Start) -> None:
    instance = instantiate().start().run(0, SAVED, STEP)
    state = instance.slave.getFMUstate()
    text = instance.slave.serializeFMUstate(state)
    before = instance.outputs()
    for damaged in [text[:-1], text + b"\0", text[:60] + bytes([text[60] ^ 1]) + text[61:], b"x" * len(text), b""]:
        instance.messages.clear()
        with pytest.raises(FMICallException):
            instance.slave.deSerializeFMUstate(damaged)
        assert any("fmi2DeSerializeFMUstate: " in message for message in instance.messages)
    assert instance.outputs() == before
    instance.slave.freeFMUstate(state)
