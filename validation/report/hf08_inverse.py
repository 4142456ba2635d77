"""[HF08] figure 12, the least force of the actuator over the travel, and the force for a smooth retraction."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, GREEN, ORANGE, RED
from .fmu import Fmu, Value
from .gear import AIRSPEED, FREE, Array, Travel
from .hf08_friction import FRICTION
from .hf08_loads import AXIS
from .page import Claim, Figure, Section, bound

COAST = {"crank.start_speed": -2.0, "load_factor": 0.0, "actuator.force": 0.0}
"""A slow motion through the travel without loads, at whose positions forces at rest are read."""
COAST_STEP = 10e-3
"""Communication step of this motion [s]."""
FORCES = ("holding_force", "breakaway_force_forward", "breakaway_force_backward")
DURATION = 1.0
"""Duration of the smooth retraction [s]."""
POINTS = 50
"""Number of states along the smooth retraction, in the middles of equal parts of its duration."""


def least_force(fmu: Fmu, travel: Travel, parameters: dict[str, Value] | None = None) -> tuple[Array, dict[str, Array]]:
    """Angle of rotation [deg]; force [N] without friction, and the breakaway forces in both directions, with all
    defaults except these parameters."""
    loads = {"load_factor": fmu.default("load_factor"), "airspeed": AIRSPEED}
    fmu.start({**FREE, **FRICTION, **COAST, **(parameters or {})})
    rows: list[list[float]] = []
    while not rows or rows[-1][0] >= travel.up:
        if rows:
            fmu.step(COAST_STEP)
        fmu.set(loads)
        rows.append(fmu.read("crank.angle", *(f"actuator.{name}" for name in FORCES)))
        fmu.set({"load_factor": 0.0, "airspeed": 0.0})
    angle, *forces = np.array(rows).T
    # The last state is beyond the travel: forces at its end are interpolated.
    ends = [np.interp(travel.up, angle[::-1], force[::-1]) for force in forces]
    angle[-1] = travel.up
    for force, end in zip(forces, ends, strict=True):
        force[-1] = end
    names = ("plain", "forward", "backward")
    return travel.rotation(angle), dict(zip(names, forces, strict=True))


def quasi_static(fmu: Fmu, rotation: Array, forces: dict[str, Array]) -> tuple[Figure, Claim, dict[str, float]]:
    """Figure 12."""
    plain, forward, backward = forces["plain"], forces["forward"], forces["backward"]
    extra = forward - plain
    most = int(np.argmax(extra))

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.axhline(0.0, color="0.4", linewidth=0.8)
        axes.plot(rotation, forward * 1e-3, "-", color=ORANGE, label="with friction")
        axes.plot(rotation, plain * 1e-3, "--", color=BLUE, label="without friction")
        axes.plot(rotation, backward * 1e-3, ":", color="0.5", linewidth=1.4, label="gear slides back, with friction")
        axes.set(xlabel=AXIS, ylabel="least force of the actuator [kN]")
        axes.legend(loc="upper left")

    caption = (
        "Paper: least force that turns the gear, mass forces of 3 g and aerodynamic forces in it (over time in the "
        "text, over the angle of rotation under the figure); no numbers. Ours: quasi-static inverse dynamics, load "
        f"factor {fmu.default('load_factor'):g} and air of {AIRSPEED:g} m/s: `actuator.holding_force` without "
        "friction, `actuator.breakaway_force_forward` with it, each joint at µ_S = "
        f"{fmu.default('friction.static_coefficient'):g} against the motion. At most {plain.max() * 1e-3:.3f} kN "
        f"without and {forward.max() * 1e-3:.3f} kN with friction, {100.0 * (forward.max() / plain.max() - 1.0):.2f} % "
        f"more; friction takes {extra.min() * 1e-3:.3f} to {extra[most] * 1e-3:.3f} kN, most at {rotation[most]:.0f} "
        "deg. Where the curve is negative the gear must be held back. Between the dotted line "
        "(`breakaway_force_backward`) and the solid one the gear sticks."
    )
    claim = Claim(
        "[HF08] figure 12",
        "least force of the actuator without and with friction, 3 g and air",
        "figure only",
        f"at most {plain.max() * 1e-3:.3f} and {forward.max() * 1e-3:.3f} kN",
        f"the {fmu.default('actuator.force') * 1e-3:g} kN of the runs are ample",
    )
    title = "[HF08] figure 12: least actuator force with and without friction"
    values = {"plain": float(plain.max()), "forward": float(forward.max()), "extra_least": float(extra.min())}
    return Figure("hf08_12_least_force", title, caption, draw), claim, values


def profile(travel: Travel, s: Array) -> tuple[Array, Array, Array]:
    """Angle, speed and acceleration of the crank at the times s DURATION; speed and acceleration 0 at both ends."""
    way = travel.up - travel.down
    angle = travel.down + way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    speed = way * 30.0 * s**2 * (1.0 - s) ** 2 / DURATION
    acceleration = way * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / DURATION**2
    return angle, speed, acceleration


def required(fmu: Fmu, friction: bool, courses: tuple[Array, Array, Array]) -> tuple[Array, Array, float]:
    """Required forces [N] along a profile of the crank, in still and in moving air, and the error of this motion.

    The error is that of the acceleration under the required forces, relative to the largest acceleration.
    """
    rows, worst = [], 0.0
    for angle, speed, acceleration in zip(*(c.tolist() for c in courses), strict=True):
        fmu.start({"crank.start_angle": angle, "crank.start_speed": speed, "friction.enabled": friction})
        row = []
        for airspeed in (0.0, AIRSPEED):
            fmu.set({"airspeed": airspeed, "actuator.force": fmu.default("actuator.force")})
            # The drive's length x is a function of the crank angle: x_ddot = x' epsilon + x'' omega^2.
            names = ("crank.speed", "crank.acceleration", "actuator.speed", "actuator.acceleration")
            omega, epsilon, x_dot, x_ddot = fmu.read(*names)
            demand = x_ddot + x_dot / omega * (acceleration - epsilon)
            fmu.set({"actuator.demanded_acceleration": demand})
            row.append(fmu.value("actuator.required_force"))
            fmu.set({"actuator.force": row[-1]})
            worst = max(worst, abs(fmu.value("crank.acceleration") - acceleration))
        rows.append(row)
    still, moving = np.array(rows).T
    return still, moving, worst / float(np.abs(courses[2]).max())


def along_profile(fmu: Fmu, travel: Travel) -> tuple[Figure, Claim, dict[str, float]]:
    """The additional figure."""
    courses = profile(travel, (np.arange(POINTS) + 0.5) / POINTS)
    rotation = travel.rotation(courses[0])
    still, windy, error = required(fmu, False, courses)
    rough, rough_windy, rough_error = required(fmu, True, courses)
    friction, air = rough_windy - windy, windy - still
    errors = bound([error, rough_error])

    def draw(canvas: Canvas) -> None:
        force, parts = canvas.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        force.axhline(0.0, color="0.4", linewidth=0.8)
        force.plot(rotation, rough_windy * 1e-3, "-", color=ORANGE, label="air and friction")
        force.plot(rotation, windy * 1e-3, "--", color=RED, label="air")
        force.plot(rotation, rough * 1e-3, "-.", color=GREEN, label="friction")
        force.plot(rotation, still * 1e-3, ":", color=BLUE, label="neither")
        force.set(ylabel="required force [kN]")
        force.legend(loc="upper left", ncols=2)
        parts.axhline(0.0, color="0.4", linewidth=0.8)
        parts.plot(rotation, friction, "-", color=ORANGE, label="friction: with less without, in air")
        parts.plot(rotation, air, "--", color=RED, label="air: moving less still, no friction")
        parts.set(xlabel=AXIS, ylabel="difference [N]")
        parts.legend()
        parts.set_xlim(0.0, travel.degrees)

    caption = (
        f"Not in the paper. Ours: `actuator.required_force` along a retraction of {DURATION:g} s with the crank on a "
        f"quintic from rest to rest (fastest {float(np.abs(courses[1]).max()):.3f} rad/s, acceleration up to "
        f"{float(np.abs(courses[2]).max()):.2f} rad/s²), load factor {fmu.default('load_factor'):g}, with and without "
        f"air of {AIRSPEED:g} m/s and friction: at most {still.max() * 1e-3:.2f} kN with neither, "
        f"{windy.max() * 1e-3:.2f} kN in air, {rough.max() * 1e-3:.2f} kN with friction, "
        f"{rough_windy.max() * 1e-3:.2f} kN with both. Friction takes {friction.min():.0f} to {friction.max():.0f} N, "
        f"the air {air.min():.0f} to {air.max():.0f} N; near the ends, near rest, this law of friction has next to "
        f"none. Applied as `actuator.force`, these forces give the demanded acceleration within {errors} of its "
        "largest value."
    )
    claim = Claim(
        "extra",
        f"required force along a smooth retraction of {DURATION:g} s, 3 g, air and friction",
        "not in the paper",
        f"at most {rough_windy.max() * 1e-3:.2f} kN",
        f"inverse and forward dynamics agree within {errors}",
    )
    title = "Extra to figure 12: required force along a smooth retraction"
    values = {"round_trip": max(error, rough_error), "required": float(rough_windy.max())}
    return Figure("hf08_12b_required_force", title, caption, draw, size=(6.4, 5.6)), claim, values


def section(fmu: Fmu, travel: Travel) -> Section:
    """Both figures."""
    least, least_claim, values = quasi_static(fmu, *least_force(fmu, travel))
    smooth, smooth_claim, more = along_profile(fmu, travel)
    return Section("[HF08] inverse dynamics", [least, smooth], [least_claim, smooth_claim], values | more)
