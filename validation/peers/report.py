"""The measured points as Markdown: machine, tools, run times at equal errors."""

from __future__ import annotations

import importlib.metadata
import math
import os
import platform
import subprocess
import tomllib
from pathlib import Path

from curves import DECADES, LEVELS, METHOD, TOOL, Curve, curves, own
from measure import Point

HERE = Path(__file__).resolve().parent
PACKAGES = ("scipy", "numba", "numpy", "heyoka", "exudyn", "mujoco")
CRATES = ("linkage-fmu", "differential-equations", "diffsol")

LIMIT = """\
This section states the limit for any program, for one run from rest without friction, drag and switches. The time to an
angle is the integral of d(theta) / omega. The energy gives omega in closed form, without derivatives. The error is that
of the time to the angle at 0.13 s, times the speed there.

The quadrature uses Gauss's rule, and its nodes belong to the set-up. The work at the start counts as one evaluation.
The quadrature gives the time of an angle, which is easier than the angle at a time, and it gives no motion between
them. The toggle at -1.326 rad, beyond the end, limits the convergence of the rule. The second substitution also removes
this toggle, but somebody must know the mechanism to find the substitution.
"""

REACTION = """\
A joint force is read from a table that is computed at the first reading. The table is not part of the set-up or of the
run above. The models are new, and the shortest time of each part counts. The first part is the run. Then follow the
force in joint1 at the end of the run, and the forces in the other three joints. The last part is the reading of all
four forces at the end of a later run.
"""

NOTES = """\
- **linkage-fmu, tables** is the engine with its default settings: one step over the whole span, with stops and locks. A
  run is the return to the start, the step, and the reading of the angle. The set-up reads the file and computes the
  curve and the tables that the first step needs. A single run includes this set-up (see "Set-up").
- **exact evaluator** solves the loops in every evaluation instead of reading a table. **rigid_fem** is the second
  formulation. Its limit differs by the stretch of the rods.
- **differential-equations, diffsol, SciPy** get the equation of motion in the crank angle in closed form
  (`src/four_bar.rs`, `four_bar.py`): one sine and cosine, two square roots, no iteration. Somebody must derive this
  equation for each mechanism, and it gives no reactions. The better one of `atol = rtol` and `atol = rtol / 100`
  counts. The set-up of SciPy with numba is the compilation. The methods choose their first step themselves, diffsol
  with 1 ms as a hint. dop853 of differential-equations evaluates the stages of its interpolant in every step, even if
  nothing uses it.
- **by hand** is the classical Runge-Kutta method with equal steps on the same closed form, in ten lines of Rust
  (`src/rk4.rs`). It has no error estimate and no dense output, so somebody must know the necessary number of steps.
- **GSL, CVODE** are compiled C (`native/`, `cc -O3`) on the same closed form, with the tolerances of the crates. A run
  of GSL starts with 1 ms as a hint, a run of CVODE with its own choice. Solver and memory belong to the set-up and are
  used again. CVODE computes its Jacobian by differences.
- **heyoka** computes Taylor series of the equation of motion. Its set-up compiles the expression for each tolerance.
  The call from Python is part of a run. The runs of a batch use one vector of the processor, and the time is divided by
  their number. This time states how many runs are made, not how long one run takes.
- **EXUDYN** has rigid bodies in the plane and revolute joints. Its explicit integrators do not support joints, so a
  closed loop needs the implicit integrators of second order. Up to 2000 steps, four settings of Newton's iterations
  were tried, exact and modified, to 1e-6, 1e-9 and 1e-12. Above 2000 steps, only exact iterations to 1e-12 were tried.
- **MuJoCo** has a tree of hinges, and `connect` closes the loops. The time constant of `connect` was varied as a
  multiple of the step, with `solimp` at its limit 0.9999 and Newton's solver at 1e-15. The constraint is soft. Its
  violation determines the error of RK4, which therefore decreases only with h^2.
- EXUDYN and MuJoCo support any mechanism, also in space, and give the joint reactions in every step. They solve in each
  step the equations that linkage-fmu solves before the first step.
"""


def machine() -> str:
    """Processor, cores and operating system."""
    processor = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.is_file():
        names = [line.split(":")[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
        processor = names[0] if names else processor
    return f"{processor}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


def versions(libraries: list[str]) -> str:
    """Versions of all that was measured, including the C `libraries`, and of the compilers."""
    locked = tomllib.loads((HERE / "Cargo.lock").read_text(encoding="utf-8"))["package"]
    crates = [f"{package['name']} {package['version']}" for package in locked if package["name"] in CRATES]
    there = {distribution.name for distribution in importlib.metadata.distributions()}
    packages = [f"{name} {importlib.metadata.version(name)}" for name in PACKAGES if name in there]
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    return ", ".join([*crates, *libraries, *packages, f"Python {platform.python_version()}", f"rustc {rustc}"])


def duration(seconds: float) -> str:
    """A duration with three digits in a suitable unit."""
    unit, size = next((u for u in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)) if seconds >= u[1]), ("us", 1e-6))
    return f"{seconds / size:.3g} {unit}"


def level_name(error: float) -> str:
    """A power of ten in the form 1e-6."""
    return f"1e{round(math.log10(error))}"


def times(ratio: float) -> str:
    """A ratio with three digits and no exponent."""
    return f"{float(f'{ratio:.3g}'):.10g} x"


def row(cells: list[str]) -> str:
    """One line of a table."""
    return f"| {' | '.join(cells)} |"


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """A table."""
    return [row(head), row(["---"] * len(head)), *map(row, rows)]


