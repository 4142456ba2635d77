"""[CK16]'s superposition over the bodies, and its ratios, eqs. (1), (2), (22), (23), by outputs of the key `by_body`.

Two mechanisms: the landing gear with its linear actuator, and a four-bar linkage with a rotary drive as in figure 3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from .curves import CLOSED
from .drawing import BLUE, CLOSED_FORM, GREEN, ORANGE
from .fmu import Fmu, Value
from .four_bar import FourBar, Mass
from .gear import FREE, Array, Travel
from .hf08_appendix import Appendix
from .hf08_loads import AXIS
from .page import Claim, Figure, Section, bound

POINTS = 85
"""Number of angles over the travel of the gear."""
COAST_STEP = 5e-3
"""Time between the sampled angles of the crank of the four-bar linkage [s]."""
STYLES = (("-", BLUE), ("--", ORANGE), ("-.", GREEN))
FAR = 1e3
"""Larger ratios are not drawn: the ratio is infinite where a body does not rotate."""
PARTS = {
    False: ("reduced_mass", "static_load", "ratio", "effective_radius"),
    True: ("reduced_inertia", "static_load", "effective_radius", "ratio"),
}
"""Suffixes of reduced mass, static load, ratio with the speed of the centre of mass, ratio with the angular speed; by
whether the drive is rotary."""


@dataclass(frozen=True)
class Bodies:
    """Quantities of each body over the positions: by the FMU, and in closed form."""

    names: tuple[str, ...]
    ours: Array
    """The four PARTS of each body."""
    closed: Array
    whole: Array
    """Reduced mass and static load of the mechanism."""

    @property
    def superposition(self) -> float:
        """Largest difference between the sums over bodies and the mechanism's values, relative to the largest part."""
        parts = self.ours[:, :2]
        return float((np.abs(parts.sum(axis=0) - self.whole).max(axis=1) / np.abs(parts).max(axis=(0, 2))).max())

    @property
    def error(self) -> float:
        """Largest difference from the closed form relative to its largest value; of ratios, that of the inverse."""
        ours, closed = (np.concatenate([rows[:, :2], 1.0 / rows[:, 2:]], axis=1) for rows in (self.ours, self.closed))
        return float((np.abs(ours - closed).max(axis=2) / np.abs(closed).max(axis=2)).max())


def measured(fmu: Fmu, drive: str, names: tuple[str, ...], places: Iterator[None]) -> tuple[Array, Array, Array]:
    """Quantities of bodies and mechanism, angle and speed of the crank, at the positions of the FMU's run."""
    parts = PARTS[fmu.has(f"{drive}.reduced_inertia")]
    rows, sums, motion = [], [], []
    for _ in places:
        rows.append([fmu.read(*(f"{drive}.{name}.{part}" for part in parts)) for name in names])
        sums.append(fmu.read(*(f"{drive}.{part}" for part in parts[:2])))
        motion.append(fmu.read("crank.angle", "crank.speed"))
    return np.moveaxis(np.array(rows), 0, 2), np.array(sums).T, np.array(motion).T


def at_rest(fmu: Fmu, angles: Array, values: dict[str, Value]) -> Iterator[None]:
    """Positions with the crank at rest at these angles."""
    for angle in angles.tolist():
        yield fmu.start({**values, "crank.start_angle": angle}) and None


def coasting(fmu: Fmu) -> Iterator[None]:
    """A turn of the crank from the start speed, without torque; weights act only while outputs are read."""
    fmu.start({"drive.torque": 0.0, "load_factor": 0.0})
    start = fmu.value("crank.angle")
    while fmu.value("crank.angle") < start + 2.0 * np.pi:
        fmu.set({"load_factor": fmu.default("load_factor")})
        yield
        fmu.set({"load_factor": 0.0})
        fmu.step(COAST_STEP)


def closed_form(linkage: FourBar, angles: Array, slope: Array, gravity: complex, is_rotary: bool) -> Array:
    """The same quantities in closed form; `slope`: derivative of the drive's displacement with respect to the crank
    angle."""
    found = []
    for mass, center, angle in linkage.centers(angles):
        inertia = mass.mass * np.abs(center[1]) ** 2 + mass.inertia * angle[1] ** 2
        load = -mass.mass * (gravity.conjugate() * center[1]).real
        by_center = np.abs(center[1]) / np.abs(slope)
        found.append([inertia / slope**2, load / slope, by_center if is_rotary else 1.0 / by_center, slope / angle[1]])
    return np.array(found)


def gravity(fmu: Fmu, factor: float) -> complex:
    """Acceleration of gravity in the mechanism frame [m/s²]."""
    acceleration, up = fmu.read("gravity.acceleration", "gravity.up_angle")
    return -factor * acceleration * complex(np.exp(1j * up))


