"""[CK16] figures 6 to 9: the slider-crank of figure 5 reduced to its crank.

alpha is measured from the inner dead centre, as in eq. (18); the FMU's crank angle is alpha - 90 deg. In the paper only
the piston has mass; the FMU's crank has an additional constant inertia, which is subtracted where it matters.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from .curves import Curve, Scale, accelerations, columns, errors, pair, sums
from .fmu import Fmu
from .gear import Array
from .page import Claim, Section, bound

SPEED = 100.0
"""omega_S [rad/s]."""
ACCELERATION = 1000.0
"""epsilon_S [rad/s2]."""
ALPHA = np.radians(np.arange(0.0, 361.0, 2.0))
SCALE = Scale(np.degrees(ALPHA), "crank angle α from the inner dead centre [deg]", list(range(0, 361, 45)))


def radius(r: float, ratio: float) -> Array:
    """R_z by eq. (18) with this ratio before sin^2 under the root; NaN where the root is imaginary."""
    under = ratio - np.sin(ALPHA) ** 2
    root = np.sqrt(np.where(under > 0.0, under, np.nan))
    return r * (np.sin(ALPHA) - 0.5 * np.sin(2.0 * ALPHA) / root)


def radius_derivative(r: float, ratio: float, factor: float) -> Array:
    """dR_z/dalpha by eq. (19), with the factor 1 instead of the printed 1/2."""
    under = ratio - np.sin(ALPHA) ** 2
    top = 2.0 * np.cos(2.0 * ALPHA) * under + 0.5 * np.sin(2.0 * ALPHA) ** 2
    return r * (np.cos(ALPHA) - factor * top / (2.0 * under**1.5))


def measure(fmu: Fmu) -> dict[str, Array]:
    """Outputs of the FMU at each angle; each acceleration from a motion in which it occurs."""
    rows = []
    for alpha in ALPHA.tolist():
        start = {"crank.start_angle": alpha - 0.5 * math.pi}
        moving = {"crank.start_speed": SPEED}
        output = partial(fmu.value, "piston.acceleration_y")
        row = accelerations(fmu, start, "drive.torque", moving, ACCELERATION, output)
        row["radius"] = fmu.value("piston.velocity_y") / SPEED
        names = ("reduced_inertia", "reduced_inertia_derivative", "static_load", "additional_torque")
        row |= dict(zip(names, fmu.read(*(f"drive.{name}" for name in names)), strict=True))
        rows.append(row)
    return columns(rows)


def section(fmu: Fmu) -> Section:
    """All four figures."""
    run = measure(fmu)
    r, rod, mass = fmu.default("crank.length"), fmu.default("rod.length"), fmu.default("piston.mass")
    crank, push = fmu.default("crank.inertia"), fmu.default("piston.force_y")
    load = mass * fmu.default("gravity.acceleration") * fmu.default("load_factor") - push
    ratio = (rod / r) ** 2
    rz, drz = radius(r, ratio), radius_derivative(r, ratio, 1.0)
    inertia = run["reduced_inertia"] - crank
    radii = [
        Curve("$R_z$ [mm]", run["radius"] * 1e3, rz * 1e3),
        Curve(
            "$dR_z/dα$ [mm/rad]",
            run["additional"] / SPEED**2 * 1e3,
            drz * 1e3,
            radius_derivative(r, ratio, 0.5) * 1e3,
            "eq. (19) with its extra ½",
        ),
    ]
    inertias = [
        Curve("$I_{zS}$ [kg cm²]", inertia * 1e4, mass * rz**2 * 1e4),
        Curve("$dI_{zS}/dα$ [kg cm²/rad]", run["reduced_inertia_derivative"] * 1e4, 2e4 * mass * rz * drz),
    ]
    piston = [
        Curve("$a_{C0}$", run["own"], rz * ACCELERATION),
        Curve("$Δa_C$", run["additional"], SPEED**2 * drz),
        Curve("$a_C$", run["total"], rz * ACCELERATION + SPEED**2 * drz),
    ]
    terms = [load * rz, mass * rz**2 * ACCELERATION, -(SPEED**2) * mass * rz * drz]
    torques = [
        Curve("$T_{Su}$", run["static_load"], terms[0]),
        Curve("$I_{zS} ε_S$", inertia * ACCELERATION, terms[1]),
        Curve("$ΔT_S$", run["additional_torque"], terms[2]),
        Curve("$T_S$", run["required"] - crank * ACCELERATION, terms[0] + terms[1] - terms[2]),
    ]
    parts = run["static_load"] + run["reduced_inertia"] * ACCELERATION - run["additional_torque"]
    values = errors(run, radii + inertias + piston + torques, parts, ACCELERATION)
    closed, identity, sum_of_two, round_trip = map(bound, values.values())
    printed, once = radius(r, 1.0 / ratio), slice(0, -1)
    real = int(np.isfinite(printed[once]).sum())
    half_off = float(np.abs(radii[1].ours - radii[1].printed).max() / np.abs(radii[1].closed).max())

    def at(curve: Curve) -> str:
        # Over a turn extremes occur in pairs that differ by rounding: the later one is reported.
        sizes = np.abs(curve.ours)
        place = int(np.flatnonzero(sizes >= (1.0 - 1e-9) * sizes.max())[-1])
        return f"{curve.ours[place]:.3f} at {SCALE.places[place]:.0f} deg"

    caption_6 = (
        f"Paper: eqs. (18), (19) over 0 to 360 deg; its lengths stood in a lost figure. Ours: r = {r:g} m, l = {rod:g} "
        "m; R_z = `piston.velocity_y` / ω_S, its derivative from the piston's acceleration at constant ω_S, eq. (3). "
        f"Largest R_z {float(np.abs(radii[0].ours).max()):.3f} mm. Thin lines: (18), (19) corrected, l²/r² under the "
        f"root and in (19) no ½ before the fraction. In print (18) has r²/l² there: its root is real at only {real} of "
        f"the {len(ALPHA) - 1} angles drawn. With l²/r² but the extra ½, (19) would be off by up to "
        f"{100.0 * half_off:.1f} % of its largest value (grey)."
    )
    caption_7 = (
        "Paper: eqs. (20), (21), efficiency 1, the piston alone has mass. Ours: `drive.reduced_inertia` less the "
        f"crank's own constant {crank:g} kg m², and `drive.reduced_inertia_derivative`; m_C = {mass:g} kg (the "
        f"project's). At most {float(inertias[0].ours.max()):.4f} kg cm², derivative {at(inertias[1])} (kg cm²/rad). "
        "Thin lines: (20), (21) with l²/r²; as printed they have the root of (18), imaginary nearly everywhere, but "
        "(21) has the factor of (19) right."
    )
    caption_8 = (
        f"Paper: eq. (3), constant ω_S and ε_S, no values in the text. Ours: ω_S = {SPEED:g} rad/s, ε_S = "
        f"{ACCELERATION:g} rad/s²; `piston.acceleration_y` from rest under the torque that gives ε_S (a_C0), at ω_S "
        "under the torque that keeps it (Δa_C), and at ω_S under the torque that gives ε_S (a_C). Largest: a_C0 "
        f"{at(piston[0])}, Δa_C {at(piston[1])}, a_C {at(piston[2])} (m/s²). The sum a_C0 + Δa_C "
        f"is a_C within {sum_of_two}."
    )
    caption_9 = (
        f"Paper: eqs. (11)-(16), no values in the text. Ours: as figure 8, piston under its weight and {-push:g} N "
        "downwards; `drive.static_load`, reduced inertia times ε_S, `drive.additional_torque`, "
        f"`drive.required_force`, the crank's own {crank * ACCELERATION:g} N m taken off the second and the last. "
        f"Largest: T_Su {at(torques[0])}, I_zS ε_S {at(torques[1])}, ΔT_S {at(torques[2])}, T_S {at(torques[3])} (N "
        f"m). T_S = T_Su + I_zS ε_S - ΔT_S within {identity}; applied as `drive.torque`, T_S gives ε_S within "
        f"{round_trip}."
    )
    piston_title = "8: acceleration of the piston and its parts"
    figures = [
        pair("06_effective_radius", "6: effective radius and its derivative", caption_6, SCALE, radii),
        pair("07_reduced_inertia", "7: reduced moment of inertia and its derivative", caption_7, SCALE, inertias),
        sums("08_piston_acceleration", piston_title, caption_8, SCALE, "acceleration [m/s²]", piston),
        sums("09_crank_torque", "9: torque at the crank and its parts", caption_9, SCALE, "torque [N m]", torques),
    ]
    claims = [
        Claim(
            "[CK16] (18)-(21)",
            "R_z, I_zS and their derivatives in closed form",
            "formulas",
            f"corrected formulas met within {closed}",
            f"as printed: (18) imaginary at {len(ALPHA) - 1 - real} of {len(ALPHA) - 1} angles, (19) off by up to "
            f"{100.0 * half_off:.1f} %",
        ),
        Claim("[CK16] (3)", "a_C = a_C0 + Δa_C", "identity", f"holds within {sum_of_two}"),
        Claim(
            "[CK16] (16), (17)",
            "T_S = T_Su + I_zS ε_S - ΔT_S, forward and inverse",
            "identity",
            f"holds within {identity}; ε_S comes back within {round_trip}",
        ),
    ]
    introduction = "The numbers of its example stood in a figure: lengths, masses and motion are the project's.\n"
    return Section("[CK16] slider-crank", figures, claims, values, introduction)
