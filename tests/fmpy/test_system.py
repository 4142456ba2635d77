"""The landing-gear system: three FMUs of an SSP package, run by the demo. The valves determine the sequence of door,
locks and gear. The times of the events do not depend on the communication step by more than some steps."""

from __future__ import annotations

import sys

import pytest
from conftest import FMU_FOLDER, REPOSITORY
from fmpy.ssp.ssd import read_ssd

sys.path.append(str(REPOSITORY / "fmu-build" / "python"))
import demo_system

PACKAGE = FMU_FOLDER / "LandingGearSystem.ssp"
RETRACTION = (
    "door lock releases",
    "door starts to open",
    "door is open",
    "downlock releases",
    "gear leaves the down stop",
    "gear is up",
    "door starts to close",
    "door is closed",
    "door lock engages",
)
EXTENSION = (
    "door lock releases",
    "door starts to open",
    "door is open",
    "uplock releases",
    "gear leaves the up stop",
    "gear is down",
    "door starts to close",
    "door is closed",
    "door lock engages",
)
EMERGENCY = ("door lock releases", "door starts to open", "door is open", "uplock releases", "gear is down")
STEPS = (5e-3, 10e-3)
"""Communication steps that are compared with the step of the reference [s]."""
SHORT = 1e-3
"""Communication step of the reference [s]."""
LATE = {5e-3: 0.012, 10e-3: 0.03}
"""Largest difference of the time of an event [s]."""


@pytest.fixture(scope="module")
def runs() -> dict[float, demo_system.Run]:
    """The run with steps of several sizes."""
    assert PACKAGE.is_file(), f"{PACKAGE} is missing; run `cargo fmu package --ssp`"
    return {step: demo_system.run(PACKAGE, step) for step in (SHORT, *STEPS)}


def sequences(found: demo_system.Run) -> list[dict[str, float]]:
    """Times of the events after each action of the pilot."""
    parts: list[dict[str, float]] = []
    for time, words in found.events:
        if words.startswith("--"):
            parts.append({})
        else:
            assert words not in parts[-1], f"{words} twice, at {time} s"
            parts[-1][words] = time
    return parts


@pytest.mark.parametrize("step", [SHORT, *STEPS])
def test_the_valves_make_the_order(runs: dict[float, demo_system.Run], step: float) -> None:
    parts = sequences(runs[step])
    assert len(parts) == 4
    for part, order in zip(parts, (RETRACTION, EXTENSION, RETRACTION, EMERGENCY), strict=True):
        times = [part[words] for words in order]
        # Events of one step are in the order of the list of states.
        assert times == sorted(times), part
        assert times[-1] > times[0] + 1
    # The locks hold the gear at its ends.
    for end in ("gear is up", "gear is down"):
        assert end in {words for part in parts for words in part}
    last = {(part, name): runs[step].state(part, name)[-1] for part, name, *_ in demo_system.STATES}
    assert last["gear", "extended"]
    assert last["door", "open"]
    assert last["hydraulics", "downlock.engaged"]


@pytest.mark.parametrize("step", STEPS)
def test_times_do_not_depend_on_the_step(runs: dict[float, demo_system.Run], step: float) -> None:
    for short, long in zip(sequences(runs[SHORT]), sequences(runs[step]), strict=True):
        assert set(short) == set(long)
        for words, time in short.items():
            assert abs(long[words] - time) < LATE[step], words


def test_volume_and_energy_balances_are_closed(runs: dict[float, demo_system.Run]) -> None:
    for found in runs.values():
        moved = max(found.column("hydraulics", "volume.from_reservoirs"))
        assert max(map(abs, found.column("hydraulics", "volume.balance"))) < 1e-9 * moved
        throttled = found.column("hydraulics", "energy.throttling")[-1]
        assert max(map(abs, found.column("hydraulics", "energy.balance"))) < 1e-6 * throttled


def test_the_package_is_a_valid_system() -> None:
    """Valid by the schema of SSP. In the order of `System` no output depends on itself."""
    system = read_ssd(str(PACKAGE), validate=True).system
    assert [element.name for element in system.elements] == ["gear", "door", "hydraulics"]
    assert len(system.connections) == 3 + 2 * (9 + 1)
    demo_system.System(PACKAGE).close()
