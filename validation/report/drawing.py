"""The common style of all figures; the files are identical on every run."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure as Canvas
from PIL import Image

from .gear import Array
from .page import Figure

BLUE, ORANGE, GREEN, RED = "#0b5394", "#d9730d", "#2e7d32", "#a61c3c"
"""Colours of curves; line styles distinguish them in greyscale too."""
CLOSED_FORM = {"color": "black", "linewidth": 0.7, "zorder": 3}
"""Style of a closed form: a thin line over the FMU's curve."""
FAINT = {"color": "0.55", "linewidth": 1.0}
"""Style of what is shown for comparison only."""

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.xmargin": 0.0,
    "lines.linewidth": 2.0,
    "legend.frameon": True,
    "legend.framealpha": 0.9,
    "legend.edgecolor": "none",
    "legend.fontsize": 8.5,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "linkage-fmu",
    "svg.fonttype": "path",
    "figure.constrained_layout.w_pad": 0.08,
    "figure.constrained_layout.h_pad": 0.06,
}
RESOLUTION = 120
"""Resolution of the PNG files [dots per inch]."""
COLOURS = 64
"""Number of colours of the PNG files: lines with antialiased edges need no more."""


Line = tuple[Array, Array, str, str, str]
"""Positions, values, style, colour and label of a curve."""


def lines(
    across: str, up: str, curves: list[Line], zero: bool = False, legend: str = "best"
) -> Callable[[Canvas], None]:
    """Draws curves in one panel, with a line at 0 if `zero`, and a legend if there are several."""

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        if zero:
            axes.axhline(0.0, color="0.4", linewidth=0.8)
        for places, values, style, color, label in curves:
            axes.plot(places, values, style, color=color, label=label)
        axes.set(xlabel=across, ylabel=up)
        if len(curves) > 1:
            axes.legend(loc=legend)

    return draw


def drawn(figure: Figure) -> tuple[bytes, str]:
    """One figure as the bytes of a PNG and of an SVG file."""
    with mpl.rc_context(STYLE):
        canvas = Canvas(figsize=figure.size)
        figure.draw(canvas)
        full, small, drawing = io.BytesIO(), io.BytesIO(), io.StringIO()
        canvas.savefig(full, format="png", dpi=RESOLUTION, metadata={"Software": None})
        canvas.savefig(drawing, format="svg", metadata={"Date": None, "Creator": None})
    image = Image.open(full).convert("RGB").quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    image.save(small, format="png", optimize=True, dpi=(RESOLUTION, RESOLUTION))
    return small.getvalue(), shortened(drawing.getvalue())


def write(figure: Figure, folder: Path) -> None:
    """Draw one figure into NAME.png and NAME.svg."""
    picture, drawing = drawn(figure)
    (folder / f"{figure.name}.png").write_bytes(picture)
    (folder / f"{figure.name}.svg").write_text(drawing, encoding="utf-8", newline="\n")


def shortened(drawing: str) -> str:
    """An SVG without trailing blanks, with coordinates of lines rounded to a hundredth of a point."""

    def line(text: str) -> str:
        text = text.rstrip()
        if re.match(r"(<path d=\")?[ML] ", text.lstrip()):
            text = re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}", text)
        return text + "\n"

    return "".join(line(text) for text in drawing.splitlines())
