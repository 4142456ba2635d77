"""A plot of variables over time or over one of them: PNG, SVG or PDF, by Matplotlib.

usage: plot.py FORMAT < PLAN > PICTURE

The plan is JSON: a title, the quantity along the axis and the lines, each with name, quantity, unit and values. A line
without a unit is true or false.
"""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
"""Colours that people with colour-vision deficiency can distinguish (Okabe and Ito 2008)."""
LINES = len(COLOURS)
PANELS = 8
"""Largest number of lines in a panel and of panels that can be distinguished."""
WIDTH, HEIGHT, STRIP, ROW = 6.0, 1.6, 0.5, 0.2
"""Sizes of the picture, a panel, a Boolean in its panel and a row of a legend [in]."""
LETTERS = 72
"""Number of letters of a legend in one row."""
WORDS = 19
"""Number of letters along the height of a panel."""
PITCH = 2.2
"""Distance between the zero lines of two Booleans."""
PLAIN = (1e-2, 1e4)
"""Largest values that are written without a unit prefix."""
PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G", 12: "T"}
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STYLE = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.unicode_minus": True,
    "font.size": 9.5,
    "grid.color": "#dcdfe3",
    "grid.linewidth": 0.6,
    "legend.fontsize": 9,
    "legend.frameon": False,
    "lines.linewidth": 1.3,
    "pdf.fonttype": 42,
    "svg.hashsalt": "linkage-fmu",
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
}


@dataclass(frozen=True)
class Series:
    """Values of one variable. NaN stands for a missing value."""

    name: str
    quantity: str | None
    unit: str | None
    values: NDArray[np.float64]

    @classmethod
    def read(cls, plan: dict[str, Any]) -> Series:
        """Read a line of the plan."""
        return cls(plan["name"], plan["quantity"], plan["unit"], np.array(plan["values"], dtype=float))


def unit_with_prefix(unit: str, size: float) -> tuple[str, float]:
    """Unit with a prefix for which values of this size have few digits, and the factor from the unit without prefix."""
    shown = re.sub(r"(?<=[A-Za-z])\d", lambda digit: digit[0].translate(SUPERSCRIPTS), unit).replace(".", "·")
    if not math.isfinite(size) or size == 0.0 or PLAIN[0] <= size < PLAIN[1]:
        return shown, 1.0
    power = 3 * math.floor(math.log10(size) / 3.0)
    # A prefix of a unit with a power would have the power too.
    has_prefix = re.match(r"(N|Pa|J|W|Hz)(?![a-z0-9])", unit) or (unit == "m" and power < 0)
    if has_prefix and power in PREFIXES:
        return PREFIXES[power] + shown, 10.0**-power
    return f"10{str(power).translate(SUPERSCRIPTS)}{'' if unit == '1' else ' ' + shown}", 10.0**-power


def words(lines: list[Series]) -> str:
    """Text for the quantity of a panel: AngularVelocity becomes angular velocity."""
    if lines[0].quantity:
        return re.sub(r"(?<!^)(?=[A-Z])", " ", lines[0].quantity).capitalize()
    parts = [re.split("[ _]", line.name.rpartition(".")[2]) for line in lines]
    shared = takewhile(lambda same: len(set(same)) == 1, zip(*parts, strict=False))
    return " ".join(first for first, *_ in shared).rstrip(",").capitalize() or "Value"


def panels(lines: list[Series]) -> tuple[list[list[Series]], int]:
    """Lines grouped by quantity, Booleans last, and the number of lines without a panel."""
    groups: dict[tuple[str | None, str | None], list[Series]] = {}
    for line in lines:
        groups.setdefault((line.quantity, line.unit), []).append(line)
    booleans = groups.pop((None, None), [])
    numbers = list(groups.values())[: PANELS - bool(booleans)]
    shown = [group[:LINES] for group in [*numbers, booleans] if group]
    return shown, len(lines) - sum(map(len, shown))


