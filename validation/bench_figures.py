"""The figures of the benchmarks, drawn from their CSV: `python -m bench_figures RESULTS FIGURES`."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter, NullLocator, ScalarFormatter
from report.drawing import write
from report.page import Figure

Row = dict[str, str]

BLACK, BLUE, ORANGE, GREEN, PURPLE = "#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7"
"""Okabe and Ito's colours, distinguishable with colour vision deficiency; the curves also differ by their markers."""
ROUNDING = 1e-15
"""Errors below this are drawn at it [rad]."""
SCENES = {
    "bare": "bare, no stops",
    "default": "default: rigid stops",
    "reactions": "four reactions read",
    "derivatives": "derivatives read",
    "bumper": "bumper met",
    "drag": "drag",
    "wind": "drag, relative wind",
    "friction": "friction",
    "all": "all of these",
}
"""Bars from the top down, with their labels."""


@dataclass(frozen=True)
class Curve:
    """Data of one mechanism in a panel."""

    scene: str
    label: str
    colour: str
    marker: str


MECHANISMS = [
    Curve("LandingGearRetraction", "landing gear (S1)", BLACK, "o"),
    Curve("AndrewsSqueezer", "Andrews' squeezer", BLUE, "s"),
    Curve("SlCrank", "slider-crank idaSlCrank", ORANGE, "^"),
    Curve("FourBarChain2", "chain of 2 four-bars", GREEN, "D"),
    Curve("FourBarChain40", "chain of 40 four-bars", PURPLE, "v"),
]


def read(folder: Path, name: str) -> list[Row]:
    """The rows of one benchmark."""
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def pick(rows: Iterable[Row], **wanted: str) -> list[Row]:
    """The rows that have these values in these columns."""
    return [row for row in rows if all(row[column] == value for column, value in wanted.items())]


def column(rows: Iterable[Row], name: str) -> list[float]:
    """The numbers of one column."""
    return [float(row[name]) for row in rows]


def decades(axes: Axes) -> None:
    """Labels every three decades of the error and every decade of the time."""
    axes.xaxis.set_major_locator(FixedLocator([1e-15, 1e-12, 1e-9, 1e-6, 1e-3]))
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    axes.xaxis.set_minor_locator(LogLocator(numticks=20))
    axes.xaxis.set_minor_formatter(NullFormatter())


def work_precision(rows: list[Row], canvas: Canvas) -> None:
    """Run time over error, for one doStep and for many."""
    panels = canvas.subplots(1, 2, sharey=True)
    for axes, one in zip(panels, (True, False), strict=True):
        for curve in MECHANISMS:
            mine = [row for row in pick(rows, scene=curve.scene) if (row["steps"] == "1") == one]
            fewest = min(column(mine, "steps"))
            mine = [row for row in mine if float(row["steps"]) == fewest]
            errors = [max(error, ROUNDING) for error in column(mine, "error_rad")]
            label = curve.label if one else f"{curve.label}: {fewest:.0f} steps"
            axes.plot(
                errors, column(mine, "time_us"), color=curve.colour, marker=curve.marker, ms=4, lw=1.3, label=label
            )
        axes.set(xscale="log", yscale="log", xlim=(ROUNDING / 2, 1e-1), ylim=(1, 2e3), xlabel="error at the end [rad]")
        axes.set_title("One doStep for the whole span" if one else "The span in many doSteps", loc="left", fontsize=10)
        decades(axes)
        axes.legend(loc="upper right", fontsize=7.5)
    panels[0].set_ylabel("time of the whole span [µs]")


def by_scene(rows: list[Row], canvas: Canvas) -> None:
    """Bars: the run time of a retraction for each scene."""
    axes = canvas.subplots()
    height = 0.38
    for shift, steps, colour, label in ((-0.5, "1", BLUE, "one doStep of 0.13 s"), (0.5, "130", ORANGE, "130 of 1 ms")):
        mine = [pick(rows, scene=scene, steps=steps, inputs="constant")[0] for scene in SCENES]
        times, ratios = column(mine, "time_us"), column(mine, "ratio")
        places = [place + shift * height for place in range(len(SCENES))]
        axes.barh(places, times, height, color=colour, label=label)
        for place, time, ratio in zip(places, times, ratios, strict=True):
            digits = 1 if ratio < 10 else 0
            axes.text(1.06 * time, place, f"{ratio:.{digits}f}×", va="center", fontsize=7.5)
    axes.set_yticks(range(len(SCENES)), list(SCENES.values()))
    axes.invert_yaxis()
    axes.set(
        xscale="log", xlim=(1, 1e4), xlabel="time of a retraction [µs]; beside each bar its ratio to the bare scene"
    )
    axes.grid(visible=False, axis="y")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.3))


def by_step(rows: list[Row], canvas: Canvas) -> None:
    """Run time of a doStep over its communication step."""
    panels = canvas.subplots(1, 2, sharey=True)
    default = pick(rows, scene="default")
    for tolerance, colour, marker in (("1e-6", BLUE, "s"), ("1e-9", BLACK, "o"), ("1e-12", ORANGE, "^")):
        mine = pick(default, tolerance=tolerance)
        look = {"color": colour, "marker": marker, "ms": 5, "label": f"tolerance {tolerance}"}
        panels[0].plot(column(mine, "step_us"), column(mine, "step_ns"), **look)
    mine = pick(default, tolerance="1e-9")
    for name, colour, marker, label in (
        ("each_reaction_ns", GREEN, "v", "and four reactions, four calls"),
        ("reactions_ns", PURPLE, "D", "and four reactions, one call"),
        ("motion_ns", BLUE, "s", "and angle, speed, acceleration, three calls"),
        ("step_ns", BLACK, "o", "doStep alone"),
    ):
        panels[1].plot(column(mine, "step_us"), column(mine, name), color=colour, marker=marker, ms=5, label=label)
    panels[0].set_title("doStep alone", loc="left", fontsize=10)
    panels[1].set_title("With reads, tolerance 1e-9", loc="left", fontsize=10)
    for axes in panels:
        axes.set(xscale="log", yscale="log", xlim=(7, 1.4e4), ylim=(80, 3000), xlabel="step size [µs]")
        axes.yaxis.set_major_locator(FixedLocator([100, 200, 500, 1000, 2000]))
        axes.yaxis.set_major_formatter(ScalarFormatter())
        axes.yaxis.set_minor_locator(NullLocator())
        axes.legend(loc="upper left", fontsize=7.5)
    panels[0].set_ylabel("time of one step [ns]")


