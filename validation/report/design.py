"""The attachments of the actuator that need the least peak force: what the search found, against the gear as built."""

from __future__ import annotations

import json
from pathlib import Path

from .drawing import BLUE, ORANGE, Line, lines
from .fmu import Fmu, Value
from .gear import AIRSPEED, Travel
from .hf08_inverse import least_force
from .hf08_loads import AXIS
from .page import Claim, Figure, Section

OPTIMUM = Path(__file__).parents[2] / "docs" / "studies" / "least_force_optimum.json"
"""What `cargo fmu optimise docs/studies/least_force.json` writes."""


def section(fmu: Fmu, travel: Travel) -> Section:
    """Figure, claim, numbers."""
    told = json.loads(OPTIMUM.read_text(encoding="utf-8"))["best"]["factors"]
    parameters: dict[str, Value] = {name: float(value) for name, value in told.items()}
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
    values = {"built": float(peak), "found": float(least)}
    return Section("Design", [figure], [claim], values)
