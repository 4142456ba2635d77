"""Drive the packed landing gear with several importers, compare the trajectories, and record the calls of each; then
couple the gear with its hydraulic actuator in each.

usage: importers.py FMU --out importers.md [--work DIR]

If the environment variable FMI_SIM is the path of the program of the crate fmi-sim, fmi-sim is one of the importers.

Each run has its own process and is executed twice: with the FMU as packed, for the trajectory, and with `spy.c` in the
place of the FMU's library, for the calls; the two trajectories must be bit-identical.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import itertools
import json
import math
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import coupled
import fmi_sim
from calls import Trace, spied
from drivers import CASES, CHANGE, IMPORTERS, OF_FMI_3, OUTPUTS, STEP, STEPS, Rows, third

TOLERANCE = 1e-9
"""Default tolerance of the FMU's integration [1]."""
GLOBAL_OVER_LOCAL = 100.0
"""Largest accepted ratio of the error at the end of a run to the tolerance of one step."""
REFERENCE_ANGLE = -1.2377117266891367
"""Angle of the crank at 0.13 s with all defaults, by quadrature [rad]."""
S1_ERROR = 1e-11
"""Allowed error of the angle at 0.13 s with all defaults, with FMI 3.0 [rad]."""

NOT_RUN = """- **PyFMI**: the newest release on the Python package index is 2.5, a source archive. `pip download` and
  `pip install` fail in its setup.py with `No module named 'numpy'`. With numpy and without build isolation, the
  message is `Please upgrade to a newer Cython version`. The index contains no later release.
- **OMSimulator**: `pip install` of 3.0.0.post198 downloads the program from the server of OMSimulator during the build.
  The installation fails if the machine cannot reach this server. The example of the README was run manually, with the
  Python package v3.0.0-167 and the library v3.0.0-114, both built from source. The error of `crank.angle` at 0.13 s
  (-1.2377117266795328 rad) is 9.6e-12 rad, and 1.1e-6 rad without `relativeTolerance`. Model exchange by FMI 2.0 does
  not work in this version: its fmi4c counts the 12 attributes `derivative` as states, and requests 12 states. The FMU
  has two elements in `ModelStructure/Derivatives`."""


def worker(name: str, case: str, fmu: Path, out: Path) -> None:
    """Execute one run in this process."""
    importers = {**IMPORTERS, **OF_FMI_3}
    out.write_text(json.dumps(importers[name].run(fmu, CASES[case])), encoding="utf-8")


def run(name: str, case: str, fmu: Path, work: Path, trace: Path | None = None) -> Rows:
    """Execute one run in its own process."""
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


def difference(rows: Rows, reference: Rows) -> list[float]:
    """Largest difference of each output relative to its largest value."""
    columns = zip(zip(*rows, strict=True), zip(*reference, strict=True), strict=True)
    return [max(abs(a - b) for a, b in zip(x, y, strict=True)) / max(map(abs, y)) for x, y in columns]


def table(header: list[str], rows: list[list[str]]) -> list[str]:
    """A table in Markdown."""
    return [f"| {' | '.join(cells)} |" for cells in (header, ["---"] * len(header), *rows)]


def foreign(host: Path, work: Path) -> str:
    """Output of the coupling host of `cargo fmu bench cosim` for an FMU that another tool exports."""
    build = [sys.executable, "-m", "pythonfmu", "build", "-f", str(Path(__file__).with_name("oil_spring.py"))]
    subprocess.run([*build, "-d", str(work)], check=True, capture_output=True)
    # The exported library takes Python's functions from the process that loads it.
    names = sysconfig.get_config_vars("LIBDIR", "LDLIBRARY")
    environment = {**os.environ, "LD_PRELOAD": "/".join(names), "PYTHONPATH": sysconfig.get_path("purelib")}
    command = [str(host), "cosim", "foreign", str(work / "OilSpring.fmu")]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout.strip()


def fmi_sim_section(fmu: Path) -> tuple[list[str], bool]:
    """Results of fmi-sim beyond co-simulation with constant steps, if it is installed, and whether all are correct."""
    if not fmi_sim.program():
        return [], True
    lines, holds = fmi_sim.section(third(fmu), REFERENCE_ANGLE)
    head = [
        "## fmi-sim by FMI 3.0",
        f"fmi-sim {fmi_sim.version()} rejects the packed FMU of FMI 3.0: `{fmi_sim.refusal(third(fmu))}`.",
        "Its parser, the crate fmi-schema, does not know `unit`, `displayUnit` and `nominal` of Float64 variables,",
        "which are in the standard (FMI 3.0.2, 2.4.7). It also reads each vector as one value, which the FMU rejects.",
        "For this test, the description of a copy has neither these attributes nor vectors. The library is the same.",
        "fmi-sim accepts the FMU of FMI 2.0 without a change.",
        "",
    ]
    return [*head, *lines, ""], holds


def report(fmu: Path, host: Path | None, work: Path) -> tuple[str, bool]:
    """Execute all runs; returns the report and whether all importers agree."""
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
            shown = ["identical" if rows == reference else f"{max(off):.0e}"] if name != "fmpy" else ["reference"]
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
        ("rejected calls, all cases", lambda name: str(sum(len(traces[name, case].refused()) for case in CASES))),
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
        f"a part of its largest value. At most {bound:.0e} is allowed, 100 times the tolerance. The error is that",
        f"of the last angle, compared with a quadrature with 34 digits. With FMI 3.0, at most {S1_ERROR:.0e} rad.",
        "",
        *table(["case", "importer", "`crank.angle` at 0.13 s [rad]", "difference", "error [rad]"], comparison),
        "",
        "## Calls of each importer",
        "The library `spy.c` between importer and FMU records the calls. It changes no result.",
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
                "## FMU of another exporter in the host of linkage-fmu",
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
    """Execute the comparison, or one run of it."""
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
