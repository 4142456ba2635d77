"""Many runs of the landing gear by several ways, and what a run costs.

usage: studies.py FMU --program PROGRAM --mechanism FOLDER --out PAGE --work DIR [--scale PART]

A run: the time of the impact on the up-stop for a force of the actuator and a load factor, and nothing else. CPU time
is that of this process and of all that it has started, of the larger of two numbers of runs less that of the smaller
one, so that what comes once does not count.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import dask
import fmpy
import numpy as np
from dask import bag
from fmpy.fmi2 import FMU2Slave

FORCES, LOADS = (28e3, 40e3), (1.0, 3.0)
STOP = 0.3
"""Longer than every run [s]."""
OUTPUT = "upstop.impact_time"
SEED = 1
CHUNKS = 10
"""Number of partitions of the bag, as in FMPy's example."""
STEPS = 20
"""MuJoCo's steps in a run: RK4, a time constant of two steps; an error of 2e-7 rad (validation/results/peers.csv)."""

SLOWER = (0.9, 1.0)
"""Range of the actuator's force with MuJoCo, relative to 30 kN."""
TURNED = (-2.1, -1.4)
"""Total angle by which the crank of such a run must turn [rad]."""

LOOK = 0.005
"""Time between two readings of the memory of a process [s]."""

Points = np.ndarray


def points(count: int) -> Points:
    """Random forces and load factors."""
    return np.random.default_rng(SEED).uniform(*zip(FORCES, LOADS, strict=True), size=(count, 2))


@dataclass(frozen=True)
class Way:
    """A way to execute runs, with two numbers of runs."""

    name: str
    run: Callable[[int], None]
    few: int
    many: int
    times: int = 1
    """Number of measurements; the least counts."""


def spent() -> float:
    """CPU time of this process and of its finished child processes [s]."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in both)


def cost(way: Way) -> tuple[float, float]:
    """CPU time and elapsed time of a run [s]: the least of several, as other load on a machine only lengthens runs."""
    measured = {way.few: [], way.many: []}
    # The first call reads and compiles files that later calls find in the caches.
    way.run(way.few)
    for _ in range(way.times):
        for count, all_ in measured.items():
            before, began = spent(), time.perf_counter()
            way.run(count)
            all_.append((spent() - before, time.perf_counter() - began))
    [few, many] = ([min(column) for column in zip(*all_, strict=True)] for all_ in measured.values())
    runs = way.many - way.few
    if many[0] < 2.0 * few[0]:
        raise RuntimeError(f"{way.name}: {way.many} runs take {many[0]} s, {way.few} runs {few[0]} s: take more runs")
    return (many[0] - few[0]) / runs, (many[1] - few[1]) / runs


TIME = {"met": {"event": "retracted"}}
"""Outputs of a run that the energy integral alone gives."""
BOTH_STOPS = TIME | {"down": {"event": "extended"}}
"""The time of this stop, and that of a stop that no run reaches."""
AT_STOP = TIME | {"impulse": {"final": "upstop.impact_impulse"}}
"""The same outputs, and an output just after the impact."""
RESTITUTION = {"upstop.restitution": {"values": [0]}}
"""A factor with one value that is no load, so that runs advance by steps."""
FORCE_AND_LOAD = {"actuator.force": {"uniform": FORCES}, "load_factor": {"uniform": LOADS}}
"""Factors of the runs."""


class Native:
    """`cargo fmu sweep`, in the engine or on Dask's workers."""

    def __init__(
        self,
        arguments: argparse.Namespace,
        *options: str,
        factors: dict | None = None,
        responses: dict = TIME,
    ) -> None:
        self.program, self.work, self.options = arguments.program, arguments.work, options
        self.mechanism = arguments.fmu if "--workers" in options else arguments.mechanism
        self.factors, self.responses = factors or FORCE_AND_LOAD | RESTITUTION, responses
        self.memory = 0

    def __call__(self, count: int) -> None:
        study = {
            "mechanism": str(self.mechanism.resolve()),
            "factors": self.factors,
            "sampling": {"method": "random", "count": count, "seed": SEED},
            "scenario": {"stop_time": STOP, "stop_at": "retracted"},
            "responses": self.responses,
        }
        path = self.work / "study.json"
        path.write_text(json.dumps(study), encoding="utf-8")
        out = self.work / "out"
        shutil.rmtree(out, ignore_errors=True)
        command = [str(self.program), "sweep", str(path), "--out", str(out), *self.options]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        # At its end, the resource usage of a process includes the memory of this one, of which it starts as a copy.
        state = Path("/proc", str(process.pid), "status")
        self.memory = 0
        while process.poll() is None:
            found = [line for line in state.read_text().splitlines() if line.startswith("VmHWM:")]
            self.memory = int(found[0].split()[1]) if found else self.memory
            time.sleep(LOOK)
        if process.returncode != 0:
            raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}")
        shutil.rmtree(out, ignore_errors=True)