def columns(lines: list[Series]) -> int:
    """Number of columns of a legend."""
    return max(1, min(len(lines), LETTERS // (max(len(line.name) for line in lines) + 7)))


def height(lines: list[Series]) -> float:
    """Height of a panel [in]."""
    if not lines[0].unit:
        return STRIP * len(lines) + 0.2
    return HEIGHT + ROW * -(-len(lines) // columns(lines))


def draw_numbers(axes: Axes, x: NDArray[np.float64], lines: list[Series]) -> None:
    """Curves of one quantity, with name and unit at the axis and the names of the variables above."""
    known = np.concatenate([line.values[np.isfinite(line.values)] for line in lines])
    size = float(np.abs(known).max(initial=0.0))
    unit, factor = unit_with_prefix(lines[0].unit or "", size)
    for line, colour in zip(lines, COLOURS, strict=False):
        # A line below another line is visible between the dashes.
        style = "-" if line is lines[0] else (0, (7, 1.5))
        marker = "o" if len(x) == 1 else None
        axes.plot(x, factor * line.values, color=colour, label=line.name, linestyle=style, marker=marker)
    if known.size and np.ptp(known) <= 1e-9 * size:
        # Values that differ only by rounding are drawn as a constant.
        middle = factor * float(known[0])
        axes.set_ylim(middle - 0.1 * abs(middle), middle + 0.1 * abs(middle))
    axes.ticklabel_format(axis="y", style="plain", useOffset=False)
    axes.locator_params(axis="y", nbins=6)
    name = words(lines)
    axes.set_ylabel(f"{name}{chr(10) if len(name) + len(unit) > WORDS else ' '}[{unit}]")
    place = {"loc": "lower left", "bbox_to_anchor": (-0.01, 1.0), "borderaxespad": 0.1}
    axes.legend(ncols=columns(lines), handlelength=1.6, labelspacing=0.25, **place)


def draw_booleans(axes: Axes, x: NDArray[np.float64], lines: list[Series]) -> None:
    """Each Boolean as steps in a strip, with its name above."""
    zeros = PITCH * np.arange(len(lines))[::-1]
    for line, zero, colour in zip(lines, zeros, COLOURS, strict=False):
        axes.step(x, zero + line.values, where="post", color=colour)
        axes.text(0.005, zero + 1.22, line.name, transform=axes.get_yaxis_transform(), color=colour, fontsize=9)
    ticks = [(zero + value, word) for zero in zeros for value, word in ((0.0, "false"), (1.0, "true"))]
    axes.set_yticks([place for place, _ in ticks], [word for _, word in ticks], fontsize=8)
    axes.set_ylim(-0.2, zeros[0] + PITCH)


def draw(plan: dict[str, Any]) -> Figure:
    """Draw the picture."""
    along, lines = Series.read(plan["x"]), [Series.read(line) for line in plan["lines"]]
    groups, left_out = panels(lines)
    if left_out:
        print(
            f"note: {left_out} variables are not drawn, because a plot has at most {PANELS} panels of {LINES} lines; "
            "choose the variables with --output-variables",
            file=sys.stderr,
        )
    heights = [height(group) for group in groups]
    canvas = Figure(figsize=(WIDTH, sum(heights) + 0.8), layout="constrained")
    canvas.suptitle(plan["title"], fontsize=11, fontweight="bold")
    if not groups:
        return canvas
    grid = canvas.subplots(len(groups), 1, squeeze=False, sharex=True, height_ratios=heights)
    known = along.values[np.isfinite(along.values)]
    unit, factor = unit_with_prefix(along.unit or "1", float(np.abs(known).max(initial=0.0)))
    for axes, group in zip(grid[:, 0], groups, strict=True):
        axes.margins(x=0.0 if along.name == "time" else 0.02)
        (draw_numbers if group[0].unit else draw_booleans)(axes, factor * along.values, group)
    grid[-1, 0].set_xlabel(f"{along.name} [{unit}]")
    canvas.align_ylabels()
    return canvas


def main() -> None:
    """Read the plan, write the picture."""
    ending = sys.argv[1]
    dates: dict[str, dict[str, None]] = {
        "png": {"Software": None},
        "svg": {"Date": None, "Creator": None},
        "pdf": {"CreationDate": None},
    }
    with mpl.rc_context(STYLE):
        draw(json.load(sys.stdin)).savefig(sys.stdout.buffer, format=ending, dpi=300, metadata=dates[ending])


if __name__ == "__main__":
    main()
