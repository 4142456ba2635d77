"""Curves of an FMU with the closed forms as thin lines over them: what the figures of [CK16] have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D

from .drawing import BLUE, CLOSED_FORM, FAINT, GREEN, ORANGE, RED
from .gear import Array

STYLES = (("-", BLUE), ("--", ORANGE), ("-.", GREEN), ("-", RED))
WIDE = 3.2
"""Of the FMU's lines, so that the closed form is seen within them."""
CLOSED = "closed form"


@dataclass(frozen=True)
class Curve:
    """A quantity by the FMU and by its closed form, over the same places."""

    label: str
    ours: Array
    closed: Array
    printed: Array | None = None
    misprint: str = ""

    @property
    def error(self) -> float:
        """Largest distance from the closed form, as a part of its largest value."""
        return float(np.abs(self.ours - self.closed).max() / np.abs(self.closed).max())


@dataclass(frozen=True)
class Scale:
    """The axis along which the quantities are drawn."""

    places: Array
    label: str
    ticks: list[float]

    def finish(self, axes: Axes, label: str) -> None:
        """Labels and ticks."""
        if axes.get_ylim()[0] < 0.0:
            axes.axhline(0.0, color="0.4", linewidth=0.8)
        axes.set(xlabel=self.label, ylabel=label, xlim=(self.places[0], self.places[-1]))
        axes.set_xticks(self.ticks)


def panels(scale: Scale, *curves: Curve) -> Callable[[Canvas], None]:
    """Draws curves of different units below each other."""

    def draw(canvas: Canvas) -> None:
        rows = canvas.subplots(len(curves), 1, sharex=True)
        for axes, curve, color in zip(rows, curves, (BLUE, ORANGE), strict=True):
            axes.plot(scale.places, curve.ours, color=color, linewidth=WIDE, label="FMU")
            axes.plot(scale.places, curve.closed, **CLOSED_FORM, label=CLOSED)
            if curve.printed is not None:
                axes.plot(scale.places, curve.printed, "--", **FAINT, label=curve.misprint)
            scale.finish(axes, curve.label)
            axes.legend()
        for axes in rows[:-1]:
            axes.set_xlabel("")
        canvas.align_ylabels()

    return draw


def together(scale: Scale, label: str, *curves: Curve) -> Callable[[Canvas], None]:
    """Draws curves of one unit in one panel."""

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        handles: list[Line2D] = []
        formulas: list[Line2D] = []
        for curve, (style, color) in zip(curves, STYLES, strict=False):
            handles += axes.plot(scale.places, curve.ours, style, color=color, linewidth=WIDE, label=curve.label)
            thin = axes.plot(scale.places, curve.closed, **CLOSED_FORM, label=CLOSED)
            if curve.printed is not None:
                thin += axes.plot(scale.places, curve.printed, "--", **FAINT, label=curve.misprint)
            formulas = thin if len(thin) > len(formulas) else formulas
        scale.finish(axes, label)
        canvas.legend(handles=[*handles, *formulas], loc="outside upper center", ncols=5, handlelength=3.0)

    return draw
