"""[HF08] figures 6 and 7: the crank's angle and speed during retraction, by the reduced model and by rigid elements."""

from __future__ import annotations

import numpy as np

from .drawing import BLUE, ORANGE, lines
from .fmu import Fmu
from .gear import METHOD, RIGID_FEM, Motion, Travel, retract
from .page import Claim, Figure, Section

MISSING = f"this FMU has no `{METHOD}` yet, so the curve by rigid finite elements is left out"


def curve(name: str, title: str, label: str, quantity: str, runs: dict[str, Motion], caption: str) -> Figure:
    """One quantity over time, one line per method."""
    styles = zip(runs.items(), (("-", BLUE), ("--", ORANGE)), strict=False)
    curves = [(run.time * 1e3, getattr(run, quantity), *style, method) for (method, run), style in styles]
    return Figure(f"hf08_{name}", f"[HF08] figure {title}", caption, lines("time [ms]", label, curves))


def section(fmu: Fmu, travel: Travel) -> Section:
    """Both figures."""
    reduced = retract(fmu, travel, {})
    runs = {"reduced model": reduced}
    values = {"retraction_time": reduced.duration, "angle": reduced.angle[0] - reduced.angle[-1]}
    if fmu.has(METHOD):
        fem = retract(fmu, travel, {METHOD: RIGID_FEM})
        runs["rigid finite elements"] = fem
        common = min(len(fem.time), len(reduced.time)) - 1
        apart = {
            q: float(np.abs(getattr(fem, q)[:common] - getattr(reduced, q)[:common]).max()) for q in ("angle", "speed")
        }
        values |= {"fem_time": fem.duration, "fem_angle": apart["angle"], "fem_speed": apart["speed"]}
        second = (
            f"dashed: rigid finite elements (`{METHOD}` = `{RIGID_FEM}`), up after {fem.duration:.6f} s; at most "
            f"{apart['angle']:.1e} rad and {apart['speed']:.1e} rad/s from the reduced model"
        )
        compared = f"{apart['angle']:.1e} rad, {apart['speed']:.1e} rad/s, {fem.duration - reduced.duration:+.1e} s"
    else:
        second = compared = MISSING
    conditions = (
        f"F = {fmu.default('actuator.force') * 1e-3:g} kN constant, load factor {fmu.default('load_factor'):g}, no "
        "air, no friction, from rest"
    )
    angle = (
        f"Paper: about 0.132 s and about 2.1 rad; finite elements and ADAMS drawn over each other. Ours: {conditions}; "
        f"from {reduced.angle[0]:g} to {reduced.angle[-1]:g} rad = {values['angle']:.4f} rad = {travel.degrees:.2f} "
        f"deg in {reduced.duration:.8f} s by the reduced model; {second}."
    )
    speed = (
        f"Paper: as figure 6, no numbers in the text. Ours: as figure 6; {reduced.speed[-1]:.4f} rad/s when the gear "
        f"is up, where it is fastest; {second}."
    )
    if np.abs(reduced.speed).max() > abs(reduced.speed[-1]):
        fastest = int(np.argmax(np.abs(reduced.speed)))
        speed = speed.replace(
            "where it is fastest",
            f"{reduced.speed[fastest]:.4f} rad/s at its fastest, after {reduced.time[fastest] * 1e3:.1f} ms",
        )
    figures = [
        curve("06_crank_angle", "6: angle of the crank", "crank angle [rad]", "angle", runs, angle),
        curve("07_crank_speed", "7: angular speed of the crank", "crank speed [rad/s]", "speed", runs, speed),
    ]
    claims = [
        Claim(
            "[HF08] section 3",
            "time of retraction (30 kN, 3 g, no air)",
            "about 0.132 s",
            f"{reduced.duration:.8f} s",
            "arms of the actuator chosen so that it comes out",
        ),
        Claim(
            "[HF08] sections 2, 3",
            "angle of retraction",
            "about 2.1 rad; 120 deg",
            f"{values['angle']:.4f} rad; {travel.degrees:.2f} deg",
            "ends of the travel are the project's",
        ),
        Claim(
            "[HF08] figures 6, 7",
            "finite elements with rigid links against a multibody method: largest distance in angle, speed, time",
            '"very close"',
            compared,
            "ours: against the reduced model",
        ),
    ]
    return Section("[HF08] motion", figures, claims, values)