def in_a_loop(fmu: str) -> Callable[[int], None]:
    """`fmpy.simulate_fmu` with a file, as on the first page of FMPy's documentation."""

    def run(count: int) -> None:
        for force, load in points(count):
            values = {"actuator.force": force, "load_factor": load}
            fmpy.simulate_fmu(fmu, start_values=values, output=[OUTPUT], stop_time=STOP, output_interval=STOP)

    return run


def in_an_efficient_loop(fmu: str) -> Callable[[int], None]:
    """`fmpy.simulate_fmu` with the objects it needs created once, as in FMPy's example efficient_loops."""
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(folder)
    instance = fmpy.instantiate_fmu(unzipdir=folder, model_description=description)

    def run(count: int) -> None:
        for force, load in points(count):
            instance.reset()
            fmpy.simulate_fmu(
                folder,
                start_values={"actuator.force": force, "load_factor": load},
                output=[OUTPUT],
                stop_time=STOP,
                output_interval=STOP,
                model_description=description,
                fmu_instance=instance,
            )

    return run


def part_of_the_bag(part: list[tuple[float, float]], arguments: dict, start: list[int], result: list[int]) -> list:
    """Runs of one partition: FMPy's example parameter_variation with one step instead of many."""
    fmu = FMU2Slave(**arguments)
    fmu.instantiate()
    times = []
    for force, load in part:
        fmu.reset()
        fmu.setupExperiment()
        fmu.setReal(vr=start, value=[force, load])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(currentCommunicationPoint=0.0, communicationStepSize=STOP)
        times.append(fmu.getReal(result)[0])
    fmu.terminate()
    fmu.freeInstance()
    return times


def in_a_bag(fmu: str) -> Callable[[int], None]:
    """FMPy with a bag of Dask, in processes."""
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(folder)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    arguments = {
        "guid": description.guid,
        "modelIdentifier": description.coSimulation.modelIdentifier,
        "unzipDirectory": folder,
    }
    start, result = [references["actuator.force"], references["load_factor"]], [references[OUTPUT]]

    def run(count: int) -> None:
        values = [tuple(point) for point in points(count)]
        parts = bag.from_sequence(values, npartitions=CHUNKS)
        times = parts.map_partitions(part_of_the_bag, arguments, start, result).compute(scheduler="processes")
        if len(times) != count or min(times) <= 0.0:
            raise RuntimeError(f"{count} runs were asked for, {len(times)} came, the least time is {min(times)} s")

    return run


