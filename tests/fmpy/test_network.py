"""The packed HydraulicSystem through FMPy: the sequence of door and gear, balances, saved states, derivatives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import FMU_FOLDER, Instance
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

FMU = FMU_FOLDER / "HydraulicSystem.fmu"
STEP = 1e-3
"""Communication step of the default experiment [s]."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU's files, which a test must not change."""
    assert FMU.is_file(), f"{FMU} is missing; run `cargo fmu package modelDescription/HydraulicSystem`"
    return Path(extract(FMU, str(tmp_path_factory.mktemp("network"))))


def test_the_description_is_valid() -> None:
    assert validate_fmu(str(FMU)) == []
    description = read_model_description(FMU)
    names = {variable.name for variable in description.modelVariables}
    assert {"engine_pump.speed", "selector.command", "gear_dump.open", "uplock.engaged"} <= names
    assert {"gear.preview.force_mean", "gear.reduced_mass", "door.chamber_a.pressure", "volume.balance"} <= names


def test_the_door_opens_before_the_gear_moves() -> None:
    outputs = ["door.length", "gear.length", "uplock.engaged", "volume.balance", "energy.balance", "energy.throttling"]
    result = simulate_fmu(str(FMU), output_interval=STEP, output=outputs)

    def first(is_so: np.ndarray) -> float:
        return float(result["time"][np.argmax(is_so)])

    released = first(result["uplock.engaged"] == 0)
    opened, moved = first(result["door.length"] > 0.4949), first(result["gear.length"] < 0.7349)
    down = first(result["gear.length"] < 0.4186)
    assert 0 < released < opened < moved < down < 12
    # The cylinders move 0.4 litres of oil. The integration has the tolerance 1e-9.
    assert np.abs(result["volume.balance"]).max() < 1e-12 * 4e-4
    assert np.abs(result["energy.balance"]).max() < 1e-7 * result["energy.throttling"][-1]


def test_a_saved_state_continues_bit_identically(folder: Path) -> None:
    instance = Instance(folder).start().run(0, 300, STEP)
    state = instance.slave.getFMUState()
    saved = instance.slave.serializeFMUState(state)
    expected = instance.run(300, 600, STEP).outputs()
    instance.slave.setFMUState(state)
    assert instance.run(300, 600, STEP).outputs() == expected
    instance.slave.setFMUState(instance.slave.deSerializeFMUstate(saved))
    assert instance.run(300, 600, STEP).outputs() == expected
    instance.slave.freeInstance()


def test_derivatives_are_those_of_the_values(folder: Path) -> None:
    instance = Instance(folder).start().run(0, 200, STEP)
    known, unknown = "door.speed", "door.force"
    references = [[instance.references[name]] for name in (unknown, known)]
    [exact] = instance.slave.getDirectionalDerivative(*references, [1.0])
    [speed], width = instance.get(known), 1e-6

    def force(at: float) -> float:
        instance.set(known, at)
        return instance.get(unknown)[0]

    difference = (force(speed + width) - force(speed - width)) / (2 * width)
    assert exact == pytest.approx(difference, rel=1e-6)
    instance.slave.freeInstance()
