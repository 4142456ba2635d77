"""Couple the packed landing gear and its hydraulic actuator in several importers, with preview and, for comparison,
without; errors of the crank angle against an independent integration of both as one system.

usage: coupled.py FMUS --worker HOST STEP OUT      one run; FMUS is the folder of the packed FMUs and of the SSP package
"""

from __future__ import annotations

import argparse
import ctypes
import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

GEAR, HYDRAULICS, SSP = "LandingGearRetraction.fmu", "HydraulicActuator.fmu", "LandingGearRetractionWithHydraulics.ssp"
STEPS = (1, 5, 10, 20)
"""Communication steps [ms]."""
END = 4000
"""End of a run [ms]: the gear is up after 4066 ms."""
REFERENCE = {
    100: 0.769550975553854,
    200: 0.703967315179619,
    500: 0.523620580328936,
    1000: 0.253250298772210,
    2000: -0.242429680769236,
    3000: -0.759970553164200,
    3500: -1.05718309261089,
    3800: -1.22821155571711,
    4000: -1.28835660508442,
}
"""Angle of the crank [rad] by time [ms]: Taylor-series integration of gear and hydraulics as one system."""
ALLOWED = {1: 1e-5, 5: 5e-4, 10: 1e-2, 20: 1e-2}
"""Allowed error of the angle with preview [rad], by communication step [ms]."""
LATE = (1, 5)
"""Steps [ms] up to which hosts that pass every output one step late must keep this error in the mode preview."""

ANGLE, FORCE = "crank.angle", "actuator.force"
MOTION = ("actuator.length", "actuator.speed", "actuator.acceleration")
ELEMENT = tuple(
    f"actuator.{term}"
    for term in ("reduced_mass", "reduced_mass_derivative", "holding_force", "holding_force_derivative")
)
MEAN, MODE = "preview.force_mean", "coupling.mode"
DELAYED_NUMBER = 3
"""Number of the item `delayed` of `coupling.mode`."""
PLAIN, PREVIEW, DELAYED = "plain", "preview", "delayed"
"""What is exchanged: force and motion alone; the preview too; the preview in the mode for hosts one step late."""

DELAYED_FMU = "DELAYED_FMU"
"""Environment variable: path of the hydraulics packed with the mode `delayed`, for hosts that cannot set Enumerations.
"""

Angles = list[float]


def parameters(step: float) -> dict[str, float]:
    """Start values of the hydraulics: the valve opens to 0.65 within 0.1 s."""
    return {"command.ramp_amplitude": 0.65, "command.ramp_time": 0.1, "preview.horizon": step}


def hydraulics(fmus: Path, scheme: str) -> str:
    """The hydraulics for a host that cannot set an Enumeration of FMI 2.0."""
    return os.environ[DELAYED_FMU] if scheme == DELAYED else str(fmus / HYDRAULICS)


def shared(scheme: str) -> tuple[tuple[str, ...], str]:
    """Outputs of the gear that the hydraulics take as inputs, and the output of the hydraulics that is the gear's
    force."""
    return (MOTION, FORCE) if scheme == PLAIN else ((*MOTION, *ELEMENT), MEAN)


