"""A packed FMU in FMPy: an instance with access to its variables by name."""

from __future__ import annotations

import shutil
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave


class Part:
    """One instance of an FMU."""

    def __init__(self, fmu: Path) -> None:
        self.folder = extract(fmu)
        description = read_model_description(self.folder)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="demo",
        )
        self.slave.instantiate()

    def close(self) -> None:
        """Free the instance and remove the extracted files."""
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def read(self, *names: str) -> list[float]:
        """Present values of Reals."""
        return self.slave.getReal([self.references[name] for name in names])

    def write(self, values: dict[str, float]) -> None:
        """Set Reals."""
        self.slave.setReal([self.references[name] for name in values], list(values.values()))

    def choose(self, name: str, value: bool) -> None:
        """Set a Boolean."""
        self.slave.setBoolean([self.references[name]], [value])

    def derivatives(self, name: str, values: list[float]) -> None:
        """Set the derivatives of an input in time, of orders 1 and up, for the next step."""
        references, orders = [self.references[name]] * len(values), list(range(1, len(values) + 1))
        self.slave.setRealInputDerivatives(references, orders, values)
