"""The equation of motion in [HF08]'s appendix, as printed and as corrected, against the FMU."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure as Canvas

from .drawing import BLUE, CLOSED_FORM, FAINT
from .fmu import Fmu
from .four_bar import Complex, FourBar, moment
from .gear import FREE, Array, Travel, passing
from .hf08_loads import AXIS
from .page import Claim, Figure, Section, bound

POINTS = 85
"""Number of angles over the travel."""
STEPS = 500
"""Number of steps of the retraction by the appendix's equation: equal parts of the duration of the FMU's retraction."""
SPEED = -1.0
"""Crank speed at which ratios of speeds are read [rad/s]."""


@dataclass(frozen=True)
class Misprints:
    """Which formulas of the appendix are used as printed."""

    exponent: bool = False
    """a^(3/2) instead of a^3 in both derivatives of angles."""
    sign: bool = False
    """Plus instead of minus before the last term of the derivative of Theta_4."""
    coupler: bool = False
    """T_3g with cos(chi) instead of cos(Theta_2 + chi)."""
    wheel: bool = False
    """T_5g with half of the wheel's mass."""


PRINTED = Misprints(exponent=True, sign=True, coupler=True, wheel=True)
SINGLE = {
    "a^(3/2) for a³": Misprints(exponent=True),
    "the sign in ∂θ₄/∂θ₂": Misprints(sign=True),
    "χ for Θ₂ + χ in T₃g": Misprints(coupler=True),
    "half of the wheel's mass in T₅g": Misprints(wheel=True),
}
"""Each misprint alone, with its description."""