def by_bodies(rows: list[Row], canvas: Canvas) -> None:
    """Set-up time and run time of a step over the number of bodies."""
    axes = canvas.subplots()
    bodies = column(rows, "bodies")
    axes.plot(bodies, [1e3 * time for time in column(rows, "setup_ms")], color=BLUE, marker="s", label="set-up, once")
    steps = [time / 1e3 for time in column(rows, "step_ns")]
    axes.plot(bodies, steps, color=BLACK, marker="o", label="one step of 10 ms, tolerance 1e-9")
    axes.set(xscale="log", yscale="log", xlim=(2.5, 100), ylim=(0.1, 1e5), xlabel="bodies", ylabel="time [µs]")
    axes.xaxis.set_major_locator(FixedLocator(bodies))
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    axes.legend(loc="center right", bbox_to_anchor=(1.0, 0.42))


SCHEMES = [
    Curve("Jacobi 0", "Jacobi, held", BLACK, "o"),
    Curve("Gauss-Seidel rates", "Gauss-Seidel, rates", PURPLE, "v"),
    Curve("interface Jacobian, quadratic F", "interface Jacobian, quadratic", GREEN, "D"),
    Curve("preview, one pass, held", "preview, one pass, held", BLUE, "s"),
    Curve("preview, two passes, with dW/ds", "preview, two passes", ORANGE, "^"),
]
"""Coupling schemes in the figure."""


def by_coupling(rows: list[Row], canvas: Canvas) -> None:
    """Error of the coupling against the communication step."""
    panels = canvas.subplots(1, 2, sharey=True)
    for axes, scene in zip(panels, ("H1", "H2"), strict=True):
        for curve in SCHEMES:
            mine = pick(rows, scene=scene, scheme=curve.scene)
            steps, errors = [1e3 * h for h in column(mine, "step")], column(mine, "angle")
            axes.plot(steps, errors, color=curve.colour, marker=curve.marker, ms=5, lw=1.3, label=curve.label)
        axes.set(xscale="log", yscale="log", xlim=(0.07, 30), ylim=(1e-15, 1e-1), xlabel="communication step [ms]")
        axes.set_title(f"Scene {scene}", loc="left", fontsize=10)
        axes.yaxis.set_major_locator(FixedLocator([1e-15, 1e-12, 1e-9, 1e-6, 1e-3]))
    panels[0].set_ylabel("largest error of the crank angle [rad]")
    panels[1].legend(loc="lower right", fontsize=7.5)


CAPTIONS = {
    "Work-precision": (
        "Time of the whole span against the error at its end, for tolerances from 1e-4 to 1e-13: left in one "
        "`fmi2DoStep`, right in many. The curves fall steeply because the order of the method follows the tol"
        "erance; many short steps cost calls, not accuracy."
    ),
    "Cost by scene": ("One step of 1 ms of the landing gear with what acts in it. What does not act costs nothing."),
    "Cost of one doStep": ("One `fmi2DoStep` against its size."),
    "Cost against bodies": (
        "One step against the number of bodies: a step evaluates polynomials along one curve, however many bodies move."
    ),
    "Coupling": (
        "Largest error of the crank angle against the communication step, gear and hydraulic actuator coupled"
        " by several schemes in two scenes."
    ),
}
"""Descriptions of the figures."""


def figures(results: Path) -> list[Figure]:
    """All figures, drawn from their tables."""
    precision = read(results, "retraction") + read(results, "benchmarks")
    return [
        Figure(
            "bench_work_precision",
            "Work-precision",
            CAPTIONS["Work-precision"],
            partial(work_precision, precision),
            (9.0, 4.2),
        ),
        Figure(
            "bench_scenes",
            "Cost by scene",
            CAPTIONS["Cost by scene"],
            partial(by_scene, read(results, "scenes")),
            (7.2, 4.6),
        ),
        Figure(
            "bench_steps",
            "Cost of one doStep",
            CAPTIONS["Cost of one doStep"],
            partial(by_step, read(results, "steps")),
            (9.0, 3.8),
        ),
        Figure(
            "bench_bodies",
            "Cost against bodies",
            CAPTIONS["Cost against bodies"],
            partial(by_bodies, read(results, "bodies")),
            (6.0, 3.8),
        ),
        Figure(
            "bench_cosim", "Coupling", CAPTIONS["Coupling"], partial(by_coupling, read(results, "cosim")), (9.0, 4.2)
        ),
    ]


def main() -> None:
    """Draw all figures."""
    parser = argparse.ArgumentParser(description="Figures of the benchmarks")
    parser.add_argument("results", type=Path)
    parser.add_argument("figures", type=Path)
    arguments = parser.parse_args()
    for figure in figures(arguments.results):
        write(figure, arguments.figures)
        print(f"written to {arguments.figures / figure.name}.png and .svg")


if __name__ == "__main__":
    main()