def mujoco_rollouts() -> Callable[[int], None]:
    """MuJoCo's rollout of the gear without stop, over the 0.13 s of scene S1, in one thread."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "peers"))
    import mujoco
    from mujoco import rollout
    from mujoco_peer import definition
    from scenes import landing_gear

    scene = landing_gear()
    h = scene.span / STEPS
    text = definition(scene, "RK4", h, (2.0 * h, 1.0))
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    first = np.zeros(size)
    mujoco.mj_getState(model, data, first, mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def run(count: int) -> None:
        # The actuator's force relative to 30 kN, less than in the other ways: without a stop a gear that is up early
        # would continue to its toggle, where MuJoCo's motion diverges. Gravity is part of the model and is not varied.
        controls = np.zeros((count, STEPS, model.nu))
        controls[:, :, 0] = np.random.default_rng(SEED).uniform(*SLOWER, size=count)[:, None]
        states, _ = rollout.rollout(model, data, np.tile(first, (count, 1)), controls)
        turned = states[:, -1, 1]
        if not ((turned > TURNED[0]) & (turned < TURNED[1])).all():
            raise RuntimeError(f"MuJoCo's crank turns by {turned.min()} to {turned.max()} rad, not by {TURNED}")

    return run


def ways(arguments: argparse.Namespace) -> Iterator[Way]:
    """All ways."""
    scale, fmu = arguments.scale, str(arguments.fmu)

    def of(count: int) -> int:
        return max(int(count * scale), 12)

    by_energy = Native(arguments, "--threads", "1", factors=FORCE_AND_LOAD)
    yield Way("`cargo fmu sweep`, one thread, without steps", by_energy, of(1000), of(1_000_000), 3)
    both = Native(arguments, "--threads", "1", factors=FORCE_AND_LOAD, responses=BOTH_STOPS)
    yield Way("`cargo fmu sweep`, one thread, without steps, two times", both, of(1000), of(1_000_000), 3)
    at_stop = Native(arguments, "--threads", "1", factors=FORCE_AND_LOAD, responses=AT_STOP)
    yield Way("`cargo fmu sweep`, one thread, without steps, with the impulse", at_stop, of(1000), of(1_000_000), 3)
    by_steps = Native(arguments, "--threads", "1")
    yield Way("`cargo fmu sweep`, one thread, by steps", by_steps, of(1000), of(1_000_000), 3)
    cluster = Native(arguments, "--workers", "2")
    yield Way("`cargo fmu sweep --workers 2`: Dask and the FMU", cluster, of(1000), of(1_000_000), 3)
    yield Way("`fmpy.simulate_fmu` in a loop", in_a_loop(fmu), 2, of(40))
    yield Way("`fmpy.simulate_fmu`, instance kept", in_an_efficient_loop(fmu), of(20), of(2000))
    yield Way("FMPy and a bag of Dask", in_a_bag(fmu), of(100), of(200_000))
    yield Way(f"MuJoCo, `rollout`, {STEPS} steps of RK4", mujoco_rollouts(), of(20), of(2000))


GEOMETRIES = {
    "another length of the crank": {"crank.length": {"uniform": [0.170, 0.180]}},
    "another attachment of the actuator": {
        "crank.actuator_x": {"uniform": [-0.065, -0.035]},
        "crank.actuator_y": {"uniform": [-0.153, -0.123]},
    },
    "another pin radius and coefficient of friction": {
        "friction.enabled": {"values": [True]},
        "joint1.pin_radius": {"normal": {"mean": 0.0175, "standard_deviation": 0.0002}},
        "friction.static_coefficient": {"uniform": [0.17, 0.21]},
    },
}
"""Factors that change the curve or its tables."""


def figures(arguments: argparse.Namespace) -> Iterator[tuple[str, str, str]]:
    """What is asked of a study, the limit, and the cost measured here."""
    scale = arguments.scale

    def of(count: int) -> int:
        return max(int(count * scale), 12)

    alone, both = (Native(arguments, "--threads", threads) for threads in ("1", "2"))
    pair = [Way(f"{threads} threads", run, of(1000), of(500_000)) for threads, run in ((1, alone), (2, both))]
    several = [[cost(way) for way in pair] for _ in range(5)]
    # Each pair is measured within the same minute.
    ratios = sorted(one[1] / two[1] for one, two in several)
    dearer = min(two[0] for _, two in several) / min(one[0] for one, _ in several)
    spread = f"{ratios[2]:.3g} times ({ratios[0]:.3g} to {ratios[-1]:.3g})"
    yield "two threads against one, elapsed time", "1.9 times", spread
    yield "CPU time of a run with two threads against one", "", f"{dearer:.3g} times"
    for name, factors in GEOMETRIES.items():
        used, _ = cost(Way(name, Native(arguments, "--threads", "1", factors=factors), of(20), of(2000), 3))
        yield f"a run with {name}", "1 ms", shown(used)
    for count in (of(100_000), of(1_000_000), of(10_000_000)):
        both(count)
        yield f"largest memory with two threads, {count:.0e} rows", "constant", f"{both.memory / 1000:.1f} MB"


def shown(seconds: float) -> str:
    """A time in a suitable unit."""
    return f"{seconds * 1e3:.3g} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.3g} us"


def lasting(seconds: float) -> str:
    """A duration in seconds or hours."""
    return f"{seconds:.3g} s" if seconds < 3600.0 else f"{seconds / 3600.0:.3g} h"


def processor() -> str:
    """Name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    return next((line.partition(": ")[2] for line in lines if line.startswith("model name")), platform.machine())


