"""The lift boom of a forestry crane (PATU 655) with its cylinder: two FMUs by published numbers, coupled by preview.

    python examples/lift_boom/lift_boom.py target/fmu

The folder has LiftBoom.fmu and LiftBoomHydraulics.fmu, packed from mechanism.json and network.json in this folder.
Prints the holding force, the pressures at rest and while the boom moves, and the error of the angle for each
communication step, against one system integrated by SciPy (tests/networks/lift_boom.py).
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path
from types import TracebackType

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

SCHEDULE = ((0.2, 0.0), (1.4, 1.0), (1.8, 0.0), (2.6, -1.0), (3.0, 0.0))
"""Ends of the intervals [s] in which the valve has a command."""
STEPS = (1e-3, 2e-3, 5e-3, 10e-3)
"""Communication steps of the table [s]."""
REFERENCE = Path(__file__).with_name("reference.txt")
"""Times, angle of the boom and pressures of one system of boom and oil, by SciPy."""
SHARED = ("reduced_mass", "reduced_mass_derivative", "holding_force", "holding_force_derivative")


class Fmu:
    """An instance of an FMU of FMI 2.0, with its Reals by name."""

    def __init__(self, path: Path) -> None:
        self.folder = extract(path)
        described = read_model_description(self.folder)
        self.references = {variable.name: variable.valueReference for variable in described.modelVariables}
        self.slave = FMU2Slave(
            guid=described.guid,
            unzipDirectory=self.folder,
            modelIdentifier=described.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()

    def __enter__(self) -> Fmu:
        return self

    def __exit__(self, _kind: type | None, _error: Exception | None, _trace: TracebackType | None) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def get(self, *names: str) -> list[float]:
        return self.slave.getReal([self.references[name] for name in names])

    def set(self, **values: float) -> None:
        """`__` in a keyword stands for the dot in a name."""
        names = [name.replace("__", ".") for name in values]
        self.slave.setReal([self.references[name] for name in names], list(values.values()))


def connect(boom: Fmu, oil: Fmu) -> None:
    """Motion, mass and load of the boom at its cylinder become inputs of the oil."""
    motion = boom.get("cylinder.length", "cylinder.speed")
    values = boom.get(*(f"cylinder.{name}" for name in SHARED))
    oil.set(lift__length=motion[0], lift__speed=motion[1])
    oil.set(**{f"lift__{name}": value for name, value in zip(SHARED, values, strict=True)})


def couple(folder: Path, h: float, end: float = SCHEDULE[-1][0]) -> np.ndarray:
    """Time, angle of the boom and pressures of both chambers at the communication points, in steps of h [s]."""
    with Fmu(folder / "LiftBoom.fmu") as boom, Fmu(folder / "LiftBoomHydraulics.fmu") as oil:
        oil.set(preview__horizon=h)
        connect(boom, oil)
        boom.set(cylinder__force=oil.get("lift.preview.force_mean")[0])
        boom.slave.exitInitializationMode()
        oil.slave.exitInitializationMode()
        rows = []
        for k in range(round(end / h) + 1):
            time = k * h
            connect(boom, oil)
            rows.append([time, *boom.get("boom.angle"), *oil.get("lift.chamber_a.pressure", "lift.chamber_b.pressure")])
            oil.set(valve__command=next((u for until, u in SCHEDULE if time < until - 1e-9), 0.0))
            boom.set(cylinder__force=oil.get("lift.preview.force_mean")[0])
            boom.slave.doStep(time, h)
            oil.slave.doStep(time, h)
    return np.array(rows)


def holding_force(folder: Path) -> float:
    """Force of the cylinder that holds the boom at the start [N]."""
    with Fmu(folder / "LiftBoom.fmu") as boom:
        boom.slave.exitInitializationMode()
        return boom.get("cylinder.holding_force")[0]


def errors(found: np.ndarray) -> np.ndarray:
    """Largest errors of the angle [rad] and of the pressures [Pa] at the times of the reference."""
    reference = np.loadtxt(REFERENCE)
    rows = [np.abs(found[np.argmin(np.abs(found[:, 0] - row[0]))] - row)[1:] for row in reference]
    return np.max(rows, axis=0)


def main() -> None:
    parser = argparse.ArgumentParser(description="Couple the lift boom of a crane with its hydraulics.")
    parser.add_argument("folder", type=Path, help="folder of LiftBoom.fmu and LiftBoomHydraulics.fmu")
    folder = parser.parse_args().folder
    print(f"holding force at the start: {holding_force(folder):.2f} N")
    found = couple(folder, STEPS[0])
    print("time [s]   boom [deg]   p_A [bar]   p_B [bar]")
    for time in (0.1, 1.3, 1.7, 2.5, 2.9):
        row = found[round(time / STEPS[0])]
        print(f"{row[0]:8.1f}   {np.degrees(row[1]):10.3f}   {row[2] / 1e5:9.3f}   {row[3] / 1e5:9.3f}")
    print("step [ms]   error of the angle [rad]   errors of the pressures [Pa]")
    for h in STEPS:
        angle, *pressures = errors(couple(folder, h))
        print(f"{1e3 * h:9g}   {angle:24.1e}   {max(pressures):28.1e}", flush=True)


if __name__ == "__main__":
    main()