def fmpy(fmus: Path, step: float, scheme: str) -> Angles:
    """A loop over FMPy's slaves. Each step reads the gear's outputs before it sets the inputs of the hydraulics; with
    `delayed`, all inputs have the values of the step before."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    def load(name: str) -> tuple[FMU2Slave, dict[str, int]]:
        folder = extract(str(fmus / name))
        described = read_model_description(folder)
        identifier = described.coSimulation.modelIdentifier
        slave = FMU2Slave(
            guid=described.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName=identifier
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        return slave, {variable.name: variable.valueReference for variable in described.modelVariables}

    (gear, of_gear), (oil, of_oil) = load(GEAR), load(HYDRAULICS)
    names, source = shared(scheme)

    def exchange() -> None:
        oil.setReal([of_oil[name] for name in names], gear.getReal([of_gear[name] for name in names]))

    gear.setBoolean([of_gear["downstop.enabled"]], [False])
    oil.setReal([of_oil[name] for name in parameters(step)], list(parameters(step).values()))
    if scheme == DELAYED:
        oil.setInteger([of_oil[MODE]], [DELAYED_NUMBER])
    exchange()
    gear.exitInitializationMode()
    oil.exitInitializationMode()
    angles = []
    for i in range(round(END * 1e-3 / step)):
        if scheme == DELAYED:
            gear.setReal([of_gear[FORCE]], oil.getReal([of_oil[source]]))
            exchange()
        else:
            exchange()
            gear.setReal([of_gear[FORCE]], oil.getReal([of_oil[source]]))
        gear.doStep(i * step, step)
        oil.doStep(i * step, step)
        angles += gear.getReal([of_gear[ANGLE]])
    return angles


def cosim(fmus: Path, step: float, scheme: str, package: bool = False) -> Angles:
    """libcosim through libcosimpy with its fixed-step algorithm; connections by calls or from the SSP package."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    if package:
        execution = CosimExecution.from_ssp_file(str(fmus / SSP), step_size=round(step * 1e9))
        gear = execution.slave_index_from_instance_name("gear")
    else:
        execution = CosimExecution.from_step_size(round(step * 1e9))
        gear = execution.add_local_slave(CosimLocalSlave(str(fmus / GEAR), "gear"))
        oil = execution.add_local_slave(CosimLocalSlave(hydraulics(fmus, scheme), "hydraulics"))
        of_oil = {variable.name.decode(): variable.reference for variable in execution.slave_variables(oil)}
    of_gear = {variable.name.decode(): variable.reference for variable in execution.slave_variables(gear)}
    if not package:
        assert execution.boolean_initial_value(gear, of_gear["downstop.enabled"], False)
        for name, value in parameters(step).items():
            assert execution.real_initial_value(oil, of_oil[name], value)
        names, source = shared(scheme)
        for name in names:
            assert execution.connect_real_variables(gear, of_gear[name], oil, of_oil[name]) == 0
        assert execution.connect_real_variables(oil, of_oil[source], gear, of_gear[FORCE]) == 0
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    angles = []
    for n in range(round(END * 1e-3 / step)):
        assert execution.step(), f"step {n}"
        angles += observer.last_real_values(gear, [of_gear[ANGLE]])
    return angles


def ecos(fmus: Path, step: float, scheme: str, package: bool = False) -> Angles:
    """ECOS through ecospy; connections by calls or from the SSP package."""
    # The library of ecospy needs oneTBB, which its wheel installs in the lib folder of the environment.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    def run(simulation: EcosSimulation, values: str) -> Angles:
        assert simulation.init(parameter_set=values)
        angles = []
        for _ in range(round(END * 1e-3 / step)):
            simulation.step(1)
            angles.append(simulation.get_real(f"gear::{ANGLE}"))
        simulation.terminate()
        return angles

    if package:
        with EcosSimulation(ssp_path=str(fmus / SSP), step_size=step) as simulation:
            return run(simulation, "initialValues")
    with EcosSimulationStructure() as structure:
        structure.add_model("gear", str(fmus / GEAR))
        structure.add_model("hydraulics", hydraulics(fmus, scheme))
        names, source = shared(scheme)
        for name in names:
            structure.make_real_connection(f"gear::{name}", f"hydraulics::{name}")
        structure.make_real_connection(f"hydraulics::{source}", f"gear::{FORCE}")
        values: dict[str, float] = {f"hydraulics::{name}": value for name, value in parameters(step).items()}
        structure.add_parameter_set("H1", {"gear::downstop.enabled": False, **values})
        with EcosSimulation(structure=structure, step_size=step) as simulation:
            return run(simulation, "H1")


@dataclass(frozen=True)
class Host:
    """A host with one way to set up the connections."""

    title: str
    run: Callable[[Path, float], Angles]
    steps: tuple[int, ...] = STEPS
    promised: tuple[int, ...] = ()
    """Steps [ms] at which the error must be within the allowed one."""


