"""The packed FMU, and instances of it, for the tests."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from ctypes import byref
from pathlib import Path
from typing import Any

import pytest
from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.logging import addLoggerProxy

NAME = "LandingGearRetraction"
REPOSITORY = Path(__file__).resolve().parents[2]
BUILT = os.environ.get("LINKAGE_FMU_PROGRAM")
"""The program of the studies that `cargo fmu test` has built, in a folder with the other programs."""


def program(name: str) -> list[str]:
    """The command that runs a program of the repository. Without `cargo fmu test`, cargo builds the program first. In a
    folder outside the repository, cargo does not find the flags of the compiler, and builds everything again."""
    if BUILT:
        return [str(Path(BUILT).with_name(name).with_suffix(Path(BUILT).suffix))]
    manifest = str(REPOSITORY / "Cargo.toml")
    return ["cargo", "run", "--release", "--quiet", "--manifest-path", manifest, "--package", name, "--"]


LONG = ("test_pages.py", "test_sweep_cluster.py", "test_simulate_command.py", "test_optimise.py", "test_crane.py")
"""Files of tests that take longest. Each file runs in one process, so these files come first."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files come first, in the order of `LONG`."""
    places = {name: place for place, name in enumerate(LONG)}
    items.sort(key=lambda item: places.get(item.path.name, len(LONG)))


MESSAGES: dict[int, list[str]] = {}
"""Messages of each instance, by its environment pointer; 0: instances that FMPy itself creates. FMPy's proxy has one
logger for the whole process."""


def log(environment: int | None, _name: bytes, _status: int, _category: bytes, message: bytes) -> None:
    """The common logger."""
    MESSAGES.setdefault(environment or 0, []).append(message.decode())


LOGGER = fmi2CallbackLoggerTYPE(log)


class Instance:
    """An instance of an extracted FMU: variables by name, messages in `messages`."""

    def __init__(self, folder: Path, guid: str | None = None) -> None:
        description = read_model_description(folder)
        environment = max(MESSAGES, default=0) + 1
        self.messages = MESSAGES.setdefault(environment, [])
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.references = {name: variable.valueReference for name, variable in self.variables.items()}
        self.slave = FMU2Slave(
            guid=description.guid if guid is None else guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="test",
        )
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = LOGGER
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.callbacks.componentEnvironment = environment
        addLoggerProxy(byref(self.callbacks))
        try:
            self.slave.instantiate(callbacks=self.callbacks)
        except Exception:
            self.slave.freeLibrary()
            raise RuntimeError("\n".join(self.messages)) from None

    def start(self, tolerance: float | None = None, **parameters: float) -> Instance:
        """Initialise at t = 0. `__` in a keyword stands for the dot in a name."""
        for name, value in parameters.items():
            self.set(name.replace("__", "."), value)
        self.slave.setupExperiment(tolerance=tolerance, startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def set(self, name: str, value: float | bool | str) -> None:
        """Set a Real, a Boolean, or an Enumeration by the name of an item."""
        if isinstance(value, str):
            items = self.variables[name].declaredType.items
            number = next(int(item.value) for item in items if item.name == value)
            self.slave.setInteger([self.references[name]], [number])
        else:
            set_values = self.slave.setBoolean if isinstance(value, bool) else self.slave.setReal
            set_values([self.references[name]], [value])

    def boolean(self, name: str) -> bool:
        """Read a Boolean."""
        return bool(self.slave.getBoolean([self.references[name]])[0])

    def get(self, *names: str) -> list[float]:
        """Read Reals."""
        return self.slave.getReal([self.references[name] for name in names])

    def outputs(self) -> dict[str, float | int]:
        """Every output."""
        read = {"Real": self.slave.getReal, "Boolean": self.slave.getBoolean}
        return {
            name: read[variable.type]([variable.valueReference])[0]
            for name, variable in self.variables.items()
            if variable.causality == "output"
        }

    def run(self, first: int, last: int, step: float) -> Instance:
        """Make steps number `first` to `last` - 1, all of one size."""
        for i in range(first, last):
            self.slave.doStep(i * step, step)
        return self


Start = Callable[..., Instance]


#: Folder of the packed FMUs.
FMU_FOLDER = Path(os.environ.get("LINKAGE_FMU_DIR", REPOSITORY / "target" / "fmu"))
#: The packed FMUs of both FMI versions, and those of FMI 2.0 alone.
BOTH_VERSIONS = sorted(FMU_FOLDER.glob("*.fmu"))
FMUS = [path for path in BOTH_VERSIONS if not path.name.endswith(".fmi3.fmu")]


@pytest.fixture(scope="session")
def fmu() -> Path:
    """The packed FMU. The environment variable LINKAGE_FMU_DIR names another folder than target/fmu."""
    path = FMU_FOLDER / f"{NAME}.fmu"
    assert path.is_file(), f"{path} is missing; run `cargo fmu package`"
    return path


@pytest.fixture(scope="session")
def extracted(fmu: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU's files, which a test must not change."""
    return Path(extract(fmu, str(tmp_path_factory.mktemp("fmu"))))


@pytest.fixture
def copied(extracted: Path, tmp_path: Path) -> Path:
    """A copy of the FMU's files, which a test may change."""
    return Path(shutil.copytree(extracted, tmp_path / "fmu"))


@pytest.fixture
def instantiate(extracted: Path) -> Iterator[Start]:
    """Creates instances of the FMU and frees them after the test."""
    instances: list[Instance] = []

    def make(folder: Path = extracted, guid: str | None = None) -> Instance:
        instances.append(Instance(folder, guid))
        return instances[-1]

    yield make
    for instance in instances:
        instance.slave.freeInstance()


Edit = Callable[[Callable[[dict[str, Any]], None]], Path]


@pytest.fixture
def edited(copied: Path) -> Edit:
    """Changes resources/mechanism.json in a copy of the FMU."""

    def change(mutate: Callable[[dict[str, Any]], None]) -> Path:
        path = copied / "resources" / "mechanism.json"
        mechanism = json.loads(path.read_text(encoding="utf-8"))
        mutate(mechanism)
        path.write_text(json.dumps(mechanism), encoding="utf-8")
        return copied

    return change