def gear_bodies(gear: Fmu, extension: Fmu, angles: Array) -> Bodies:
    """Quantities of the gear, with the weights alone at the load factor of the retraction."""
    names, factor = ("crank", "coupler", "follower"), gear.default("load_factor")
    start = {**FREE, "load_factor": factor, "airspeed": 0.0, "friction.enabled": False}
    ours, whole, _ = measured(extension, "actuator", names, at_rest(extension, angles, start))
    appendix = Appendix.of(gear)
    # Virtual work of the actuator's force.
    t1, t2 = appendix.torques(angles)
    slope = (t1 + t2 * appendix.linkage.angles(angles)[2][1]) / appendix.force
    return Bodies(names, ours, closed_form(appendix.linkage, angles, slope, gravity(extension, factor), False), whole)


def family_bodies(fmu: Fmu) -> tuple[Array, Bodies]:
    """The four-bar linkage over a turn of its crank: ascending angles from 0 to 2 pi, and quantities of its bodies."""
    names = ("crank", "coupler", "rocker")
    size, density, ratio = (fmu.default(name) for name in ("size", "line_density", "load_ratio"))
    lengths = (size, size / 3.0, 7.0 / 6.0 * size, 5.0 / 6.0 * size)
    rods = [[Mass(density * length, 0.5 * length, density * length**3 / 12.0)] for length in lengths[1:]]
    rods[1].append(Mass(ratio * rods[1][0].mass, complex(0.5 * lengths[2], 0.2 * size), 0.0))
    linkage = FourBar(lengths, (rods[0], rods[1], rods[2]))
    ours, whole, (angle, speed) = measured(fmu, "drive", names, coasting(fmu))
    closed = closed_form(linkage, angle, np.ones_like(angle), gravity(fmu, fmu.default("load_factor")), True)
    # The damper acts between ground and crank.
    closed[0, 1] += 0.02 * rods[1][1].mass * size**2 * speed
    turn = angle % (2.0 * np.pi)
    order = np.argsort(turn)
    return turn[order], Bodies(names, ours[..., order], closed[..., order], whole[..., order])


def broken(values: Array) -> Array:
    """Values with a gap at each pole, where they change their sign between large values."""
    steps = np.abs(np.diff(values)) > np.median(np.abs(values))
    jumps = np.flatnonzero((values[1:] * values[:-1] < 0.0) & steps)
    kept = np.where(np.abs(values) < FAR, values, np.nan)
    kept[jumps] = np.nan
    return kept


def plot(axes: Axes, places: Array, bodies: Bodies, part: int, chosen: slice = slice(None)) -> None:
    """One quantity of each body, with the closed form as a thin line."""
    rows = zip(bodies.names, bodies.ours[:, part], bodies.closed[:, part], STYLES, strict=True)
    for name, ours, closed, (style, color) in list(rows)[chosen]:
        show = broken if part >= 2 else np.array
        axes.plot(places, show(ours), style, color=color, linewidth=2.6, label=name)
        (thin,) = axes.plot(places, show(closed), **CLOSED_FORM)
    thin.set_label(CLOSED)


def finish(canvas: Canvas, panels: list[Axes], across: str, places: Array) -> None:
    """Labels, and one legend above all panels."""
    panels[-1].set(xlabel=across, xlim=(places[0], places[-1]))
    handles, labels = panels[0].get_legend_handles_labels()
    canvas.legend(handles, labels, loc="outside upper center", ncols=5, handlelength=3.2)
    canvas.align_ylabels()


def superposition(bodies: Bodies, rotation: Array, factor: float) -> Figure:
    """Reduced mass and static load of the gear, body by body."""
    masses, loads = bodies.ours[:, 0], bodies.ours[:, 1] * 1e-3

    def draw(canvas: Canvas) -> None:
        panels = list(canvas.subplots(3, 1, sharex=True))
        for part, axes in enumerate(panels[:2]):
            axes.plot(rotation, bodies.whole[part], color="0.7", linewidth=6.0, label="whole gear")
        plot(panels[0], rotation, bodies, 0)
        plot(panels[1], rotation, bodies, 1, slice(1))
        plot(panels[2], rotation, bodies, 1, slice(1, None))
        panels[0].set(ylabel="reduced mass [kg]", yscale="log")
        for axes, of in zip(panels[1:], ("crank", "others"), strict=True):
            axes.axhline(0.0, color="0.4", linewidth=0.8, zorder=0)
            axes.set(ylabel=f"static load, {of} [N]")
        finish(canvas, panels, AXIS, rotation)

    def span(values: Array, digits: int) -> str:
        return f"{values.min():.{digits}f} to {values.max():.{digits}f}"

    caption = (
        "Paper: load and mass of each element are reduced to the drive separately and then summed up; no example. "
        "Ours: the gear by `actuator.crank.reduced_mass`, `actuator.crank.static_load` and so on, which are outputs of "
        f"a drive with the key `by_body`. The weights act at load factor {factor:g}, without air and friction. Leg and "
        f"wheel belong to the crank. The reduced masses are {span(masses[0], 0)} kg (crank), {span(masses[1], 3)} kg "
        f"(coupler) and {span(masses[2], 3)} kg (follower). The static loads are {span(loads[0], 3)} kN, "
        f"{span(loads[1], 3)} kN and {span(loads[2], 3)} kN. The sums agree with `actuator.reduced_mass` and "
        f"`actuator.static_load` within {bound(bodies.superposition)}. Thin lines: closed forms, met within "
        f"{bound(bodies.error)}."
    )
    title = "[CK16] conclusion 3: the bodies of the gear superposed"
    return Figure("ck16_superposition", title, caption, draw, (6.4, 6.6))


