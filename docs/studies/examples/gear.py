"""The packed landing gear as a function of parameters and inputs, through FMPy: one instance, run again and again."""

from __future__ import annotations

import tempfile
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

FORCES = (28e3, 36e3)
LOADS = (1.0, 3.0)
"""Ranges of the actuator's force [N] and of the load factor."""


class Gear:
    """An instance of the FMU."""

    def __init__(self, fmu: str | Path) -> None:
        self.folder = tempfile.TemporaryDirectory()
        extract(str(fmu), self.folder.name)
        description = read_model_description(self.folder.name)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder.name,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="gear",
        )
        self.slave.instantiate()

    def retraction(self, stop_time: float = 0.6, **values: float) -> float:
        """Time at which the gear is up [s]; -1 if it does not get there. `__` in a name stands for a dot.

        One step is enough: the time of the impact is exact whatever the step.
        """
        self.slave.reset()
        self.slave.setupExperiment(startTime=0.0)
        references = [self.references[name.replace("__", ".")] for name in values]
        self.slave.setReal(references, list(map(float, values.values())))
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.slave.doStep(0.0, stop_time)
        return self.slave.getReal([self.references["upstop.impact_time"]])[0]

    def close(self) -> None:
        """Free the instance, remove the files."""
        self.slave.terminate()
        self.slave.freeInstance()
        self.folder.cleanup()
