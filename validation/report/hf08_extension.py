"""The extension of the gear, which [HF08] mentions without a figure: crank angle and speed under a pulling actuator."""

from __future__ import annotations

from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, GREEN, ORANGE
from .fmu import Fmu, Value
from .gear import AIRSPEED, STEP, Motion, Travel, turn
from .hf08_friction import FRICTION
from .page import Claim, Figure, Section, bound

PULL = 9000.0
"""Pulling force of the actuator, a choice of this project [N]."""


def extend(fmu: Fmu, travel: Travel, values: dict[str, Value]) -> Motion:
    """An extension from rest with the gear up, with all defaults except the pull and these values."""
    return turn(fmu, travel.down, pulled(travel, values))


def pulled(travel: Travel, values: dict[str, Value]) -> dict[str, Value]:
    """Start values of an extension."""
    return {"crank.start_angle": travel.up, "actuator.force": -PULL, **values}


def impact(fmu: Fmu, travel: Travel, after: float) -> tuple[float, float]:
    """Time [s] and impulse of the impact on the stop of the gear down, in a run up to this time [s]."""
    fmu.start(pulled(travel, {}))
    while fmu.time <= after:
        fmu.step(STEP)
    time, impulse = fmu.read("downstop.impact_time", "downstop.impact_impulse")
    return time, impulse


def section(fmu: Fmu, travel: Travel) -> Section:
    """The figure."""
    factor = fmu.default("load_factor")
    plain = extend(fmu, travel, {})
    rough = extend(fmu, travel, {**FRICTION, "airspeed": AIRSPEED})
    level = extend(fmu, travel, {"load_factor": 1.0})
    time, impulse = impact(fmu, travel, plain.duration)
    runs = [
        (plain, "-", BLUE, f"load factor {factor:g}"),
        (rough, "--", ORANGE, f"load factor {factor:g}, friction and air"),
        (level, "-.", GREEN, "load factor 1"),
    ]

    def draw(canvas: Canvas) -> None:
        angle, speed = canvas.subplots(2, 1, sharex=True)
        for run, style, color, label in runs:
            angle.plot(run.time * 1e3, run.angle, style, color=color, label=label)
            speed.plot(run.time * 1e3, run.speed, style, color=color)
        angle.set(ylabel="crank angle [rad]")
        angle.legend(loc="upper left")
        speed.set(xlabel="time [ms]", ylabel="crank speed [rad/s]", ylim=(0.0, None))
        canvas.align_ylabels()

    together = bound(abs(time - plain.duration) / time)
    caption = (
        "Paper: a study of the rigid model gives the time of extension; no numbers. Ours: from rest with the gear up, "
        f"the actuator pulls with {PULL * 1e-3:g} kN (the project's), without friction and air. At load factor "
        f"{factor:g} the gear is down after {time:.6f} s with {plain.speed[-1]:.3f} rad/s. It hits the stop with an "
        f"impulse of {impulse:.1f} N m s about the crank's pivot. `downstop.impact_time` agrees with the motion "
        f"without the stop within {together}. With friction and air of {AIRSPEED:g} m/s the extension takes "
        f"{rough.duration:.6f} s, and at load factor 1 {level.duration:.6f} s."
    )
    claim = Claim(
        "[HF08] section 5",
        f"time of extension ({PULL * 1e-3:g} kN pull, {factor:g} g, no air, no friction)",
        "not said",
        f"impact at {time:.6f} s",
        "force chosen by the project",
    )
    title = "[HF08] section 5: extension of the gear"
    values = {"time": time, "interpolated": plain.duration, "impulse": impulse, "speed": plain.speed[-1]}
    return Section("[HF08] extension", [Figure("hf08_extension", title, caption, draw, (6.4, 5.0))], [claim], values)