HOSTS = {
    "fmpy": Host("FMPy, loop, gear's outputs first", lambda f, h: fmpy(f, h, PREVIEW), promised=STEPS),
    "fmpy-delayed": Host("FMPy, loop, one step late, `delayed`", lambda f, h: fmpy(f, h, DELAYED), promised=STEPS),
    "fmpy-plain": Host("FMPy, plain exchange of force and motion", lambda f, h: fmpy(f, h, PLAIN)),
    "cosim": Host("libcosim", lambda f, h: cosim(f, h, PREVIEW), promised=LATE),
    "cosim-delayed": Host("libcosim, `delayed`", lambda f, h: cosim(f, h, DELAYED), promised=STEPS),
    "cosim-plain": Host("libcosim, plain exchange", lambda f, h: cosim(f, h, PLAIN)),
    "cosim-ssp": Host("libcosim, from the SSP package", lambda f, h: cosim(f, h, PREVIEW, True), (1,), (1,)),
    "ecos": Host("ECOS", lambda f, h: ecos(f, h, PREVIEW), promised=LATE),
    "ecos-delayed": Host("ECOS, `delayed`", lambda f, h: ecos(f, h, DELAYED), promised=STEPS),
    "ecos-plain": Host("ECOS, plain exchange", lambda f, h: ecos(f, h, PLAIN)),
    "ecos-ssp": Host("ECOS, from the SSP package", lambda f, h: ecos(f, h, PREVIEW, True), (1,), (1,)),
}


def error(host: str, fmus: Path, step: int, work: Path) -> float:
    """Largest error of the angle [rad] over the reference's points, from a run in its own process; infinite if the host
    fails."""
    out = work / f"coupled-{host}-{step}.json"
    out.unlink(missing_ok=True)
    command = [sys.executable, __file__, str(fmus), "--worker", host, str(step), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0)
    if not out.is_file():
        (work / f"coupled-{host}-{step}.txt").write_text(done.stdout + done.stderr, encoding="utf-8")
        return math.inf
    angles = json.loads(out.read_text(encoding="utf-8"))
    return max(abs(angles[time // step - 1] - angle) for time, angle in REFERENCE.items())


HEAD = """## Gear and hydraulic actuator, coupled
LandingGearRetraction.fmu and HydraulicActuator.fmu run at their default tolerances. The parameters `command.*` state
the valve command. The table states the largest error of `crank.angle` [rad] over 4 s, compared with an independent
integration of both as one system.

- Preview (default): the actuator gets the motion, reduced mass and load of the gear. The gear gets
  `preview.force_mean`.
- Plain exchange: the models exchange only `actuator.force` and the motion.
- `delayed`: `coupling.mode` is `delayed` instead of `preview`. libcosim and ECOS do not support Enumerations of
  FMI 2.0, so their actuator is packed with `"coupling": { "mode": "delayed" }`.
- Lost: the error is above 0.1 rad, or a step returns an error.
""".splitlines()
TAIL = """
In each step, the loop in Python reads the outputs of the gear before those of the actuator. libcosim and ECOS read all
outputs after a step, and pass them to the inputs before the next step. The force is then predicted from the element of
the step before, one step late. In the mode `preview`, this has no effect at 1 ms, and the coupling is lost above 8 ms.
The mode `delayed` is for these hosts. It is as accurate as `preview` in a host that first reads the outputs of
the gear.
""".splitlines()
"""Text before and after the table in the report."""


def table(fmus: Path, work: Path) -> tuple[list[str], bool]:
    """A Markdown table of the largest errors, and whether every error with preview is within the allowed one."""
    head = ["host", *(f"{step} ms" for step in STEPS)]
    lines, good = [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head))], True
    for name, host in HOSTS.items():
        cells = [host.title]
        for step in STEPS:
            if step not in host.steps:
                cells.append("")
                continue
            found = error(name, fmus, step, work)
            good &= step not in host.promised or found <= ALLOWED[step]
            cells.append(f"{found:.1e}" if found < 0.1 else "lost")
        lines.append(f"| {' | '.join(cells)} |")
    return lines, good


def main() -> None:
    """Execute one run, or write the table."""
    parser = argparse.ArgumentParser(description="Couple landing gear and hydraulic actuator with importers.")
    parser.add_argument("fmus", type=Path, metavar="FMUS", help="folder of the packed FMUs")
    parser.add_argument("--work", type=Path, default=Path("importers"), help="folder for results")
    parser.add_argument("--worker", nargs=3, metavar=("HOST", "STEP", "OUT"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        host, step, out = arguments.worker
        angles = HOSTS[host].run(arguments.fmus, int(step) * 1e-3)
        Path(out).write_text(json.dumps(angles), encoding="utf-8")
        return
    arguments.work.mkdir(parents=True, exist_ok=True)
    lines, good = table(arguments.fmus.resolve(), arguments.work.resolve())
    print("\n".join(lines))
    if not good:
        raise SystemExit("error: a preview errs by more than is allowed")


if __name__ == "__main__":
    main()
