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
What any program could do for one run from rest without friction, drag and switches: the time to an angle is the
integral of d(theta) / omega, and omega follows from the energy, in closed form, without derivatives. The error is that
of the time to the angle at 0.13 s, times the speed there. Gauss's rule; its nodes are set-up; the work at the start
counts as one evaluation. It answers the easier question: when an angle is reached, not which angle at a time; and one
run leaves no motion to read. The toggle at -1.326 rad, behind the end, limits the rule's convergence: the second
substitution removes it too, for which somebody must know this mechanism.
"""

REACTION = """\
A joint's force is read from a table that is built when one is first read; it is no part of the set-up or of the run
above. Models made anew, the least time of each: the run, the force in joint1 where the first run ends, those in the
three other joints there, and all four where a later run ends.
"""

NOTES = """\
- **linkage-fmu, tables** is the engine as it comes: one step over the whole span, stops and locks in place. A run is
  the return to the start, the step, and the reading of the angle. Its set-up is the reading of the file, the tracing of
  the curve and the tables that the first step needs; whoever runs once pays that (see "Set-up").
- **exact evaluator** solves the loops in every evaluation instead of reading a table. **rigid_fem** is the second
  formulation; its own limit differs by the stretch of the rods.
- **differential-equations, diffsol, SciPy** get the equation of motion in the crank angle written out by hand in closed
  form (`src/four_bar.rs`, `four_bar.py`): one sine and cosine, two square roots, no iteration. Somebody has to derive
  that for each mechanism, and it gives no reactions. Both `atol = rtol` and `atol = rtol / 100` were swept; the better
  one counts. SciPy's set-up with numba is the compilation. The methods choose their first step themselves, diffsol
  with 1 ms as a hint; dop853 of differential-equations evaluates the stages of its interpolant in
  every step, used or not.
- **by hand** is the classical Runge-Kutta method with equal steps on the same closed form, some ten lines of Rust
  (`src/rk4.rs`): no estimate, no dense output; the number of steps that suffices has to be known.
- **GSL, CVODE** are compiled C (`native/`, `cc -O3`) on the same closed form, with the tolerances of the crates. A run
  of GSL begins with 1 ms as a hint, one of CVODE with its own choice; solver and memory are made in the set-up and used
  again. CVODE takes its Jacobian by differences.
- **heyoka** makes Taylor series of the equation of motion, whose expression it compiles for each tolerance: its set-up.
  The call from Python is part of a run. The runs of a batch go side by side in one vector of the processor, and the
  time is divided by their number: how many runs get done, not how soon one is.
- **EXUDYN** has rigid bodies in the plane and revolute joints. Its explicit integrators take no joints, so a closed
  loop is left to the implicit ones, of second order. Up to 2000 steps four settings of Newton's iterations were swept,
  exact and modified, to 1e-6, 1e-9 and 1e-12; above only exact ones to 1e-12.
- **MuJoCo** has a tree of hinges; its loops are closed by `connect`, whose time constant was swept as a multiple of the
  step, with `solimp` at its limit 0.9999 and Newton's solver at 1e-15. The constraint is soft: its violation, not the
  integrator, sets the error of RK4, which therefore falls with h^2 only.
- EXUDYN and MuJoCo take any mechanism, in space too, and their joints' reactions come with every step; they solve in
  each step what this project works out before the first.
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
            "# Beside other tools",
            "",
            "`cargo fmu bench peers` writes this file, [peers.csv](peers.csv) with every setting, and",
            "[the figure](../figures/peers.png).",
            "",
            f"Machine: {machine()}. {versions(libraries)}.",
            "",
            "Scene S1: the landing gear, 30 kN, load factor 3, no friction, no drag, from rest, 0.13 s. Error: of the",
            "crank angle at the end, against a 34-digit energy quadrature. Time: the fastest of several runs in one",
            "thread, all in the same call; what comes once before the first run is the set-up. One value at the end,",
            "nothing in between, unless the name says so. Tools with Python: runs over 1 ms by the processor's clock.",
            "The angle turns by 2.04 rad and ends at -1.24 rad: errors relative to it are a fifth less.",
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
            "Scene S1. How many runs it takes until this project, set-up included, is ahead of the fastest method of",
            "each tool with its own set-up; 0 means at once.",
            "",
            *break_even(gear),
            "",
            "## What each one was given",
            NOTES,
        ]
    )
