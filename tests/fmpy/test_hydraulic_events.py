"""Hydraulic FMUs of FMI 3.0 in event mode: steps end where valves open, at cushions and where locks release."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import REPOSITORY
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from test_own_mechanism import package

TOLERANCE = 1e-12
CUSHIONS = 0.321909557380281, 3.635331912853703
"""Times at which cushion A ends and cushion B starts in the retraction of the reference, gear and hydraulics as a
single system [s]."""
SHARED = (
    "length",
    "speed",
    "reduced_mass",
    "reduced_mass_derivative",
    "holding_force",
    "holding_force_derivative",
    "lower_limit",
    "upper_limit",
)


class Fmu:
    """An instance of FMI 3.0 in step mode, with event mode and early return."""

    def __init__(self, path: Path) -> None:
        self.folder = extract(str(path))
        described = read_model_description(self.folder)
        self.is_capable = described.coSimulation.hasEventMode and described.coSimulation.mightReturnEarlyFromDoStep
        self.references = {variable.name: variable.valueReference for variable in described.modelVariables}
        self.slave = FMU3Slave(
            guid=described.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=described.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.slave.instantiate(eventModeUsed=True, earlyReturnAllowed=True)
        self.slave.enterInitializationMode(tolerance=TOLERANCE, startTime=0.0)

    def start(self, **values: float) -> Fmu:
        self.set(**values)
        self.slave.exitInitializationMode()
        self.slave.updateDiscreteStates()
        self.slave.enterStepMode()
        return self

    def set(self, **values: float) -> None:
        names = [name.replace("__", ".") for name in values]
        self.slave.setFloat64([self.references[name] for name in names], list(values.values()))

    def get(self, *names: str) -> list[float]:
        return self.slave.getFloat64([self.references[name] for name in names])

    def flag(self, name: str) -> bool:
        return bool(self.slave.getBoolean([self.references[name]])[0])

    def step(self, time: float, size: float) -> tuple[bool, float]:
        """Make a step. Returns whether an event has occurred, and the time reached."""
        event, terminate, early, last = self.slave.doStep(time, size)
        assert not terminate
        assert early == (last < time + size)
        return bool(event), last

    def handle(self) -> None:
        self.slave.enterEventMode()
        self.slave.updateDiscreteStates()
        self.slave.enterStepMode()

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """FMUs of FMI 3.0 of the gear and of both kinds of hydraulics."""
    out = tmp_path_factory.mktemp("events")
    names = ("LandingGearRetraction", "HydraulicActuator", "HydraulicSystem")
    paths = [str(REPOSITORY / "modelDescription" / name) for name in names]
    done = package(Path(), *paths, "--fmi", "3", "--out", str(out), "--no-animation", "--no-results")
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture
def actuator(folder: Path) -> Iterator[Fmu]:
    fmu = Fmu(folder / "HydraulicActuator.fmi3.fmu")
    yield fmu
    fmu.close()


@pytest.fixture
def system(folder: Path) -> Iterator[Fmu]:
    fmu = Fmu(folder / "HydraulicSystem.fmi3.fmu")
    yield fmu
    fmu.close()


@pytest.mark.parametrize("size", [1e-3, 0.05, 1.0])
def test_a_step_ends_at_the_border_of_a_cushion(actuator: Fmu, size: float) -> None:
    """A motion of constant speed through the border, 30 mm from the retracted end: the time is known exactly."""
    assert actuator.is_capable
    actuator.start(actuator__length=0.43, actuator__speed=0.05, valve__command=0.3)
    time, ends = 0.0, []
    while time < 1.0 - 1e-12:
        event, reached = actuator.step(time, min(size, 1.0 - time))
        if event:
            ends.append(reached)
            actuator.handle()
        time = reached
    assert min(abs(end - 0.012 / 0.05) for end in ends) < 1e-11


def test_a_lock_releases_in_event_mode_alone(system: Fmu) -> None:
    """The pressure at the event is that of the lock, and its output changes when the event is handled."""
    assert system.is_capable
    system.start()
    time = 0.0
    while True:
        before = system.flag("uplock.engaged")
        event, time = system.step(time, 0.02)
        assert system.flag("uplock.engaged") == before
        assert time < 2.0
        if event:
            pressure = system.get("down_line.pressure")[0]
            system.handle()
            if not system.flag("uplock.engaged"):
                break
    assert pressure == pytest.approx(6e6, rel=1e-6)


def test_gear_and_actuator_reach_the_cushions_together(folder: Path) -> None:
    """The pair repeats the step up to an event with both FMUs."""
    gear = Fmu(folder / "LandingGearRetraction.fmi3.fmu")
    oil = Fmu(folder / "HydraulicActuator.fmi3.fmu")
    gear.slave.setBoolean([gear.references["downstop.enabled"]], [False])
    oil.set(command__ramp_amplitude=0.65, command__ramp_time=0.1)
    names = [f"actuator.{name}" for name in SHARED]

    def connect(size: float) -> None:
        motion = dict(zip((name.replace(".", "__") for name in names), gear.get(*names), strict=True))
        oil.set(preview__horizon=size, **motion)

    connect(1e-3)
    gear.start(actuator__force=0.0)
    oil.start()
    time, found = 0.0, []
    while time < 3.7:
        size = 1e-3
        saved = [fmu.slave.getFMUState() for fmu in (gear, oil)]
        # With the step size to the event, both FMUs reach the event.
        for _ in range(3):
            connect(size)
            gear.set(actuator__force=oil.get("preview.force_mean")[0])
            steps = [fmu.step(time, size) for fmu in (oil, gear)]
            reached = min(last for _, last in steps)
            if all(last == reached for _, last in steps):
                break
            size = reached - time
            for fmu, state in zip((gear, oil), saved, strict=True):
                fmu.slave.setFMUState(state)
        for fmu, state in zip((gear, oil), saved, strict=True):
            fmu.slave.freeFMUState(state)
        for fmu, (event, _) in zip((oil, gear), steps, strict=True):
            if event:
                found.append(reached)
                fmu.handle()
        time = reached
    for reference in CUSHIONS:
        # The coupling with a held mean force has an error of some 7e-6 rad, at 0.6 rad/s.
        assert min(abs(event - reference) for event in found) < 2e-5
    gear.close()
    oil.close()