@dataclass(frozen=True)
class Appendix:
    """The equation with the data of the gear; `angle` is that of the crank [rad]."""

    linkage: FourBar
    attachments: tuple[complex, complex]
    """Attachments of the actuator on crank and follower in their frames [m]."""
    force: float
    gravity: float
    """Acceleration of gravity times the load factor [m/s²]."""
    chi: float
    psi: float
    leg: tuple[float, float, float]
    """Length of the leg l_5 [m], masses of the leg m_5 and of the wheel m_5k [kg]."""

    @classmethod
    def of(cls, fmu: Fmu) -> Appendix:
        """The equation with the values of the gear's FMU."""
        ends = [complex(*(fmu.default(f"{body}.actuator_{axis}") for axis in "xy")) for body in ("crank", "follower")]
        return cls(
            FourBar.gear(fmu),
            (ends[0], ends[1]),
            fmu.default("actuator.force"),
            fmu.default("gravity.acceleration") * fmu.default("load_factor"),
            0.5 * np.pi - fmu.default("gravity.up_angle"),
            np.pi + fmu.default("leg.angle"),
            (fmu.default("leg.length"), fmu.default("leg.mass"), fmu.default("wheel.mass")),
        )

    def ratios(self, angle: Array, wrong: Misprints) -> tuple[Array, Array]:
        """Derivatives of Theta_3 and Theta_4 with respect to Theta_2."""
        l1, l2, l3, l4 = self.linkage.lengths
        square = l1**2 + l2**2 - 2.0 * l1 * l2 * np.cos(angle)
        power = square ** (0.75 if wrong.exponent else 1.5)
        third, fourth = square + l3**2 - l4**2, square - l3**2 + l4**2
        first = np.sin(angle) * l1 * l2 / (2.0 * power)
        last = (l1 * l2 * np.cos(angle) - l2**2) / square
        k3 = -first * fourth / (l3 * np.sqrt(1.0 - third**2 / (4.0 * square * l3**2))) - last
        k4 = first * third / (l4 * np.sqrt(1.0 - fourth**2 / (4.0 * square * l4**2)))
        return k3, k4 + last if wrong.sign else k4 - last

    def weights(self, angle: Array, wrong: Misprints) -> list[Array]:
        """T_2g, T_3g, T_4g and T_5g [N m]."""
        _, l2, l3, l4 = self.linkage.lengths
        crank, coupler, follower = (a[0] for a in self.linkage.angles(angle))
        m2, m3, m4 = (parts[0].mass for parts in self.linkage.masses)
        k3, k4 = self.ratios(angle, wrong)
        l5, m5, m5k = self.leg
        g, chi = self.gravity, self.chi
        first = np.cos(chi) if wrong.coupler else np.cos(crank + chi)
        return [
            0.5 * m2 * l2 * g * np.cos(crank + chi),
            m3 * g * (l2 * first + 0.5 * l3 * np.cos(coupler + chi) * k3),
            0.5 * m4 * g * l4 * np.cos(follower + chi) * k4,
            (0.5 * m5 + (0.5 if wrong.wheel else 1.0) * m5k) * g * l5 * np.cos(crank + self.psi + chi),
        ]

    def torques(self, angle: Array) -> tuple[Array, Array]:
        """T_1 on the crank and T_2 on the follower by the actuator [N m]."""
        crank, _, follower = (a[0] for a in self.linkage.angles(angle))
        return self.torques_of(np.exp(1j * crank), np.exp(1j * follower))

    def torques_of(self, crank: Complex, follower: Complex) -> tuple[Array, Array]:
        """T_1 and T_2 where the x axes of crank and follower have these directions."""
        first, second = self.attachments[0] * crank, self.attachments[1] * follower
        apart = first - (self.linkage.lengths[0] + second)
        push = self.force * apart / abs(apart)
        return moment(first, push), moment(second, -push)

    def acceleration(self, angle: Array, speed: Array, wrong: Misprints) -> Array:
        """epsilon of M epsilon = Q + C omega^2, multiplied by rho A_3 l_2^2 / 3; kappa_i = l_i k_i / l_2, and alpha_3,
        alpha_4 and Omega_3 the parts of the angular accelerations and the speed that omega causes.
        """
        _, l2, l3, l4 = self.linkage.lengths
        m2, m3, m4 = (parts[0].mass for parts in self.linkage.masses)
        l5, m5, m5k = self.leg
        k3, k4 = self.ratios(angle, wrong)
        step = 1e-5
        ahead, behind = (self.ratios(angle + side * step, wrong) for side in (1.0, -1.0))
        a3, a4 = ((after - before) / (2.0 * step) * speed**2 for after, before in zip(ahead, behind, strict=True))
        crank, coupler, _ = (a[0] for a in self.linkage.angles(angle))
        cosine, sine = np.cos(crank - coupler), np.sin(crank - coupler)
        t1, t2 = self.torques(angle)
        t2g, t3g, t4g, t5g = self.weights(angle, wrong)
        inertia = (m2 * l2**2 + m4 * l4**2 * k4**2 + (m5 + 3.0 * m5k) * l5**2) / 3.0
        inertia = inertia + m3 * (l2**2 + l3**2 * k3**2 / 3.0 + l2 * l3 * k3 * cosine)
        free = t1 + t2 * k4 - t2g - t3g - t4g + t5g - (m4 * l4**2 * k4 * a4 + m3 * l3**2 * k3 * a3) / 3.0
        free = free - 0.5 * m3 * l2 * l3 * (a3 * cosine + (k3 * speed) ** 2 * sine)
        return (free + 0.5 * m3 * l2 * l3 * k3 * sine * speed**2) / inertia

    def duration(self, travel: Travel, about: float, wrong: Misprints) -> float:
        """Duration of retraction [s] from rest, by the Runge-Kutta method of order 4 with equal parts of the time
        `about`."""
        h = about / STEPS

        def rates(state: Array) -> Array:
            return np.array([state[1], self.acceleration(state[0], state[1], wrong)])

        state, time = np.array([travel.down, 0.0]), 0.0
        while True:
            k1 = rates(state)
            k2 = rates(state + 0.5 * h * k1)
            k3 = rates(state + 0.5 * h * k2)
            k4 = rates(state + h * k3)
            after = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            if not after[0] > travel.up:
                rows = [[t, *place, float(rates(place)[1])] for t, place in ((time, state), (time + h, after))]
                return passing(rows[0], rows[1], travel.up)[0]
            state, time = after, time + h


