"""Times of runs and steps of the landing gear from Python: the module, FMPy with the FMU, MuJoCo and EXUDYN.

usage: module.py --fmu FMU --out PAGE

Each time is the least of many in this process, as other load on the machine only lengthens a call.
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

import exudyn
import fmpy
import mujoco
import numpy as np
from exudyn import itemInterface as items
from fmpy.fmi2 import FMU2Slave
from mujoco import rollout

sys.path.insert(0, str(Path(__file__).parents[1] / "peers"))
import exudyn_peer
from mujoco_peer import definition
from scenes import landing_gear

STOP, INTERVAL = 0.13, 1e-3
OUTPUTS = [
    *("crank.angle", "crank.speed", "crank.acceleration", "coupler.angle"),
    *("follower.angle", "actuator.length", "joint1.force", "joint4.force"),
]
INPUTS = ["actuator.force", "load_factor", "airspeed", "wheel.force_x"]
VALUES = [30000.0, 3.0, 0.0, 0.0]
ROWS_OF_RUN = round(STOP / INTERVAL)
SCENE = landing_gear()
"""The gear without its stop, which it does not reach in a run."""


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

    run()
    return {
        "error": abs(simulation["crank.angle"] - SCENE.exact),
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


def by_mujoco() -> dict[str, float]:
    """Steps of 1 ms with RK4; a run with rollout, which loops in C. Of the outputs, six are the state and two those of
    a tendon."""
    text = definition(SCENE, "RK4", INTERVAL, (2.0 * INTERVAL, 1.0))
    sensors = '<sensor><tendonpos tendon="t0"/><tendonvel tendon="t0"/></sensor></mujoco>'
    model = mujoco.MjModel.from_xml_string(text.replace("</mujoco>", sensors))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    whole = mujoco.mjtState.mjSTATE_FULLPHYSICS
    first = np.zeros(mujoco.mj_stateSize(model, whole))
    mujoco.mj_getState(model, data, first, whole)
    controls = np.ones((1, ROWS_OF_RUN, model.nu))
    states = np.empty((1, ROWS_OF_RUN, first.size))
    values = np.empty((1, ROWS_OF_RUN, model.nsensordata))
    forces = np.zeros(2)

    def simulate() -> None:
        rollout.rollout(model, data, first[None], controls, state=states, sensordata=values)

    def step() -> tuple[float, ...]:
        data.ctrl[:] = 1.0
        data.xfrc_applied[1, :2] = forces
        mujoco.mj_step(model, data)
        return data.qpos[0], data.qvel[0], data.qacc[0], data.ten_length[0]

    def run() -> None:
        mujoco.mj_resetData(model, data)
        data.ctrl[:] = 1.0
        mujoco.mj_step(model, data, nstep=ROWS_OF_RUN)

    simulate()
    error = abs(SCENE.start + states[0, -1, 1] - SCENE.exact)
    times = {"simulate": least(simulate), "run": least(run)}
    run()
    # In a step repeated for seconds the gear would pass its toggle: the state is reset every 100 steps.
    made = 0

    def steps() -> None:
        nonlocal made
        if made % 100 == 0:
            mujoco.mj_resetData(model, data)
        made += 1
        step()

    return times | {"step": least(steps), "error": error}


def by_exudyn() -> dict[str, float]:
    """Steps of 1 ms with the trapezoidal rule of index 2; outputs by sensors that store their values."""
    exudyn.config.printToConsole = False
    peer = exudyn_peer.Model(SCENE)
    system, solver = peer.system, exudyn.DynamicSolverType.TrapezoidalIndex2
    kinds = exudyn.OutputVariableType
    of_nodes = [(kinds.Coordinates, node) for node in peer.nodes] + [(kinds.Coordinates_t, node) for node in peer.nodes]
    for kind, node in of_nodes:
        sensor = items.SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True, writeToFile=False)
        system.AddSensor(sensor)
    system.Assemble()
    whole = exudyn_peer.settings(STOP, ROWS_OF_RUN, None, 1e-9, True)
    whole.solution.sensors.writePeriod = INTERVAL
    bare = exudyn_peer.settings(STOP, ROWS_OF_RUN, None, 1e-9, True)
    bare.solution.sensors.writePeriod = 2.0 * STOP
    one = exudyn_peer.settings(INTERVAL, 1, None, 1e-9, True)
    node, strut = peer.nodes[0], system.systemData.NumberOfObjects() - 1
    weights = [(load, system.GetLoadParameter(load, "loadVector")) for load in range(3)]
    push = system.GetObjectParameter(strut, "force")

    def step() -> tuple[np.ndarray, np.ndarray]:
        for load, weight in weights:
            system.SetLoadParameter(load, "loadVector", weight)
        system.SetObjectParameter(strut, "force", push)
        system.SolveDynamic(one, solverType=solver, updateInitialValues=False, storeSolver=False)
        return system.GetNodeOutput(node, kinds.Coordinates), system.GetNodeOutput(node, kinds.Coordinates_t)

    error = abs(peer.run(whole, solver) - SCENE.exact)
    times = {
        "simulate": least(lambda: peer.run(whole, solver)),
        "run": least(lambda: peer.run(bare, solver)),
    }
    return times | {"step": least(step), "error": error}


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
    own = by_module()
    others = {"FMPy": by_fmpy(arguments.fmu), "MuJoCo": by_mujoco(), "EXUDYN": by_exudyn()}
    lines = [
        "# Runs and steps from Python\n",
        "`cargo fmu bench module` writes this file.\n",
        f"Machine: {platform.machine()}, {os.cpu_count()} cores, {platform.system()}. "
        f"Python {platform.python_version()}, "
        + ", ".join(f"{name} {version(name)}" for name in ("numpy", "FMPy", "mujoco", "exudyn"))
        + ".\n",
        "The landing gear runs in the module, in FMPy with the unpacked FMU and its description, and in MuJoCo and "
        "EXUDYN without its stop. Each time is the shortest of one process.\n",
        f"| what | by the module [us] | at most [us] | {' | '.join(f'by {name} [us]' for name in others)} |",
        "|---|---|---|---|---|---|",
    ]
    for key, what, limit in ROWS:
        cells = [f"{other[key]:.3g}" if key in other else "" for other in others.values()]
        lines.append(f"| {what} | {own[key]:.3g} | {limit:g} | {' | '.join(cells)} |")
    lines += [
        "",
        "A step of the module and of FMPy is 1e-9 s long, so the table states the time of the calls, not of the "
        "motion. The steps of MuJoCo and EXUDYN are 1 ms long, because their time does not depend on the length of "
        "a step. A step of EXUDYN is a call of its solver with one step.\n",
        f"Error of the crank angle after 0.13 s: module {own['error']:.1e} rad, MuJoCo (RK4) "
        f"{others['MuJoCo']['error']:.1e} rad, EXUDYN (trapezoidal rule, index 2) {others['EXUDYN']['error']:.1e} rad.",
    ]
    arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
