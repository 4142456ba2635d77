"""The importers: how each simulates the landing gear in a case. A run gives the outputs after every step."""

from __future__ import annotations

import importlib.metadata
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import fmi_sim

STEP = 1e-3
"""Communication step [s]."""
STEPS = 130
"""Number of steps of a run."""
CHANGE = 50
"""Step before which the input changes in the case `input`."""

OUTPUTS = ("crank.angle", "crank.speed", "joint2.force", "actuator.length")
"""Outputs that are compared after every step."""


@dataclass(frozen=True)
class Case:
    """One run: values set before initialisation, and a value of actuator.force [N] from step CHANGE on."""

    title: str
    start: dict[str, float] = field(default_factory=dict)
    later_force: float | None = None


CASES = {
    "defaults": Case("all defaults"),
    "start": Case(
        "start values `crank.start_angle` = 0.7 rad, `actuator.force` = 28 kN",
        {"crank.start_angle": 0.7, "actuator.force": 28000.0},
    ),
    "input": Case("`actuator.force` from 30 to 25 kN at 0.05 s", later_force=25000.0),
}

Rows = list[list[float]]


def fmpy(fmu: Path, case: Case) -> Rows:
    """FMPy's own loop, `simulate_fmu`."""
    import numpy as np
    from fmpy import simulate_fmu

    signal = None
    if case.later_force is not None:
        columns = np.dtype([("time", np.float64), ("actuator.force", np.float64)])
        change = CHANGE * STEP
        signal = np.array(
            [(0.0, 30000.0), (change, 30000.0), (change, case.later_force), (1.0, case.later_force)], columns
        )
    result = simulate_fmu(
        str(fmu),
        stop_time=STEPS * STEP,
        output_interval=STEP,
        start_values=case.start,
        input=signal,
        output=list(OUTPUTS),
    )
    return [[float(row[name]) for name in OUTPUTS] for row in result[1:]]


def libcosim(fmu: Path, case: Case) -> Rows:
    """libcosim through libcosimpy with its fixed-step algorithm; an observer gives the last values."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(str(fmu), "gear"))
    references = {variable.name.decode(): variable.reference for variable in execution.slave_variables(slave)}
    observer = CosimObserver.create_last_value()
    manipulator = CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    for name, value in case.start.items():
        assert execution.real_initial_value(slave, references[name], value)
    rows = []
    for n in range(STEPS):
        if n == CHANGE and case.later_force is not None:
            assert manipulator.slave_real_values(slave, [references["actuator.force"]], [case.later_force])
        assert execution.step(), f"step {n}"
        rows.append(list(observer.last_real_values(slave, [references[name] for name in OUTPUTS])))
    return rows


def ecos(fmu: Path, case: Case) -> Rows:
    """ECOS through ecospy."""
    import ctypes

    # The library of ecospy needs oneTBB, which its wheel installs in the lib folder of the environment.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    rows = []
    with EcosSimulationStructure() as structure:
        structure.add_model("gear", str(fmu))
        structure.add_parameter_set("changed", {f"gear::{name}": value for name, value in case.start.items()})
        with EcosSimulation(structure=structure, step_size=STEP) as simulation:
            assert simulation.init(parameter_set="changed" if case.start else None)
            for n in range(STEPS):
                if n == CHANGE and case.later_force is not None:
                    simulation.set_real("gear::actuator.force", case.later_force)
                simulation.step(1)
                rows.append([simulation.get_real(f"gear::{name}") for name in OUTPUTS])
            simulation.terminate()
    return rows


def rust(fmu: Path, case: Case) -> Rows:
    """fmi-sim. With FMI 2.0 it uses the value before a jump at a communication point, so that the table of inputs jumps
    half a step earlier."""
    options = ["--output-interval", f"{STEP:g}", "-f", f"{STEPS * STEP:g}"]
    for name, value in case.start.items():
        options += ["--init-values", f"{name}={value:g}"]
    signal = None
    if case.later_force is not None:
        change = (CHANGE if fmu == third(fmu) else CHANGE - 0.5) * STEP
        times = ((0.0, 30000.0), (change, 30000.0), (change, case.later_force), (1.0, case.later_force))
        signal = "time,actuator.force\n" + "".join(f"{time:g},{force:g}\n" for time, force in times)
    table = fmi_sim.run(fmu, "co-simulation", *options, signal=signal)
    return [[row[name] for name in OUTPUTS] for row in table[1:]]


@dataclass(frozen=True)
class Importer:
    """An importer: its name, the package that contains it, and the function that runs a case."""

    title: str
    package: str
    run: Callable[[Path, Case], Rows]

    def release(self) -> str:
        """Name and version of the package."""
        version = fmi_sim.version() if self.package == "fmi-sim" else importlib.metadata.version(self.package)
        return f"{self.package} {version}"


IMPORTERS = {
    "fmpy": Importer("FMPy", "FMPy", fmpy),
    "libcosim": Importer("libcosim (libcosimpy)", "libcosimpy", libcosim),
    "ecos": Importer("ECOS (ecospy)", "ecospy", ecos),
}
OF_FMI_3 = {"fmpy3": Importer("FMPy, FMI 3.0", "FMPy", lambda fmu, case: fmpy(third(fmu), case))}
"""Importers that run the FMU of FMI 3.0, without the spy, which has the functions of FMI 2.0 only."""
if fmi_sim.program():
    IMPORTERS["fmi_sim"] = Importer("fmi-sim", "fmi-sim", rust)
    OF_FMI_3["fmi_sim3"] = Importer("fmi-sim, FMI 3.0", "fmi-sim", lambda fmu, case: rust(third(fmu), case))


def third(fmu: Path) -> Path:
    """Path of the FMU of FMI 3.0 next to the FMU of FMI 2.0."""
    return fmu if fmu.name.endswith(".fmi3.fmu") else fmu.with_suffix(".fmi3.fmu")
