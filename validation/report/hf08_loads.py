"""[HF08] figures 3 and 4: drag, and the actuator's force for mass and air loads, over the angle of rotation."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, GREEN, ORANGE, RED, lines
from .fmu import Fmu
from .gear import AIRSPEED, Array, Travel
from .page import Claim, Figure, Section

POINTS = 121
"""Number of angles over the travel."""
LINKS = ("coupler", "follower")
AXIS = "angle of gear rotation [deg]"


def sweep(fmu: Fmu, travel: Travel) -> tuple[Array, dict[str, Array]]:
    """Angle of rotation [deg]; drags and holding forces of mass, air and both loads [N], at rest within the travel."""
    angles = np.linspace(travel.down, travel.up, POINTS)
    rows = []
    for angle in angles:
        fmu.start({"crank.start_angle": float(angle), "airspeed": AIRSPEED})
        both = fmu.read("leg.drag", "wheel.drag", "actuator.holding_force")
        fmu.set({"load_factor": 0.0})
        air = fmu.value("actuator.holding_force")
        fmu.set({"load_factor": fmu.default("load_factor"), "airspeed": 0.0})
        rows.append([*both, air, fmu.value("actuator.holding_force")])
    leg, wheel, both, air, mass = np.array(rows).T
    return travel.rotation(angles), {"leg": leg, "wheel": wheel, "both": both, "air": air, "mass": mass}


def resistance(fmu: Fmu, rotation: Array, loads: dict[str, Array]) -> Figure:
    """Figure 3."""
    leg, wheel = loads["leg"], loads["wheel"]
    whole = leg + wheel
    peak = int(np.argmax(whole))
    flow = math.degrees(fmu.default("air.flow_angle"))
    level = math.degrees(fmu.default("gravity.up_angle")) - 90.0
    # Angle at which the leg points against the flow: crank + leg = flow + 180 deg, minus a turn.
    against = math.degrees(fmu.default("crank.start_angle") + fmu.default("leg.angle")) - (flow - 180.0)

    curves = [
        (rotation, whole, "-", BLUE, "whole gear"),
        (rotation, wheel, "--", ORANGE, "wheel"),
        (rotation, leg, "-.", GREEN, "leg"),
    ]

    def draw(canvas: Canvas) -> None:
        lines(AXIS, "air resistance [N]", curves)(canvas)
        canvas.axes[0].set_ylim(bottom=0.0)

    caption = (
        "Paper: eq. (1), P = ½ ρ v² S Cx with ρ = 1.225 kg/m³, v = 70 m/s, Cx = 0.5; S falls as the gear retracts; no "
        f"sizes in the text. Ours: the same law on each element of the leg (width {fmu.default('leg.width'):g} m, "
        f"length {fmu.default('leg.length'):g} m along the leg) and on the wheel ({fmu.default('wheel.area'):g} m², "
        "flat along the leg), with S the part that faces the flow, S = S₀ |sin(angle between leg and flow)|, so P = ½ "
        f"ρ v² Cx S along the flow. The air flows along the aircraft's axis, at {flow:.2f} deg in the mechanism frame "
        f"(perpendicular to gravity: {level:.2f} deg), against the direction of retraction. The extended leg is raked "
        f"aft, so the resistance first rises: {whole[0]:.1f} N extended, {whole[peak]:.1f} N at {rotation[peak]:.0f} "
        f"deg, {whole[-1]:.2f} N retracted. At {against:.1f} deg the leg points straight against the flow and nothing "
        f"faces it; the retracted leg lies {rotation[-1] - against:.1f} deg beyond."
    )
    return Figure("hf08_03_air_resistance", "[HF08] figure 3: air resistance over the angle of rotation", caption, draw)


def actuator(fmu: Fmu, rotation: Array, loads: dict[str, Array]) -> Figure:
    """Figure 4."""
    mass, air = loads["mass"], loads["air"]
    zero = float(np.interp(0.0, mass, rotation))

    curves = [
        (rotation, mass * 1e-3, "--", BLUE, "mass loads, 3 g"),
        (rotation, air * 1e-3, "-", RED, f"aerodynamic loads, {AIRSPEED:g} m/s"),
    ]
    draw = lines(AXIS, "force in the actuator [kN]", curves, zero=True)
    caption = (
        "Paper: force needed in the actuator over the angle of rotation at a G-load of 3 g, from gravity and from the "
        "air; no numbers in the text. Ours: `actuator.holding_force`, the inverse dynamics at rest without friction, "
        f"once with load factor {fmu.default('load_factor'):g} in still air and once with load factor 0 at 70 m/s; a "
        f"positive force pushes towards retraction. Mass: {mass[0] * 1e-3:.3f} kN extended (the leg is raked aft, so "
        f"its weight helps), zero at {zero:.1f} deg, at most {mass.max() * 1e-3:.3f} kN at "
        f"{rotation[int(np.argmax(mass))]:.0f} deg. Air: at most {air.max() * 1e-3:.3f} kN at "
        f"{rotation[int(np.argmax(air))]:.0f} deg. The arms of the actuator are the project's: the paper's stood in a "
        "figure."
    )
    return Figure("hf08_04_actuator_force", "[HF08] figure 4: force in the actuator from mass and air", caption, draw)


def section(fmu: Fmu, travel: Travel) -> Section:
    """Both figures."""
    rotation, loads = sweep(fmu, travel)
    drag = loads["leg"] + loads["wheel"]
    superposed = float(np.abs(loads["mass"] + loads["air"] - loads["both"]).max() / np.abs(loads["both"]).max())
    gear, links = (sum(fmu.default(f"{body}.mass") for body in bodies) for bodies in (("leg", "wheel"), LINKS))
    crank = fmu.default("crank.mass")
    claims = [
        Claim(
            "[HF08] section 2",
            "the surface that faces the air shrinks with retraction",
            "figure 3 only",
            f"{drag.max():.1f} N at most, {drag[-1]:.2f} N retracted",
            "widths and areas are the project's",
        ),
        Claim(
            "[HF08] section 2",
            "mass of the gear",
            "64 kg",
            f"{gear:.2f} kg leg and wheel, {gear + links:.2f} kg with coupler and follower, {gear + links + crank:.2f} "
            "kg with the crank",
            "masses of the appendix and ρ A l of table 1; the text does not say what is counted",
        ),
        Claim(
            "[HF08] figure 4",
            "force of the actuator from mass loads (3 g) and from the air (70 m/s)",
            "figure only",
            f"{loads['mass'].min() * 1e-3:.2f} to {loads['mass'].max() * 1e-3:.2f} kN and "
            f"{loads['air'].min() * 1e-3:.2f} to {loads['air'].max() * 1e-3:.2f} kN, "
            f"of {fmu.default('actuator.force') * 1e-3:g} kN",
            "arms of the actuator are the project's",
        ),
    ]
    values = {"superposition": superposed, "drag_end": float(drag[-1] / drag.max())}
    return Section("[HF08] loads", [resistance(fmu, rotation, loads), actuator(fmu, rotation, loads)], claims, values)
