"""What runs and steps of the landing gear cost from Python: by the module, and by FMPy with the FMU.

usage: module.py --fmu FMU --out PAGE

Each time is the least of many in this process, as a busy machine makes a call dearer and never cheaper.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

STOP, INTERVAL = 0.13, 1e-3
OUTPUTS = [
    *("crank.angle", "crank.speed", "crank.acceleration", "coupler.angle"),
    *("follower.angle", "actuator.length", "joint1.force", "joint4.force"),
]
INPUTS = ["actuator.force", "load_factor", "airspeed", "wheel.force_x"]
VALUES = [30000.0, 3.0, 0.0, 0.0]


def least(call: Callable[[], object], seconds: float = 2.0) -> float:
    """Least time of a call [us]."""
    found, end = float("inf"), time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        call()
        found = min(found, time.perf_counter() - start)
    return found * 1e6


def imported() -> float:
    """Least time of the import in a new interpreter [us]."""
    program = "import time; t = time.perf_counter(); import linkage_fmu; print(time.perf_counter() - t)"
    done = [
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True) for _ in range(20)
    ]
    return min(float(one.stdout) for one in done) * 1e6


def by_module() -> dict[str, float]:
    import linkage_fmu as lf

    gear = lf.example("LandingGearRetraction")
    simulation = gear.simulation()
    simulation.initialize()
    inputs, outputs = simulation.prepare(INPUTS), simulation.prepare(OUTPUTS[:4])
    given, values = np.array(VALUES), np.empty(4)

    def step() -> None:
        simulation.set(inputs, given)
        simulation.step(1e-9)
        simulation.get(outputs, values)

    def run() -> None:
        simulation.reset()
        simulation.initialize()
        simulation.run_until(STOP)

    return {
        "import": imported(),
        "simulate": least(lambda: gear.simulate(0.0, STOP, INTERVAL, output=OUTPUTS)),
        "step": least(step),
        "run": least(run),
    }


def by_fmpy(fmu: Path) -> dict[str, float]:
    folder = fmpy.extract(str(fmu))
    description = fmpy.read_model_description(folder)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="bench",
    )
    slave.instantiate()
    inputs = [references[name] for name in INPUTS]
    outputs = [references[name] for name in OUTPUTS[:4]]

    def start() -> None:
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()

    reached = 0.0

    def step() -> None:
        nonlocal reached
        slave.setReal(inputs, VALUES)
        slave.doStep(reached, 1e-9)
        reached += 1e-9
        slave.getReal(outputs)

    def run() -> None:
        slave.reset()
        start()
        slave.doStep(0.0, STOP)

    def simulate() -> None:
        fmpy.simulate_fmu(
            folder,
            validate=False,
            stop_time=STOP,
            output_interval=INTERVAL,
            output=OUTPUTS,
            model_description=description,
        )

    start()
    times = {"simulate": least(simulate, 4.0), "step": least(step), "run": least(run)}
    slave.freeInstance()
    return times


ROWS = (
    ("import", "`import linkage_fmu`", 30e3),
    ("simulate", "`simulate`: 0.13 s in rows of 1 ms, 8 outputs", 60.0),
    ("step", "a step with 4 values set and 4 read by prepared names", 1.0),
    ("run", "a run of 0.13 s by `reset`, without rows", 8.0),
)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--fmu", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    try:
        own = by_module()
    except ImportError as error:
        sys.exit(f"{error}: run `cargo fmu dist --test` first, which installs the wheel for this benchmark")
    other = by_fmpy(arguments.fmu)
    lines = [
        "# Runs and steps from Python\n",
        "`cargo fmu bench module` writes this file.\n",
        f"Machine: {platform.machine()}, {os.cpu_count()} cores, {platform.system()}. "
        f"Python {platform.python_version()}, numpy {np.__version__}, FMPy {version('FMPy')}.\n",
        "The landing gear, by the module, and by FMPy with the FMU unpacked and its description read. Least times.\n",
        "| what | by the module [us] | at most [us] | by FMPy [us] |\n|---|---|---|---|",
    ]
    for key, what, limit in ROWS:
        lines.append(f"| {what} | {own[key]:.3g} | {limit:g} | {f'{other[key]:.3g}' if key in other else ''} |")
    arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