def ratios(
    name: str, title: str, caption: str, across: str, places: Array, bodies: Bodies, labels: list[str]
) -> Figure:
    """The two ratios of each body, drawn up to six times the median."""

    def draw(canvas: Canvas) -> None:
        panels = list(canvas.subplots(2, 1, sharex=True))
        for part, (axes, label) in enumerate(zip(panels, labels, strict=True), start=2):
            plot(axes, places, bodies, part)
            largest = 6.0 * float(np.median(np.abs(bodies.ours[:, part])))
            low, high = axes.get_ylim()
            bottom = 0.0 if (bodies.ours[:, part] >= 0.0).all() else max(low, -largest)
            axes.set(ylabel=label, ylim=(bottom, min(high, largest)))
            axes.axhline(0.0, color="0.4", linewidth=0.8, zorder=0)
        finish(canvas, panels, across, places)

    return Figure(name, title, caption, draw, (6.4, 5.4))


def section(gear: Fmu, extension: Fmu, family: Fmu, travel: Travel) -> Section:
    """All three figures."""
    angles = np.linspace(travel.down, travel.up, POINTS)
    rotation, of_gear = travel.rotation(angles), gear_bodies(gear, extension, angles)
    turn, of_family = family_bodies(family)
    whole = bound([of_gear.superposition, of_family.superposition])
    closed = bound([of_gear.error, of_family.error])
    crank = of_gear.ours[0]
    linear = (
        "Paper: eqs. (22), (23), R_e = v_S / ω_C and i_v = v_S / v_C between the linear motor and any element; no "
        "example with several. Ours: `actuator.crank.ratio` and `actuator.crank.effective_radius` and so on, C the "
        f"centre of mass. For crank with leg and wheel i_v is {crank[2].min():.3f} to {crank[2].max():.3f} and R_e "
        f"{crank[3].min() * 1e3:.1f} to {crank[3].max() * 1e3:.1f} mm (negative: the actuator gets longer as the crank "
        f"turns clockwise). Where a body does not turn, R_e is infinite. Thin lines: closed forms, met within {closed}."
    )
    arm, turns = of_family.ours[1][2], of_family.ours[1][3]
    rotary = (
        "Paper: eqs. (1), (2), R_z = v_C / ω_S and i_m = ω_S / ω_C for the four-bar linkage of figure 3, whose sizes "
        "stood in a lost figure. Ours: the example FourBarFamily over a turn of its crank, `drive.coupler."
        f"effective_radius` and `drive.coupler.ratio` and so on. R_z of the coupler with its load is "
        f"{arm.min() * 1e3:.2f} to {arm.max() * 1e3:.2f} mm; the least |i_m| of the coupler is "
        f"{np.abs(turns).min():.3f}. Where coupler or rocker does not turn, i_m is infinite and changes its sign. Thin "
        f"lines: closed forms, met within {closed}."
    )
    figures = [
        superposition(of_gear, rotation, gear.default("load_factor")),
        ratios(
            "ck16_linear_ratios",
            "[CK16] (22), (23): ratio and effective radius of each body, linear drive",
            linear,
            AXIS,
            rotation,
            of_gear,
            ["$i_v$ [1]", "$R_e$ [m]"],
        ),
        ratios(
            "ck16_rotary_ratios",
            "[CK16] (1), (2): effective radius and ratio of each body, rotary drive",
            rotary,
            "crank angle [deg]",
            np.degrees(turn),
            of_family,
            ["$R_z$ [m]", "$i_m$ [1]"],
        ),
    ]
    claims = [
        Claim(
            "[CK16] conclusion 3",
            "superposition: reduced masses and loads of the elements add up",
            "statement",
            f"sums met within {whole}",
            "landing gear and four-bar linkage, key `by_body`",
        ),
        Claim(
            "[CK16] (1), (2), (22), (23)",
            "R_z, i_m, R_e and i_v of each body",
            "definitions",
            f"closed forms met within {closed}",
        ),
    ]
    values = {
        "superposition": max(of_gear.superposition, of_family.superposition),
        "closed": max(of_gear.error, of_family.error),
    }
    return Section("[CK16] superposition", figures, claims, values)
