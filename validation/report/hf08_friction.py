"""[HF08] figures 8 to 11: the coefficient of friction, and the retraction with and without friction."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, CLOSED_FORM, ORANGE, lines
from .fmu import Fmu
from .gear import AIRSPEED, Array, Motion, Travel, retract
from .page import Claim, Figure, Section, bound

FRICTION = {"friction.enabled": True}
AIR = {"airspeed": AIRSPEED}
JOINT = "joint1"
"""Joint between ground and crank; its slip is proportional to the crank's speed."""
SLIPS = (0.002, 0.005, 0.01, 0.015, 0.03, *(0.01 * share for share in range(10, 121, 10)))
"""Slip speeds at which the coefficient is read from the FMU, relative to V_d."""


def law(fmu: Fmu, speed: Array) -> Array:
    """mu over slip speed [m/s] as [HF08] section 4 describes it, with a cubic step between V_S and V_d."""
    low, high = fmu.default("friction.static_coefficient"), fmu.default("friction.kinetic_coefficient")
    first, last = fmu.default("friction.static_speed"), fmu.default("friction.kinetic_speed")
    s = np.clip((speed - first) / (last - first), 0.0, 1.0)
    return np.where(speed < first, low * speed / first, low + (3.0 * s**2 - 2.0 * s**3) * (high - low))


def measured(fmu: Fmu, travel: Travel) -> tuple[Array, Array]:
    """Slip speed [m/s], and torque over reaction and radius, of JOINT in the middle of the travel."""
    radius, last = fmu.default(f"{JOINT}.pin_radius"), fmu.default("friction.kinetic_speed")
    rows = []
    for share in SLIPS:
        speed = share * last / radius
        start = {"crank.start_angle": 0.5 * (travel.down + travel.up), "crank.start_speed": -speed}
        fmu.start({**FRICTION, **start})
        torque, force, slip = fmu.read(f"{JOINT}.friction_torque", f"{JOINT}.force", "crank.speed")
        rows.append([abs(slip) * radius, torque / (force * radius)])
    return np.array(rows).T[0], np.array(rows).T[1]


def coefficient(fmu: Fmu, travel: Travel, plain: Motion) -> tuple[Figure, dict[str, float]]:
    """Figure 8."""
    slip, mu = measured(fmu, travel)
    error = float(np.abs(mu - law(fmu, slip)).max())
    first, last = fmu.default("friction.static_speed"), fmu.default("friction.kinetic_speed")
    low, high = fmu.default("friction.static_coefficient"), fmu.default("friction.kinetic_coefficient")
    fastest = float(np.abs(plain.speed).max()) * fmu.default(f"{JOINT}.pin_radius")

    speeds = np.unique(np.concatenate([np.linspace(0.0, 3.5 * first, 15), np.linspace(first, 1.2 * last, 200)]))
    wanted = law(fmu, speeds)

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(speeds, wanted, **CLOSED_FORM, label="law")
        axes.plot(slip, mu, "o", color=BLUE, markersize=5, label="from the FMU's torque and reaction")
        ramp = axes.inset_axes((0.63, 0.44, 0.34, 0.3))
        ramp.plot(speeds, wanted, **CLOSED_FORM)
        ramp.plot(slip, mu, "o", color=BLUE, markersize=4)
        ramp.set(
            xlim=(-0.05 * first, 3.2 * first), ylim=(0.0, 1.1 * low), xticks=(0.0, first, 2.0 * first, 3.0 * first)
        )
        ramp.set_title("around $V_S$", fontsize=8.5)
        ramp.tick_params(labelsize=7.5)
        axes.axvline(fastest, color="0.55", linestyle=":", linewidth=1.2)
        place = {"xytext": (-6, 0), "horizontalalignment": "right", "textcoords": "offset points"}
        axes.annotate(f"fastest slip in {JOINT}\nduring retraction", (fastest, 0.2 * low), fontsize=8.5, **place)
        axes.set(xlabel="slip speed [m/s]", ylabel="coefficient of friction [1]", ylim=(0.0, 1.1 * low))
        axes.set_xlim(-0.01 * last, 1.2 * last)
        axes.legend()

    caption = (
        "Paper: linear up to µ_S = 0.19 at V_S, a smooth passage to µ_d = 0.026 at V_d, constant above; V_S and V_d "
        f"are not in the text. Ours: V_S = {first:g} m/s, V_d = {last:g} m/s (parameters), the passage the cubic step "
        f"3 s² - 2 s³; points: `{JOINT}.friction_torque` / (`{JOINT}.force` × pin radius) in states of different crank "
        f"speed, within {bound(error)} of the law (thin line); µ at V_S {float(law(fmu, np.array([first]))[0]):g}, "
        f"above V_d {mu[-1]:.3f}. During the retraction {JOINT} never slips faster than {fastest:.3f} m/s without "
        "friction, so it never comes down to µ_d."
    )
    values = {"law": error, "static": low, "kinetic": high}
    return Figure(
        "hf08_08_friction_law", "[HF08] figure 8: coefficient of friction over slip speed", caption, draw
    ), values