def page(rows: list[tuple[Way, float, float]], further: list[tuple[str, str, str]], scale: float) -> str:
    """The page."""
    versions = ", ".join(f"{name} {version(name)}" for name in ("FMPy", "dask", "distributed", "mujoco", "numpy"))
    native = rows[0][1]
    table = "\n".join(
        f"| {way.name} | {way.many} | {shown(used)} | {used / native:.3g} | {lasting(1e6 * used)} |"
        for way, used, _ in rows
    )
    more = "\n".join(f"| {what} | {asked} | {measured} |" for what, asked, measured in further)
    reduced = "" if scale == 1.0 else f"Measured with {scale:g} of the usual numbers of runs.\n\n"
    return f"""# Many runs by several ways

`cargo fmu bench studies` writes this file.

Machine: {processor()}, {os.cpu_count()} cores, {platform.system()}. {versions}, Python {platform.python_version()}.

{reduced}A run computes only the time at which the landing gear reaches its up stop, for an actuator force and a load
factor. Runs by integration steps also have a factor with one value that does not change a load. With this factor,
the energy integral cannot be used.

The table states the CPU time of all processes. The time of few runs is subtracted from the time of the runs in the
table, so start, packing and set-up do not count. Slow ways are measured with fewer runs. The last column is computed
from the time of one run.

| way | runs measured | CPU time of a run | to the first | 1e6 runs, CPU time |
|---|---|---|---|---|
{table}

The CPU time of `sweep` is the smallest of three measurements. The other ways are measured once. The goals are 4 us for
`sweep`, and 15 us through Dask and the FMU.

MuJoCo has neither the stop nor the load factor here. Its runs last 0.13 s, with actuator forces of 27 to 30 kN. The
page [peers](peers.md) states the error of the crank angle for as many steps.

## Other goals

| quantity | goal | measured |
|---|---|---|
{more}
"""


def main() -> None:
    """Measure all ways, write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--mechanism", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--scale", type=float, default=1.0)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    dask.config.set({"multiprocessing.context": "spawn"})
    rows = []
    for way in ways(arguments):
        used, passed = cost(way)
        print(f"{way.name}: {shown(used)} of CPU time a run, {shown(passed)} in all", flush=True)
        rows.append((way, used, passed))
    further = []
    for what, asked, measured in figures(arguments):
        print(f"{what}: {measured}", flush=True)
        further.append((what, asked, measured))
    arguments.out.write_text(page(rows, further, arguments.scale), encoding="utf-8")


if __name__ == "__main__":
    main()
