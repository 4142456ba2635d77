"""[CK16] figures 13 to 16: the jib of figure 12 reduced to its cylinder, over the cylinder's length x."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from .curves import Curve, Scale, accelerations, columns, errors, pair, sums
from .fmu import Fmu
from .gear import Array
from .page import Claim, Section, bound

SPEED = 0.5
"""v_S [m/s]."""
ACCELERATION = 0.5
"""a_S [m/s2]."""
X = np.linspace(2.2, 3.2, 101)
"""Range of the paper [m]."""
SCALE = Scale(X, "length x of the cylinder [m]", [2.2, 2.4, 2.6, 2.8, 3.0, 3.2])


def measure(fmu: Fmu, e: float, b: float) -> dict[str, Array]:
    """Outputs of the FMU at each length; each acceleration from a motion in which it occurs."""
    rows = []
    for x in X.tolist():
        angle = math.asin((x * x - e * e - b * b) / (2.0 * e * b))
        start = {"jib.start_angle": angle}
        across = -math.sin(angle), math.cos(angle)

        def along(kind: str, across: tuple[float, float] = across) -> float:
            """Component, across the jib, of the velocity or acceleration of its end."""
            return float(np.dot(across, fmu.read(f"tip.{kind}_x", f"tip.{kind}_y")))

        # The jib's speed at which the cylinder has the speed v_S: the two are proportional.
        fmu.start({**start, "jib.start_speed": 1.0})
        moving = {"jib.start_speed": SPEED / fmu.value("cylinder.speed")}
        row = accelerations(fmu, start, "cylinder.force", moving, ACCELERATION, partial(along, "acceleration"))
        row["ratio"] = fmu.value("cylinder.speed") / along("velocity")
        names = ("length", "reduced_mass", "reduced_mass_derivative", "static_load", "additional_force")
        row |= dict(zip(names, fmu.read(*(f"cylinder.{name}" for name in names)), strict=True))
        rows.append(row)
    return columns(rows)


def section(fmu: Fmu) -> Section:
    """All four figures."""
    e = math.hypot(fmu.default("ground.S_x"), fmu.default("ground.S_y"))
    b = math.hypot(fmu.default("jib.B_x"), fmu.default("jib.B_y"))
    length, mass = fmu.default("jib.length"), fmu.default("load.mass")
    weight = mass * fmu.default("gravity.acceleration") * fmu.default("load_factor")
    run = measure(fmu, e, b)
    # Sine of the angle between e and x, and eqs. (39) to (42).
    sine = np.sqrt(1.0 - ((X**2 + e**2 - b**2) / (2.0 * e * X)) ** 2)
    iv = e / length * sine
    div = -((e / length) ** 2) * (X**4 - (e**2 - b**2) ** 2) / (4.0 * e**2 * X**3 * iv)
    m = mass * length**2 * 4.0 * X**2 / (4.0 * e**2 * X**2 - (X**2 + e**2 - b**2) ** 2)
    dm = 0.5 * mass * length**2 / e**4 * (X**4 - (e**2 - b**2) ** 2) / (X**3 * sine**4)
    cosine = np.sqrt(1.0 - ((X**2 - e**2 - b**2) / (2.0 * e * b)) ** 2)
    ratios = [
        Curve("$i_v$ [1]", run["ratio"], iv),
        Curve("$di_v/dx$ [1/m]", -run["additional"] * run["ratio"] ** 2 / SPEED**2, div),
    ]
    masses = [
        Curve("$m_{zS}$ [t]", run["reduced_mass"] * 1e-3, m * 1e-3),
        Curve("$dm_{zS}/dx$ [t/m]", run["reduced_mass_derivative"] * 1e-3, dm * 1e-3),
    ]
    additional = -(SPEED**2) / iv**2 * div
    load = [
        Curve("$a_{C0}$", run["own"], ACCELERATION / iv),
        Curve("$Δa_C$", run["additional"], additional, additional * SPEED, "$Δa_C$ of eq. (24) as printed"),
        Curve("$a_C$", run["total"], ACCELERATION / iv + additional),
    ]
    terms = [weight * cosine / iv, m * ACCELERATION, -0.5 * SPEED**2 * dm]
    forces = [
        Curve("$F_{Su}$", run["static_load"] * 1e-3, terms[0] * 1e-3),
        Curve("$m_{zS} a_S$", run["reduced_mass"] * ACCELERATION * 1e-3, terms[1] * 1e-3),
        Curve("$ΔF_S$", run["additional_force"] * 1e-3, terms[2] * 1e-3),
        Curve("$F_S$", run["required"] * 1e-3, (terms[0] + terms[1] - terms[2]) * 1e-3),
    ]
    parts = run["static_load"] + run["reduced_mass"] * ACCELERATION - run["additional_force"]
    values = errors(run, ratios + masses + load + forces, parts, ACCELERATION)
    closed, identity, sum_of_two, round_trip = map(bound, values.values())
    values["length"] = float(np.abs(run["length"] - X).max())

    def ends(values: Array, digits: int = 3) -> str:
        return f"{values[0]:.{digits}f} to {values[-1]:.{digits}f}"

    caption_13 = (
        f"Paper: eqs. (39), (40) for x from 2.2 to 3.2 m; e, b, l stood in a lost figure. Ours: e = {e:g} m, b = {b:g} "
        f"m, l = {length:g} m; i_v = `cylinder.speed` / speed of the jib's end, its derivative from the end's "
        f"acceleration at constant v_S, eq. (24) as corrected. i_v {ends(ratios[0].ours, 5)}, derivative "
        f"{ends(ratios[1].ours, 5)} 1/m. Thin lines: (39), (40), right as printed."
    )
    caption_14 = (
        "Paper: eqs. (41), (42), efficiency 1. Ours: `cylinder.reduced_mass` and `cylinder.reduced_mass_derivative`, "
        f"m_C = {mass:g} kg (the project's): {ends(masses[0].ours)} t and {ends(masses[1].ours)} t/m. Thin lines: "
        "(41), (42), right as printed."
    )
    caption_15 = (
        f"Paper: eq. (24), constant v_S and a_S, no values in the text. Ours: v_S = {SPEED:g} m/s, a_S = "
        f"{ACCELERATION:g} m/s²; acceleration of the jib's end across the jib, from rest under the force that gives "
        "a_S (a_C0), at v_S under the force that keeps it (Δa_C), and at v_S under the force that gives a_S (a_C): "
        f"{ends(load[0].ours)}, {ends(load[1].ours)} and {ends(load[2].ours)} m/s². The sum holds within "
        f"{sum_of_two}. Thin lines: (24) with v_S² di_v/dx; in print it has v_S² di_v/dt, whose "
        f"unit is not that of an acceleration and which in SI units is v_S = {SPEED:g} times as large (grey)."
    )
    caption_16 = (
        "Paper: eqs. (32)-(37), no values in the text. Ours: as figure 15, load under its weight; "
        "`cylinder.static_load`, reduced mass times a_S, `cylinder.additional_force`, `cylinder.required_force`: "
        f"{ends(forces[0].ours)}, {ends(forces[1].ours)}, {ends(forces[2].ours)} and {ends(forces[3].ours)} kN. F_S = "
        f"F_Su + m_zS a_S - ΔF_S within {identity}; applied as `cylinder.force`, F_S gives a_S within "
        f"{round_trip}. The terms with di_v/dt in (31), (34) and the first line of (35) are misprinted in the "
        "same way; (25) and (36) are right."
    )
    load_title = "15: acceleration of the load and its parts"
    figures = [
        pair("13_ratio", "13: ratio and its derivative", caption_13, SCALE, ratios),
        pair("14_reduced_mass", "14: reduced mass and its derivative", caption_14, SCALE, masses),
        sums("15_load_acceleration", load_title, caption_15, SCALE, "acceleration [m/s²]", load),
        sums("16_cylinder_force", "16: force of the cylinder and its parts", caption_16, SCALE, "force [kN]", forces),
    ]
    claims = [
        Claim(
            "[CK16] (39)-(42)",
            "i_v, m_zS and their derivatives in closed form, x from 2.2 to 3.2 m",
            "formulas",
            f"met within {closed}",
            "right as printed",
        ),
        Claim(
            "[CK16] (24)",
            "a_C = a_C0 + Δa_C",
            "identity",
            f"holds within {sum_of_two}",
            "v_S² di_v/dx, in print di_v/dt",
        ),
        Claim(
            "[CK16] (37), (38)",
            "F_S = F_Su + m_zS a_S - ΔF_S, forward and inverse",
            "identity",
            f"holds within {identity}; a_S comes back within {round_trip}",
        ),
    ]
    introduction = "Of its numbers the text has the range of x; the rest stood in a figure and is the project's.\n"
    return Section("[CK16] jib", figures, claims, values, introduction)