def pair_2(fmu: Fmu, run: Motion) -> Array:
    """Magnitude of the acceleration of the centre of joint2, the crank's end [m/s2]."""
    return fmu.default("crank.length") * np.hypot(run.acceleration, run.speed**2)


def section(fmu: Fmu, travel: Travel, plain: Motion) -> Section:
    """All four figures; `plain` is the retraction without friction and air."""
    rough = retract(fmu, travel, FRICTION)
    windy, rough_windy = retract(fmu, travel, AIR), retract(fmu, travel, FRICTION | AIR)
    share = 100.0 * (rough.duration / plain.duration - 1.0)
    share_air = 100.0 * (rough_windy.duration / windy.duration - 1.0)
    conditions = (
        f"F = {fmu.default('actuator.force') * 1e-3:g} kN, load factor {fmu.default('load_factor'):g}, no air (as in "
        "figures 6 and 7; the text does not say for this one), from rest until the gear is up"
    )
    figure8, values = coefficient(fmu, travel, plain)

    def over_time(name: str, title: str, label: str, courses: tuple[Array, Array], caption: str) -> Figure:
        curves = [
            (rough.time * 1e3, courses[1], "-", ORANGE, "with friction"),
            (plain.time * 1e3, courses[0], "--", BLUE, "without friction"),
        ]
        return Figure(f"hf08_{name}", f"[HF08] figure {title}", caption, lines("time [ms]", label, curves))

    angle = (
        f"Paper: friction adds about 2 % to the time of retraction. Ours: {conditions}: {plain.duration:.8f} s without "
        f"and {rough.duration:.8f} s with friction, {share:+.2f} %. In air of {AIRSPEED:g} m/s: {windy.duration:.8f} s "
        f"and {rough_windy.duration:.8f} s, {share_air:+.2f} %."
    )
    speed = (
        f"Paper: no numbers in the text. Ours: as figure 9; the gear comes up at {plain.speed[-1]:.3f} rad/s without "
        f"and {rough.speed[-1]:.3f} rad/s with friction."
    )
    accelerations = pair_2(fmu, plain), pair_2(fmu, rough)
    ends = [(a[0], float(a.min()), a[-1]) for a in accelerations]
    acceleration = (
        "Paper: no numbers in the text, nor which component. Ours: as figure 9; size of the acceleration of B, the "
        "centre of kinematic pair 2, from the crank's speed ω and acceleration ε: l₂ (ε² + ω⁴)^½. Without friction "
        f"{ends[0][0]:.2f} m/s² at the start and {ends[0][2]:.2f} m/s² at the end; with friction {ends[1][0]:.2f} and "
        f"{ends[1][2]:.2f} m/s²: both start alike, because this friction is zero at rest, and with friction the "
        f"acceleration dips to {ends[1][1]:.2f} m/s² as the slip passes V_S. It swings at the end, where coupler and "
        "follower come near to being in line and the follower turns ever faster."
    )
    titles = (
        "9: angle of the crank with and without friction",
        "10: angular speed of the crank with and without friction",
    )
    angles, speeds = (plain.angle, rough.angle), (plain.speed, rough.speed)
    kinematic = "11: acceleration of kinematic pair 2"
    figures = [
        figure8,
        over_time("09_friction_angle", titles[0], "crank angle [rad]", angles, angle),
        over_time("10_friction_speed", titles[1], "crank speed [rad/s]", speeds, speed),
        over_time("11_pair_2_acceleration", kinematic, "acceleration of B [m/s²]", accelerations, acceleration),
    ]
    claims = [
        Claim(
            "[HF08] section 4",
            "friction lengthens the retraction",
            "about 2 %",
            f"{share:+.2f} % ({plain.duration:.8f} to {rough.duration:.8f} s)",
            "V_S and V_d chosen so that it comes out near",
        ),
        Claim(
            "[HF08] section 4",
            "the same in air of 70 m/s",
            "not said",
            f"{share_air:+.2f} % ({windy.duration:.8f} to {rough_windy.duration:.8f} s)",
        ),
        Claim(
            "[HF08] section 4",
            "coefficients 0.19 and 0.026; friction without a jump at zero speed",
            "0.19, 0.026",
            f"law met within {bound(values['law'])} by torque and reaction of {JOINT}",
            "so friction holds nothing at rest in a run; figure 12 takes µ_S there",
        ),
    ]
    values |= {"share": share, "share_air": share_air, "rough_time": rough.duration}
    values |= {"start": ends[0][0], "rough_start": ends[1][0]}
    return Section("[HF08] friction", figures, claims, values)
