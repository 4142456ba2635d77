"""The figure: run time over error, both logarithmic; a colour per tool (Okabe and Ito, Tol), a marker per method."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from curves import METHOD, TOOL, Curve, curves
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter
from measure import Point

COLOURS = {
    "linkage-fmu": "#000000",
    "differential-equations": "#0072B2",
    "diffsol": "#56B4E9",
    "by hand": "#999999",
    "GSL": "#882255",
    "CVODE": "#999933",
    "energy quadrature": "#D55E00",
    "SciPy": "#D55E00",
    "EXUDYN": "#009E73",
    "MuJoCo": "#CC79A7",
    "heyoka": "#332288",
}
COMPILED = ("numba", "#E69F00")
"""Methods whose names contain this word have their own colour."""
MARKERS = "osD^vP*Xh<>"
STYLES = ("-", "--", ":", "-.")
SPACING = {"handlelength": 3.0, "columnspacing": 1.2, "handletextpad": 0.6}
"""Font size of the legends."""
LEAST = 1e-15
"""Errors below this are drawn at it, as they are rounding errors [rad]."""


def draw(axes: Axes, title: str, found: list[Curve], setup: bool = False) -> None:
    """One panel with the frontier of each curve; `setup` adds the set-up time before the first run."""
    counts: dict[str, int] = {}
    for curve in found:
        number = counts[curve.tool] = counts.get(curve.tool, -1) + 1
        colour = COMPILED[1] if COMPILED[0] in curve.method else COLOURS[curve.tool]
        points, once = curve.frontier(), curve.setup if setup else 0.0
        main = (curve.tool, curve.method) == (TOOL, METHOD)
        axes.plot(
            [max(point.error, LEAST) for point in points],
            [point.run + once for point in points],
            color=colour,
            linestyle=STYLES[number % len(STYLES)],
            linewidth=2.4 if main else 1.1,
            marker=MARKERS[number % len(MARKERS)],
            markersize=4.5 if main else 3.5,
            markerfacecolor=colour if number % 2 == 0 else "white",
            label=f"{curve.tool}: {curve.method}",
            zorder=5 if main else 3,
        )
    axes.set(xscale="log", yscale="log", xlim=(LEAST / 2, 1e-1), xlabel="error [rad]", ylabel="time [s]")
    axes.set_title(title, fontsize=10, loc="left", fontweight="bold")
    axes.xaxis.set_major_locator(LogLocator(numticks=16))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=8)
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.legend(loc="upper center", bbox_to_anchor=(0.47, -0.12), ncol=2, fontsize=7.5, frameon=False, **SPACING)


def save(points: list[Point], folder: Path) -> None:
    """Draw all panels into a PNG and an SVG file."""
    mpl.use("Agg")
    mpl.rcParams.update({"font.size": 9, "svg.hashsalt": "peers", "svg.fonttype": "path", "axes.axisbelow": True})
    gear, squeezer = curves(points, "S1"), curves(points, "Andrews")
    rust = {"linkage-fmu", "differential-equations", "diffsol"}
    plain = {"by hand", "GSL", "CVODE"}
    python = {"SciPy", "heyoka", "EXUDYN", "MuJoCo"}
    main = [curve for curve in gear if (curve.tool, curve.method) == (TOOL, METHOD)]
    called = [curve for curve in gear if "Python" in curve.method]
    native = [curve for curve in gear if curve.tool in rust and curve not in called]
    others = [*main, *called, *(curve for curve in gear if curve.tool in python)]
    by_hand = [*main, *curves(points, "S1 limit"), *(curve for curve in gear if curve.tool in plain)]
    figure, panels = plt.subplots(3, 2, figsize=(12, 20.1))
    draw(panels[0, 0], "Landing gear: solvers in Rust", native)
    draw(panels[0, 1], "Landing gear: by hand, libraries in C, and the limit", by_hand)
    draw(panels[1, 0], "Landing gear: tools with Python", others)
    draw(panels[1, 1], "Landing gear: a single run, set-up included", [*main, *shortest(gear)], setup=True)
    draw(panels[2, 0], "Andrews' squeezer", squeezer)
    panels[2, 1].axis("off")
    figure.subplots_adjust(left=0.07, right=0.98, top=0.98, bottom=0.07, wspace=0.2, hspace=0.53)
    for suffix, metadata in ((".png", {}), (".svg", {"Date": None})):
        figure.savefig(folder / f"peers{suffix}", dpi=100, metadata=metadata)
    plt.close(figure)


def shortest(found: list[Curve]) -> list[Curve]:
    """For each other tool the method with the least time for 1e-6 rad, set-up included."""
    best: dict[str, tuple[float, Curve]] = {}
    for curve in found:
        point = curve.best(1e-6)
        if curve.tool == TOOL or point is None:
            continue
        total = point.run + point.setup
        if curve.tool not in best or total < best[curve.tool][0]:
            best[curve.tool] = (total, curve)
    return [curve for _, curve in best.values()]