def by_tool(found: list[Curve]) -> list[str]:
    """Run time of each tool's fastest method at each error, and its ratio to this project's run time."""
    mine = own(found)
    bold = [f"**{duration(p.run)}**" if (p := mine.best(e)) else "not reached" for e in LEVELS]
    rows = [[f"**{TOOL}, {METHOD}**", *bold]]
    for tool in dict.fromkeys(curve.tool for curve in found if curve.tool != TOOL):
        cells = [tool]
        for level in LEVELS:
            candidates = [p for c in found if c.tool == tool and (p := c.best(level))]
            best, ours = min(candidates, key=lambda p: p.run, default=None), mine.best(level)
            if best is None or ours is None:
                cells.append("not reached")
            else:
                cells.append(f"{duration(best.run)}, **{times(best.run / ours.run)}** ({best.method})")
        rows.append(cells)
    return table(["tool, its fastest method", *(f"error <= {level_name(e)} rad" for e in LEVELS)], rows)


def by_method(found: list[Curve]) -> list[str]:
    """Run time of each method at each decade of the error, with its least error and its set-up time."""
    rows = []
    for curve in found:
        cells = [duration(p.run) if (p := curve.best(e)) else "-" for e in DECADES]
        rows.append([curve.tool, curve.method, *cells, f"{curve.floor:.1e}", duration(curve.setup)])
    return table(["tool", "method", *map(level_name, DECADES), "least error [rad]", "set-up"], rows)


def counted(point: Point | None) -> str:
    """Evaluations of the closed form, and run time."""
    return f"{point.evaluations}, {duration(point.run)}" if point else "-"


def fewest(point: Point) -> int:
    """Evaluations of the closed form, as a sort key."""
    return point.evaluations or 0


def limit(gear: list[Curve], quadratures: list[Curve]) -> list[str]:
    """The energy quadrature compared with this project: evaluations and run time at each decade of the error."""
    rows = []
    for error in DECADES:
        ours = own(gear).best(error)
        others = [min((p for p in c.points if p.error <= error), key=fewest, default=None) for c in quadratures]
        ratios = [f"{ours.run / p.run:.2f}" if ours and p else "-" for p in others]
        cells = [f"{counted(p)}, {ratio}" for p, ratio in zip(others, ratios, strict=True)]
        rows.append([level_name(error), duration(ours.run) if ours else "-", *cells])
    heads = [f"{curve.method}: evaluations, time, {TOOL} / it" for curve in quadratures]
    return table(["error [rad]", f"{TOOL}, {METHOD}", *heads], rows)


def first_reaction(found: list[Curve]) -> list[str]:
    """Run time, and time of the first and of later readings of joint forces, at each tolerance."""
    settings = [point.setting for point in found[0].points]
    rows = [
        [setting, *(duration(curve.points[number].run) for curve in found), duration(found[0].points[number].setup)]
        for number, setting in enumerate(settings)
    ]
    return table(["run at", *(curve.method for curve in found), "set-up before"], rows)


def break_even(found: list[Curve]) -> list[str]:
    """Number of runs after which the set-up of the tables is recovered, against the fastest method of each tool."""
    mine, rows = own(found), []
    for level in LEVELS:
        ours = mine.best(level)
        for tool in dict.fromkeys(curve.tool for curve in found if curve.tool != TOOL):
            candidates = [p for c in found if c.tool == tool and (p := c.best(level))]
            best = min(candidates, key=lambda p: p.run, default=None)
            if best and ours and best.run > ours.run:
                runs = max(0, math.ceil((ours.setup - best.setup) / (best.run - ours.run)))
                setups = (duration(ours.setup), duration(best.setup))
                rows.append([level_name(level), f"{tool} {best.method}", *setups, str(runs)])
    return table(["error [rad]", "against", "set-up here", "set-up there", "runs until even"], rows)


def page(points: list[Point], libraries: list[str], left_out: list[str]) -> str:
    """The whole report. `libraries`: versions of the C libraries; `left_out`: a line for each tool that is not
    installed."""
    gear, squeezer = curves(points, "S1"), curves(points, "Andrews")
    return "\n".join(
        [
            "# Comparison with other tools",
            "",
            "`cargo fmu bench peers` writes this file, [peers.csv](peers.csv) with every setting, and",
            "[the figure](../figures/peers.png).",
            "",
            f"Machine: {machine()}. {versions(libraries)}.",
            "",
            "Scene S1: the landing gear, 30 kN, load factor 3, no friction, no drag, from rest, 0.13 s. The error is",
            "that of the crank angle at the end, compared with an energy quadrature with 34 digits. The time is the",
            "fastest of several runs in one thread, all in the same call. The set-up is the work that is done once",
            "before the first run. A run gives one value at the end and nothing in between, unless the name states",
            "otherwise. For tools with Python, runs above 1 ms are timed by the clock of the processor. The angle",
            "changes by 2.04 rad and ends at -1.24 rad. Errors relative to the final angle are a fifth smaller.",
            *(["", *left_out] if left_out else []),
            "",
            "![Work against error](../figures/peers.png)",
            "",
            "## Scene S1: time at equal error",
            "",
            *by_tool(gear),
            "",
            "### Every method",
            "",
            *by_method(gear),
            "",
            "## The limit: an energy quadrature",
            LIMIT,
            *limit(gear, curves(points, "S1 limit")),
            "",
            "## The first reaction",
            REACTION,
            *first_reaction(curves(points, "S1 first reaction")),
            "",
            "## Andrews' squeezer: seven bodies, three loops, angle of the crank at 0.03 s",
            "",
            *by_tool(squeezer),
            "",
            "### Every method",
            "",
            *by_method(squeezer),
            "",
            "## Set-up",
            "Scene S1. The table states after how many runs linkage-fmu with its set-up is faster than the fastest",
            "method of each tool with its set-up. 0 means from the first run on.",
            "",
            *break_even(gear),
            "",
            "## Settings of each tool",
            NOTES,
        ]
    )
