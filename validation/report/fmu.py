"""An FMU through FMPy: start in a state, read outputs, step. Must not depend on the mechanism."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Self

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

Value = float | bool | str


class Fmu:
    """One instance of an FMU; variables are accessed by name."""

    def __init__(self, path: Path) -> None:
        self.folder = extract(str(path))
        description = read_model_description(self.folder)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="report",
        )
        self.slave.instantiate()
        self.time = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def has(self, name: str) -> bool:
        """Whether there is a variable of this name."""
        return name in self.variables

    def default(self, name: str) -> float:
        """Start value of a Real input or parameter."""
        return float(self.variables[name].start)

    def set(self, values: dict[str, Value]) -> None:
        """Set inputs or parameters; each value must be of its variable's type."""
        for name, value in values.items():
            reference = [self.variables[name].valueReference]
            match value:
                case bool():
                    self.slave.setBoolean(reference, [value])
                case str():
                    items = self.variables[name].declaredType.items
                    self.slave.setInteger(reference, [int(item.value) for item in items if item.name == value])
                case _:
                    self.slave.setReal(reference, [float(value)])

    def start(self, values: dict[str, Value]) -> Self:
        """Reset to t = 0 with all defaults except these values."""
        self.slave.reset()
        self.set(values)
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = 0.0
        return self

    def read(self, *names: str) -> list[float]:
        """Present values of several Reals."""
        return self.slave.getReal([self.variables[name].valueReference for name in names])

    def value(self, name: str) -> float:
        """Present value of one Real."""
        return self.read(name)[0]

    def step(self, size: float) -> None:
        """Make one communication step [s]."""
        self.slave.doStep(self.time, size)
        self.time += size