def measure(gear: Fmu, extension: Fmu, angles: Array) -> dict[str, Array]:
    """Derivatives of Theta_3 and Theta_4, T_3g [N m] and the acceleration of the crank from rest, by the FMUs.

    The load reduced to the crank is the load reduced to the actuator times the ratio of actuator and crank speed.
    """
    start = {"crank.start_speed": SPEED}
    weighed = {"load_factor": gear.default("load_factor"), "airspeed": 0.0, "friction.enabled": False}
    rows = []
    for angle in angles.tolist():
        gear.start({**FREE, **start, "crank.start_angle": angle})
        speeds = [value / SPEED for value in gear.read("coupler.speed", "follower.speed")]
        gear.start({**FREE, "crank.start_angle": angle})
        acceleration = gear.value("crank.acceleration")
        extension.start({**FREE, **start, **weighed, "oil.damping": 0.0, "crank.start_angle": angle})
        load, speed = extension.read("actuator.coupler.static_load", "actuator.speed")
        rows.append([*speeds, load * speed / SPEED, acceleration])
    k3, k4, weight, acceleration = np.array(rows).T
    return {"k3": k3, "k4": k4, "weight": weight, "acceleration": acceleration}


def section(gear: Fmu, extension: Fmu, travel: Travel, duration: float) -> Section:
    """The figure; `duration` is that of the FMU's retraction [s]."""
    appendix, right = Appendix.of(gear), Misprints()
    angles = np.linspace(travel.down, travel.up, POINTS)
    run = measure(gear, extension, angles)

    def quantities(wrong: Misprints) -> dict[str, Array]:
        k3, k4 = appendix.ratios(angles, wrong)
        acceleration = appendix.acceleration(angles, 0.0 * angles, wrong)
        return {"k3": k3, "k4": k4, "weight": appendix.weights(angles, wrong)[1], "acceleration": acceleration}

    corrected, printed = quantities(right), quantities(PRINTED)
    errors = [float(np.abs(run[name] - corrected[name]).max() / np.abs(run[name]).max()) for name in run]
    own = appendix.duration(travel, duration, right)
    times = {words: appendix.duration(travel, duration, wrong) for words, wrong in SINGLE.items()}
    whole = appendix.duration(travel, duration, PRINTED)
    drawn = [("k4", "$∂θ_4/∂θ_2$ [1]"), ("weight", "$T_{3g}$ [N m]"), ("acceleration", "$ε$ from rest [rad/s²]")]
    rotation = travel.rotation(angles)

    def draw(canvas: Canvas) -> None:
        panels = canvas.subplots(len(drawn), 1, sharex=True)
        for axes, (name, label) in zip(panels, drawn, strict=True):
            axes.axhline(0.0, color="0.4", linewidth=0.8)
            axes.plot(rotation, run[name], color=BLUE, linewidth=3.2, label="FMU")
            axes.plot(rotation, corrected[name], **CLOSED_FORM, label="appendix, corrected")
            axes.plot(rotation, printed[name], "--", **FAINT, label="appendix, as printed")
            axes.set(ylabel=label)
        panels[-1].set_xlabel(AXIS)
        canvas.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
        canvas.align_ylabels()

    def change(time: float) -> str:
        return f"{time:.6f} s ({100.0 * (time / duration - 1.0):+.2f} %)"

    singles = ", ".join(f"{words} {change(time)}" for words, time in times.items())
    caption = (
        "Paper: M ε = Q + C ω² in the crank angle, with formulas for all terms but κ, α and Ω₃. Ours: κᵢ = lᵢ kᵢ / l₂ "
        "with kᵢ = ∂θᵢ/∂θ₂. α₃ and α₄ are the parts of the angular accelerations that ω causes, Ω₃ is the coupler's "
        "speed, and g is multiplied by the load factor. Four places are corrected. The last term of ∂θ₄/∂θ₂ has a "
        "minus. Both derivatives have a³ for a^(3/2). T₃g has cos(Θ₂ + χ) for cos χ. T₅g has the whole mass of the "
        "wheel, as M has. The corrected formulas for ∂θ₃/∂θ₂, ∂θ₄/∂θ₂, T₃g and ε agree with the FMUs within "
        f"{bound(errors)}; T₃g is compared with `actuator.coupler.static_load`. The corrected equation retracts the "
        f"gear in {own:.8f} s, the printed one in {change(whole)}. With one misprint alone the times are: {singles}."
    )
    claim = Claim(
        "[HF08] appendix",
        "equation of motion in the crank angle: time of retraction",
        "about 0.132 s",
        f"corrected {own:.8f} s, as printed {whole:.6f} s",
        "four misprints corrected",
    )
    title = "[HF08] appendix: equation of motion, as printed and corrected"
    values = {"formulas": max(errors), "corrected": own, "printed": whole}
    return Section("[HF08] appendix", [Figure("hf08_appendix", title, caption, draw, (6.4, 6.6))], [claim], values)
