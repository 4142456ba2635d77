"""Drive the packed landing gear with several importers; compare the trajectories and write down what each one calls;
then couple the gear with its hydraulic actuator in each.

usage: importers.py FMU --out importers.md [--work DIR]

With FMI_SIM in the environment, the path of the program of the crate fmi-sim, that is one of the importers.

Each run is a process of its own. It is done twice: with the FMU as packed, for the trajectory, and with `spy.c` before
the FMU's library, for the calls; the two trajectories must be the same bits.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import itertools
import json
import math
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import coupled
import fmi_sim

STEP = 1e-3
"""Communication step [s]."""
STEPS = 130
"""Steps of a run."""
CHANGE = 50
"""Step before which the input changes in the case `input`."""
TOLERANCE = 1e-9
"""Default tolerance of the FMU's integration [1]."""
GLOBAL_OVER_LOCAL = 100.0
"""Promised ratio of the error at the end of a run to the tolerance of one step."""
REFERENCE_ANGLE = -1.2377117266891367
"""Angle of the crank at 0.13 s with all defaults by quadrature [rad]."""

OUTPUTS = ("crank.angle", "crank.speed", "joint2.force", "actuator.length")
"""What is compared, after every step."""


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
    """libcosim by way of libcosimpy: fixed-step algorithm, an observer for the last values."""
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
    """ECOS by way of ecospy."""
    import ctypes

    # ecospy's library looks for oneTBB, which a wheel puts into the environment's own lib folder.
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
    """fmi-sim. By FMI 2.0 it takes the value before a jump at a communication point, so that its table jumps half a
    step before."""
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
    """A name, the package that brings it, and how it runs a case."""

    title: str
    package: str
    run: Callable[[Path, Case], Rows]

    def release(self) -> str:
        """Package and version."""
        version = fmi_sim.version() if self.package == "fmi-sim" else importlib.metadata.version(self.package)
        return f"{self.package} {version}"


IMPORTERS = {
    "fmpy": Importer("FMPy", "FMPy", fmpy),
    "libcosim": Importer("libcosim (libcosimpy)", "libcosimpy", libcosim),
    "ecos": Importer("ECOS (ecospy)", "ecospy", ecos),
}
OF_FMI_3 = {"fmpy3": Importer("FMPy, FMI 3.0", "FMPy", lambda fmu, case: fmpy(third(fmu), case))}
"""Those that run the FMU of FMI 3.0, without the spy, which knows the functions of FMI 2.0."""
if fmi_sim.program():
    IMPORTERS["fmi_sim"] = Importer("fmi-sim", "fmi-sim", rust)
    OF_FMI_3["fmi_sim3"] = Importer("fmi-sim, FMI 3.0", "fmi-sim", lambda fmu, case: rust(third(fmu), case))
S1_ERROR = 1e-11
"""Largest error of the angle at 0.13 s with all defaults [rad], by FMI 3.0."""


def third(fmu: Path) -> Path:
    """The FMU of FMI 3.0 beside that of FMI 2.0."""
    return fmu if fmu.name.endswith(".fmi3.fmu") else fmu.with_suffix(".fmi3.fmu")


NOT_RUN = """- **PyFMI**: the newest release on the Python package index is 2.5, a source archive; `pip download` and
  `pip install` end in its setup.py (`No module named 'numpy'`, and with numpy at hand and no build isolation `Please
  upgrade to a newer Cython version`). Later releases are not on it.
- **OMSimulator**, not by this command: `pip install` of 3.0.0.post198 fetches the program itself from the project's
  own server while it builds, and fails where that server is out of reach. The example of the README was run by hand
  with its Python package at v3.0.0-167 over its library at v3.0.0-114, both from its sources: `crank.angle` at 0.13 s
  is -1.2377117266795328 rad, 9.6e-12 rad off the quadrature, and without `relativeTolerance` 1.1e-6 rad off. Model
  exchange by FMI 2.0 does not work in that state of it: its fmi4c takes the 12 attributes `derivative` for the number
  of states, not the two elements of `ModelStructure/Derivatives`, and asks for 12."""


def worker(name: str, case: str, fmu: Path, out: Path) -> None:
    """One run in this process."""
    importers = {**IMPORTERS, **OF_FMI_3}
    out.write_text(json.dumps(importers[name].run(fmu, CASES[case])), encoding="utf-8")


