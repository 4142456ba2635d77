"""Curves of an FMU with the closed forms as thin lines over them, as in the figures of [CK16]."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D

from .drawing import BLUE, CLOSED_FORM, FAINT, GREEN, ORANGE, RED
from .fmu import Fmu, Value
from .gear import Array
from .page import Figure

STYLES = (("-", BLUE), ("--", ORANGE), ("-.", GREEN), ("-", RED))
WIDE = 3.2
"""Line width of the FMU's curves, so that the closed form is visible within them."""
CLOSED = "closed form"


@dataclass(frozen=True)
class Curve:
    """A quantity by the FMU and in closed form, at the same positions."""

    label: str
    ours: Array
    closed: Array
    printed: Array | None = None
    misprint: str = ""

    @property
    def error(self) -> float:
        """Largest difference from the closed form relative to its largest value."""
        return float(np.abs(self.ours - self.closed).max() / np.abs(self.closed).max())


@dataclass(frozen=True)
class Scale:
    """The axis along which the quantities are drawn."""

    places: Array
    label: str
    ticks: list[float]

    def finish(self, axes: Axes, label: str) -> None:
        """Set labels and ticks."""
        if axes.get_ylim()[0] < 0.0:
            axes.axhline(0.0, color="0.4", linewidth=0.8)
        axes.set(xlabel=self.label, ylabel=label, xlim=(self.places[0], self.places[-1]))
        axes.set_xticks(self.ticks)


def accelerations(
    fmu: Fmu, start: dict[str, Value], drive: str, moving: dict[str, Value], demand: float, output: Callable[[], float]
) -> dict[str, float]:
    """Three accelerations of `output`, each from a motion in which it occurs, and the required force.

    `moving`: start values for the drive's constant speed; `demand`: the drive's acceleration, set by its input. The FMU
    stays in the last motion.
    """
    name, demanded, required = drive.split(".")[0], "demanded_acceleration", "required_force"
    # a_C0: from rest, with the force for the required acceleration at rest.
    fmu.start({**start, **dict.fromkeys(moving, 0.0), f"{name}.{demanded}": demand})
    fmu.set({drive: fmu.value(f"{name}.{required}")})
    row = {"own": output()}
    # Delta a_C: in motion, with the force that keeps the speed constant.
    fmu.start({**start, **moving})
    fmu.set({drive: fmu.value(f"{name}.{required}")})
    row["additional"] = output()
    # a_C: in motion, with the force for the required acceleration.
    fmu.set({f"{name}.{demanded}": demand})
    row["required"] = fmu.value(f"{name}.{required}")
    fmu.set({drive: row["required"]})
    return row | {"total": output(), "acceleration": fmu.value(f"{name}.acceleration")}


def columns(rows: list[dict[str, float]]) -> dict[str, Array]:
    """Each quantity over all rows."""
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def errors(run: dict[str, Array], curves: list[Curve], parts: Array, demand: float) -> dict[str, float]:
    """Largest errors: closed forms, required force as the sum of `parts`, a_C as a sum, demanded acceleration."""

    def part(error: Array, whole: Array) -> float:
        return float(np.abs(error).max() / np.abs(whole).max())

    return {
        "closed": max(curve.error for curve in curves),
        "identity": part(run["required"] - parts, run["required"]),
        "sum": part(run["own"] + run["additional"] - run["total"], run["total"]),
        "round_trip": float(np.abs(run["acceleration"] / demand - 1.0).max()),
    }


def pair(name: str, title: str, caption: str, scale: Scale, curves: list[Curve]) -> Figure:
    """A figure of [CK16] with curves of different units in panels one below another."""
    return Figure(f"ck16_{name}", f"[CK16] figure {title}", caption, panels(scale, *curves), (6.4, 5.2))


def sums(name: str, title: str, caption: str, scale: Scale, label: str, curves: list[Curve]) -> Figure:
    """A figure of [CK16] with a quantity and its parts in one panel."""
    return Figure(f"ck16_{name}", f"[CK16] figure {title}", caption, together(scale, label, *curves))


def panels(scale: Scale, *curves: Curve) -> Callable[[Canvas], None]:
    """Draws curves of different units in panels one below another."""

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
