"""The attachments of the actuator with the least peak force, found by the search, compared with the gear as built."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, GREEN, ORANGE, RED, Line, lines
from .fmu import Fmu, Value
from .gear import AIRSPEED, FREE, Array, Travel
from .hf08_inverse import least_force
from .hf08_loads import AXIS
from .page import Claim, Figure, Section

OPTIMUM = Path(__file__).parents[1] / "results" / "least_force_optimum.json"
"""The file `optimum.json` that `cargo fmu optimise docs/studies/least_force.json` writes."""
MOVING = {"crank": BLUE, "coupler": ORANGE, "follower": GREEN}
"""Moving bodies of the linkage and their colours; leg and wheel are fixed to the crank."""
FAINT = 0.3
"""Opacity of the gear when it is up."""


@dataclass(frozen=True)
class Gear:
    """Points of the gear in one position, in the mechanism frame, each (x, y) [m]."""

    ends: dict[str, tuple[Array, Array]]
    """Origin and end of each moving body."""
    attachments: dict[str, Array]
    """The actuator's attachment on each body."""
    wheel: Array


def placed(fmu: Fmu, angle: float, parameters: dict[str, Value]) -> Gear:
    """The gear at an angle of the crank [rad] with these parameters, from the FMU's outputs."""
    fmu.start({**FREE, "crank.start_angle": angle, **parameters})
    ends, attachments = {}, {}
    for body in MOVING:
        x, y, cosine, sine = fmu.read(*(f"{body}.frame.{name}" for name in ("x", "y", "cos", "sin")))
        origin, turned = np.array([x, y]), np.array([[cosine, -sine], [sine, cosine]])
        ends[body] = origin, origin + turned @ [fmu.value(f"{body}.length"), 0.0]
        if fmu.has(f"{body}.actuator_x"):
            point = fmu.read(f"{body}.actuator_x", f"{body}.actuator_y")
            attachments[body] = origin + turned @ point
    return Gear(ends, attachments, np.array(fmu.read("wheel.x", "wheel.y")))


def draw_gear(axes: Axes, gear: Gear, opacity: float) -> None:
    """Draw one position of the gear: bodies as lines, with a triangle to the attachment, joints, actuator, leg and
    wheel."""
    for body, (origin, end) in gear.ends.items():
        color, corners = MOVING[body], [origin, end]
        if body in gear.attachments:
            corners.append(gear.attachments[body])
            axes.fill(*np.array(corners).T, color=color, alpha=0.25 * opacity, linewidth=0.0)
            corners.append(origin)
        axes.plot(*np.array(corners).T, "-", color=color, alpha=opacity, linewidth=1.8)
    hinge = gear.ends["crank"][0]
    axes.plot(*np.array([hinge, gear.wheel]).T, "-", color=MOVING["crank"], alpha=opacity, linewidth=2.6)
    axes.plot(*gear.wheel, "o", color=MOVING["crank"], alpha=opacity, markersize=11.0)
    actuator = np.array(list(gear.attachments.values()))
    axes.plot(*actuator.T, "-", color=RED, alpha=opacity, linewidth=3.0)
    axes.plot(*actuator.T, "s", color=RED, alpha=opacity, markersize=5.0)
    joints = np.array([hinge, gear.ends["crank"][1], gear.ends["coupler"][1], gear.ends["follower"][0]])
    axes.plot(*joints.T, "o", color="0.2", markerfacecolor="white", alpha=opacity, markersize=5.0)


def attachments(fmu: Fmu, travel: Travel, found: dict[str, Value]) -> tuple[Figure, dict[str, float]]:
    """The gear with the attachments as built and as found, down and up."""
    designs: list[tuple[str, dict[str, Value]]] = [("as built", {}), ("found", found)]
    gears = [(name, [placed(fmu, angle, own) for angle in (travel.up, travel.down)]) for name, own in designs]

    def draw(canvas: Canvas) -> None:
        panels = canvas.subplots(1, 2, sharex=True, sharey=True)
        for axes, (name, [up, down]) in zip(panels, gears, strict=True):
            draw_gear(axes, up, FAINT)
            draw_gear(axes, down, 1.0)
            axes.set(title=name, xlabel="x [m]", xticks=[-0.5, 0.0, 0.5], aspect="equal")
            axes.margins(0.08)
        panels[0].set_ylabel("y [m]")

    lengths = {
        f"{name}, {place}": float(np.linalg.norm(np.subtract(*gear.attachments.values())))
        for name, [up, down] in gears
        for place, gear in (("up", up), ("down", down))
    }
    caption = (
        "Not in the paper. Ours: the gear with the attachments as built and with those found, as the FMU places it, "
        "down (full) and up (faint): crank with leg and wheel blue, coupler orange, follower green, actuator red. The "
        f"actuator is {lengths['as built, down']:.3f} m long with the gear down and {lengths['as built, up']:.3f} m "
        f"with the gear up as built, {lengths['found, down']:.3f} and {lengths['found, up']:.3f} m with the "
        "attachments found."
    )
    title = "Design: the gear before and after"
    return Figure("design_attachments", title, caption, draw, size=(6.4, 3.7)), lengths


def section(fmu: Fmu, travel: Travel) -> Section:
    """Figures, claim and numbers of this section."""
    factors = json.loads(OPTIMUM.read_text(encoding="utf-8"))["best"]["factors"]
    parameters: dict[str, Value] = {name: float(value) for name, value in factors.items()}
    rotation, before = least_force(fmu, travel)
    rotation_found, after = least_force(fmu, travel, parameters)
    peak, least = before["forward"].max(), after["forward"].max()

    curves: list[Line] = [
        (rotation, before["forward"] * 1e-3, "--", BLUE, "as built"),
        (rotation_found, after["forward"] * 1e-3, "-", ORANGE, "found"),
    ]
    millimetres = {name: f"{1e3 * float(value):.1f}" for name, value in parameters.items()}
    caption = (
        "Not in the paper. Ours: the four coordinates of the actuator's attachments on crank and follower, each within "
        "30 mm of its place, that need the least peak of `actuator.breakaway_force_forward` over the travel at load "
        f"factor {fmu.default('load_factor'):g}, with friction and air of {AIRSPEED:g} m/s; joint reactions and the "
        "stroke are limited (docs/studies.md). The search found "
        f"({millimetres['crank.actuator_x']}, {millimetres['crank.actuator_y']}) mm on the crank and "
        f"({millimetres['follower.actuator_x']}, {millimetres['follower.actuator_y']}) mm on the follower. "
        f"The force is {peak * 1e-3:.3f} kN at most as built and {least * 1e-3:.3f} kN with the attachments found, "
        f"{100.0 * (1.0 - least / peak):.1f} % less."
    )
    claim = Claim(
        "extra",
        "least peak force of the actuator by the choice of its attachments",
        "not in the paper",
        f"{least * 1e-3:.3f} kN for {peak * 1e-3:.3f} kN as built",
        "with friction, 3 g and air; reactions and stroke limited",
    )
    title = "Design: the attachments of the actuator that need the least peak force"
    draw = lines(AXIS, "least force of the actuator [kN]", curves, zero=True, legend="upper left")
    figure = Figure("design_least_force", title, caption, draw)
    gears, lengths = attachments(fmu, travel, parameters)
    values = {"built": float(peak), "found": float(least), **lengths}
    return Section("Design", [gears, figure], [claim], values)
