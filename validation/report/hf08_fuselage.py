"""The loads of the gear on the fuselage over the travel, which [HF08] mentions without a figure."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, ORANGE
from .fmu import Fmu
from .four_bar import FourBar
from .gear import FREE, STEP, Array, Travel
from .hf08_loads import AXIS, POINTS
from .page import Claim, Figure, Section, bound

JOINTS = {"joint1": "at the crank's pivot A", "joint4": "at the follower's pivot D"}
"""Outputs of the joints with the ground; the actuator acts between crank and follower and loads no third body."""
READ = (
    "crank.angle",
    "crank.speed",
    "crank.acceleration",
    *(f"{joint}.force_{axis}" for joint in JOINTS for axis in "xy"),
)


def retraction(fmu: Fmu, travel: Travel) -> Array:
    """READ during a retraction with all defaults up to the end of the travel, as rows."""
    fmu.start(FREE)
    rows = [fmu.read(*READ)]
    while rows[-1][0] > travel.up:
        fmu.step(STEP)
        rows.append(fmu.read(*READ))
    rows = np.array(rows).T
    # The last state is beyond the travel.
    last = [np.interp(travel.up, rows[0, ::-1], row[::-1]) for row in rows]
    return np.column_stack([rows[:, :-1], last])


def held(fmu: Fmu, travel: Travel) -> Array:
    """READ at rest within the travel, with the gear held by the actuator, as rows."""
    found = []
    for angle in np.linspace(travel.down, travel.up, POINTS).tolist():
        fmu.start({**FREE, "crank.start_angle": angle})
        fmu.set({"actuator.force": fmu.value("actuator.holding_force")})
        found.append(fmu.read(*READ))
    return np.array(found).T


def balance(fmu: Fmu, rows: Array) -> float:
    """Largest difference between the sum of all forces on the gear and mass times acceleration in closed form, relative
    to the largest of these.
    """
    angle, omega, epsilon = rows[:3]
    up, factor = fmu.default("gravity.up_angle"), fmu.default("load_factor")
    weight = -factor * fmu.default("gravity.acceleration") * np.exp(1j * up)
    forces = rows[3] + rows[5] + 1j * (rows[4] + rows[6])
    inertial = np.zeros_like(forces)
    for mass, center, _ in FourBar.gear(fmu).centers(angle):
        inertial += mass.mass * (center[1] * epsilon + center[2] * omega**2 - weight)
    return float(np.abs(forces - inertial).max() / np.abs(inertial).max())


def section(fmu: Fmu, travel: Travel) -> Section:
    """The figure."""
    moving, still = retraction(fmu, travel), held(fmu, travel)
    # The interpolated last state is not in equilibrium to rounding.
    errors = [balance(fmu, moving[:, :-1]), balance(fmu, still)]
    flow, up = (np.exp(1j * fmu.default(name)) for name in ("air.flow_angle", "gravity.up_angle"))
    loads = [[-(rows[3 + 2 * k] + 1j * rows[4 + 2 * k]) * 1e-3 for k in range(len(JOINTS))] for rows in (moving, still)]
    whole = [sum(run) for run in loads]
    rotations = [travel.rotation(rows[0]) for rows in (moving, still)]

    def draw(canvas: Canvas) -> None:
        panels = canvas.subplots(2, 1, sharex=True)
        for axes, (k, words) in zip(panels, enumerate(JOINTS.values()), strict=True):
            axes.axhline(0.0, color="0.4", linewidth=0.8)
            for run, rotation, style, state in zip(loads, rotations, ("-", "--"), ("retraction", "held"), strict=True):
                for direction, color, name in ((flow, BLUE, "aft"), (up, ORANGE, "up")):
                    part = np.real(np.conj(direction) * run[k])
                    axes.plot(rotation, part, style, color=color, label=f"{state}, {name}")
            axes.set(ylabel=f"load {words} [kN]")
        panels[1].set_xlabel(AXIS)
        panels[0].set_xlim(0.0, travel.degrees)
        handles, labels = panels[0].get_legend_handles_labels()
        canvas.legend(handles, labels, loc="outside upper center", ncols=4)
        canvas.align_ylabels()

    def most(run: list[Array], rotation: Array) -> str:
        places = [int(np.argmax(np.abs(load))) for load in run]
        return " and ".join(
            f"{abs(load[i]):.2f} kN by {joint} (at {rotation[i]:.0f} deg)"
            for load, i, joint in zip(run, places, JOINTS, strict=True)
        )

    factor, force = fmu.default("load_factor"), fmu.default("actuator.force") * 1e-3
    largest = [float(np.abs(sums).max()) for sums in whole]
    caption = (
        "Paper: a study of the rigid model gives the loads on the fuselage; no numbers. Ours: the forces of joint1 and "
        "joint4 on the ground, which are the opposites of `joint1.force_x` and so on. They are drawn along the flow "
        f"(aft) and against gravity (up), for load factor {factor:g}, no air and no friction. Solid: retraction under "
        f"{force:g} kN. The loads are at most {most(loads[0], rotations[0])}, and {largest[0]:.2f} kN together. "
        "Dashed: held at rest by the actuator. The loads are at most "
        f"{most(loads[1], rotations[1])}, and {largest[1]:.2f} kN together, the weight. The actuator acts between "
        "crank and follower and not on the fuselage itself. The sum of both loads agrees with weights and masses times "
        f"accelerations in closed form within {bound(errors)}."
    )
    claim = Claim(
        "[HF08] section 5",
        f"loads on the fuselage during retraction ({force:g} kN, {factor:g} g), at A and at D",
        "not said",
        f"at most {np.abs(loads[0][0]).max():.2f} and {np.abs(loads[0][1]).max():.2f} kN",
        "arms of the actuator are the project's",
    )
    title = "[HF08] section 5: loads on the fuselage over the travel"
    values = {"balance": max(errors), "crank_pivot": float(np.abs(loads[0][0]).max())}
    return Section("[HF08] fuselage", [Figure("hf08_fuselage", title, caption, draw, (6.4, 5.4))], [claim], values)