def run(name: str, case: str, fmu: Path, work: Path, trace: Path | None = None) -> Rows:
    """One run in a process of its own."""
    out = work / f"{name}-{case}.json"
    out.unlink(missing_ok=True)
    environment = dict(os.environ)
    if trace:
        trace.unlink(missing_ok=True)
        environment["FMU_TRACE"] = str(trace)
    command = [sys.executable, __file__, str(fmu), "--worker", name, case, str(out)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300.0)
    if done.returncode != 0 or not out.is_file():
        raise SystemExit(f"error: {name}, case {case}: ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads(out.read_text(encoding="utf-8"))


def spied(fmu: Path, work: Path) -> Path:
    """The FMU with `spy.c` before its library."""
    spy = work / "spy.so"
    source = Path(__file__).with_name("spy.c")
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", str(spy), str(source), "-ldl"], check=True)
    path = work / "spied" / fmu.name
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(fmu) as original, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as copy:
        for entry in original.namelist():
            if entry.startswith("binaries/linux64/"):
                copy.writestr("binaries/linux64/original.so", original.read(entry))
                copy.write(spy, entry)
            else:
                copy.writestr(entry, original.read(entry))
    return path


class Trace:
    """The calls of one run, as `spy.c` wrote them."""

    def __init__(self, path: Path) -> None:
        self.lines = path.read_text(encoding="utf-8").splitlines()

    def names(self) -> list[str]:
        """The functions, in order."""
        return [line.split()[0] for line in self.lines]

    def first(self, name: str) -> str | None:
        """The first call of a function."""
        return next((line for line in self.lines if line.split()[0] == name), None)

    def argument(self, function: str, key: str) -> str:
        """An argument of the first call of a function."""
        found = re.search(rf"\b{key}=(\S*)", self.first(function) or "")
        return found.group(1) if found else "not called"

    def location(self) -> str:
        """Form of the resource location, the folder left out."""
        location = self.argument("fmi2Instantiate", "fmuResourceLocation")
        return re.sub(r"^(\w*:?/*).*/(resources/?)$", r"\1.../\2", location)

    def callbacks(self) -> str:
        """Members of the callbacks that are NULL."""
        members = ("logger", "allocateMemory", "freeMemory", "stepFinished", "componentEnvironment")
        null = [member for member in members if self.argument("fmi2Instantiate", member) == "NULL"]
        return ", ".join(null) or "none"

    def experiment(self) -> str:
        """What fmi2SetupExperiment says."""
        if self.first("fmi2SetupExperiment") is None:
            return "not called"
        get = lambda key: self.argument("fmi2SetupExperiment", key)  # noqa: E731
        tolerance = f"tolerance {get('tolerance')}" if get("toleranceDefined") != "0" else "no tolerance"
        stop = f"stop time {get('stopTime')} s" if get("stopTimeDefined") != "0" else "no stop time"
        return f"start time {get('startTime')} s, {tolerance}, {stop}"

    def moved(self, verb: str, first: str | None, last: str) -> str:
        """Number of values set or read between two functions."""
        names = self.names()
        begin = names.index(first) if first else 0
        calls = [line for line in self.lines[begin : names.index(last)] if line.startswith(f"fmi2{verb}")]
        calls = [line for line in calls if re.match(rf"fmi2{verb}(Real|Integer|Boolean|String) ", line)]
        if not calls:
            return "none"
        count = sum(int(re.search(r"n=(\d+)", line).group(1)) for line in calls)
        return f"{count} in {len(calls)} call{'s' if len(calls) > 1 else ''}"

    def step(self, number: int) -> str:
        """The functions from the end of one step to that of the next, with the number of values that each moves."""
        places = [i for i, name in enumerate(self.names()) if name == "fmi2DoStep"]
        shown = []
        for line in self.lines[places[number - 1] + 1 : places[number] + 1]:
            name, count = line.split()[0].removeprefix("fmi2"), re.search(r"\bn=(\d+)", line)
            shown.append(f"{name}({count.group(1)})" if count else name)
        groups = [(key, len(list(group))) for key, group in itertools.groupby(shown)]
        return ", ".join(f"{count} x {key}" if count > 1 else key for key, count in groups)

    def points(self) -> str:
        """How the communication points are formed, and the step sizes that occur."""
        calls = [line for line in self.lines if line.startswith("fmi2DoStep")]
        values = [tuple(map(float, re.findall(r"=(\S+)", line)[:2])) for line in calls]
        points, sizes = [point for point, _ in values], {size for _, size in values}
        products = [n * STEP for n in range(len(points))]
        sums = list(itertools.accumulate([0.0] + [STEP] * (len(points) - 1)))
        way = "n h" if points == products else "running sum" if points == sums else "neither n h nor a running sum"
        off = max(abs(point - product) for point, product in zip(points, products, strict=True))
        spread = (
            "h exact"
            if sizes == {STEP}
            else f"{len(sizes)} values of h within {max(abs(s - STEP) for s in sizes):.0e} s"
        )
        return f"{way}{f' (off n h by {off:.0e} s at most)' if off else ''}, {spread}"

    def ending(self) -> str:
        """What follows the last step, reading apart."""
        names = self.names()
        last = len(names) - 1 - names[::-1].index("fmi2DoStep")
        rest = [name.removeprefix("fmi2") for name in names[last + 1 :] if not name.startswith("fmi2Get")]
        return ", ".join(rest) or "nothing"

    def refused(self) -> list[str]:
        """Calls that were answered with anything but fmi2OK."""
        return [line for line in self.lines if re.search(r"-> (?!0$|instance$)", line)]


def difference(rows: Rows, reference: Rows) -> list[float]:
    """Largest difference of each output, as a part of its largest value."""
    columns = zip(zip(*rows, strict=True), zip(*reference, strict=True), strict=True)
    return [max(abs(a - b) for a, b in zip(x, y, strict=True)) / max(map(abs, y)) for x, y in columns]


def table(header: list[str], rows: list[list[str]]) -> list[str]:
    """A table in Markdown."""
    return [f"| {' | '.join(cells)} |" for cells in (header, ["---"] * len(header), *rows)]


def foreign(host: Path, work: Path) -> str:
    """The coupling host of `cargo fmu bench cosim` on an FMU that another tool exports: what it says."""
    build = [sys.executable, "-m", "pythonfmu", "build", "-f", str(Path(__file__).with_name("oil_spring.py"))]
    subprocess.run([*build, "-d", str(work)], check=True, capture_output=True)
    # The exported library takes Python's functions from the process that loads it.
    names = sysconfig.get_config_vars("LIBDIR", "LDLIBRARY")
    environment = {**os.environ, "LD_PRELOAD": "/".join(names), "PYTHONPATH": sysconfig.get_path("purelib")}
    command = [str(host), "cosim", "foreign", str(work / "OilSpring.fmu")]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout.strip()


def fmi_sim_section(fmu: Path) -> tuple[list[str], bool]:
    """What fmi-sim does beyond co-simulation in fixed steps, if it is there, and whether all holds."""
    if not fmi_sim.program():
        return [], True
    lines, holds = fmi_sim.section(third(fmu), REFERENCE_ANGLE)
    head = [
        "## fmi-sim by FMI 3.0",
        f"fmi-sim {fmi_sim.version()} refuses the FMU of FMI 3.0 as it is packed: `{fmi_sim.refusal(third(fmu))}`.",
        "Its parser, the crate fmi-schema, does not know `unit`, `displayUnit` and `nominal` of Float64 variables,",
        "which the standard has (FMI 3.0.2, 2.4.7), and it reads each vector as one value, which the FMU refuses. It",
        "gets a copy whose description leaves out these attributes and the vectors; the library is the same. The FMU",
        "of FMI 2.0 it takes as it is.",
        "",
    ]
    return [*head, *lines, ""], holds


def report(fmu: Path, host: Path | None, work: Path) -> tuple[str, bool]:
    """Run everything; the report, and whether all importers agree."""
    spy = spied(fmu, work)
    bound = GLOBAL_OVER_LOCAL * TOLERANCE
    good = True
    comparison, traces = [], {}
    for case, details in CASES.items():
        reference: Rows = []
        for name, importer in {**IMPORTERS, **OF_FMI_3}.items():
            trace = work / f"{name}-{case}.trace"
            rows = run(name, case, fmu, work)
            if name in IMPORTERS:
                assert run(name, case, spy, work, trace) == rows, f"{name}: the spy changes the run"
                traces[name, case] = Trace(trace)
            reference = reference or rows
            off = difference(rows, reference)
            missed = abs(rows[-1][0] - REFERENCE_ANGLE) if case == "defaults" else 0.0
            good &= name in IMPORTERS or missed <= S1_ERROR
            error = f"{missed:.1e}" if case == "defaults" else ""
            agrees = len(rows) == STEPS and all(map(math.isfinite, itertools.chain(*rows))) and max(off) <= bound
            good &= agrees
            shown = ["the same bits" if rows == reference else f"{max(off):.0e}"] if name != "fmpy" else ["reference"]
            comparison.append(
                [details.title if name == "fmpy" else "", importer.title, f"{rows[-1][0]:.15f}", *shown, error]
            )

    def ask(case: str, question: Callable[[Trace], str]) -> Callable[[str], str]:
        return lambda name: question(traces[name, case])

    enter, leave, step = "fmi2EnterInitializationMode", "fmi2ExitInitializationMode", "fmi2DoStep"
    questions: list[tuple[str, Callable[[str], str]]] = [
        ("fmuResourceLocation", ask("defaults", lambda t: f"`{t.location()}`")),
        ("loggingOn", ask("defaults", lambda t: t.argument("fmi2Instantiate", "loggingOn"))),
        ("callbacks that are NULL", ask("defaults", Trace.callbacks)),
        ("fmi2SetDebugLogging", ask("defaults", lambda t: t.first("fmi2SetDebugLogging") or "not called")),
        ("fmi2SetupExperiment", ask("defaults", Trace.experiment)),
        ("values set before initialization mode, defaults", ask("defaults", lambda t: t.moved("Set", None, enter))),
        ("the same, start values changed", ask("start", lambda t: t.moved("Set", None, enter))),
        (
            "start values set before fmi2SetupExperiment",
            ask("start", lambda t: t.moved("Set", None, "fmi2SetupExperiment")),
        ),
        ("values set in initialization mode, defaults", ask("defaults", lambda t: t.moved("Set", enter, leave))),
        ("the same, start values changed", ask("start", lambda t: t.moved("Set", enter, leave))),
        ("values read in initialization mode", ask("defaults", lambda t: t.moved("Get", enter, leave))),
        ("values read from there to the first step", ask("defaults", lambda t: t.moved("Get", leave, step))),
        ("from step to step, defaults", ask("defaults", lambda t: t.step(CHANGE))),
        ("from step to step, as the input changes", ask("input", lambda t: t.step(CHANGE))),
        ("communication points", ask("defaults", Trace.points)),
        (
            "noSetFMUStatePriorToCurrentPoint",
            ask("defaults", lambda t: t.argument(step, "noSetFMUStatePriorToCurrentPoint")),
        ),
        ("after the last step", ask("defaults", Trace.ending)),
        ("calls refused, all cases", lambda name: str(sum(len(traces[name, case].refused()) for case in CASES))),
    ]
    pair, holds = coupled.table(fmu.parent, work)
    good &= holds
    versions = ", ".join(importer.release() for importer in IMPORTERS.values())
    further, holds = fmi_sim_section(fmu)
    good &= holds
    lines = [
        "# Importers",
        "",
        f"`cargo fmu bench importers` writes this file: LandingGearRetraction.fmu, {STEPS} steps of {STEP * 1e3:g} ms,",
        f"with {versions}.",
        "",
        "## Trajectories",
        f"Largest difference from FMPy over all steps of {', '.join(f'`{name}`' for name in OUTPUTS)}, each as",
        f"a part of its largest value; at most {bound:.0e} is allowed, 100 times the tolerance. The error is that",
        f"of the last angle against a 34-digit quadrature, by FMI 3.0 at most {S1_ERROR:.0e} rad.",
        "",
        *table(["case", "importer", "`crank.angle` at 0.13 s [rad]", "difference", "error [rad]"], comparison),
        "",
        "## What each one calls",
        "Written down by a library between the importer and the FMU's, `spy.c`; it changes no bit.",
        "",
        *table(
            ["", *(importer.title for importer in IMPORTERS.values())],
            [[q, *(a(name) for name in IMPORTERS)] for q, a in questions],
        ),
        "",
        *further,
        *coupled.HEAD,
        "",
        *pair,
        *coupled.TAIL,
        "",
        *(
            [
                "## Another exporter's FMU in this project's host",
                "The host of `cargo fmu bench cosim` couples a mass with an oil spring, `oil_spring.py`, exported by",
                f"pythonfmu {importlib.metadata.version('pythonfmu')}: {foreign(host, work)}.",
                "",
            ]
            if host
            else []
        ),
        "## Not run by this command",
        NOT_RUN,
        "",
    ]
    return "\n".join(lines), good


def main() -> None:
    """Run the comparison, or one run of it."""
    parser = argparse.ArgumentParser(description="Compare importers on the landing gear.")
    parser.add_argument("fmu", type=Path, help="LandingGearRetraction.fmu, the others beside it")
    parser.add_argument("--host", type=Path, help="program of the package validation, whose coupling host is tried")
    parser.add_argument("--out", type=Path, default=Path("importers.md"), help="the report")
    parser.add_argument("--work", type=Path, default=Path("importers"), help="folder for traces and results")
    parser.add_argument("--worker", nargs=3, metavar=("IMPORTER", "CASE", "OUT"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        name, case, out = arguments.worker
        worker(name, case, arguments.fmu, Path(out))
        return
    arguments.work.mkdir(parents=True, exist_ok=True)
    text, good = report(arguments.fmu.resolve(), arguments.host, arguments.work.resolve())
    arguments.out.write_text(text, encoding="utf-8")
    print(text)
    if not good:
        raise SystemExit("error: the importers do not agree")


if __name__ == "__main__":
    main()
