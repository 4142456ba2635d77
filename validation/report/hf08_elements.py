"""[HF08]'s finite elements with rigid links as printed: eqs. (18)-(25) by Newmark's method, without an FMU."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from .drawing import BLUE, ORANGE, Line, lines
from .fmu import Fmu
from .four_bar import BODIES, FourBar, moment
from .gear import METHOD, RIGID_FEM, STEP, Array, Travel, retract
from .hf08_appendix import Appendix
from .page import Claim, Figure, Section

SUBSTEPS = 5
"""Number of Newmark steps in each communication step."""
COARSE = 2e-4
"""A step of the size usual in papers [s]."""
INSTANT = 0.13
"""Time at which the angles are compared [s]."""
CONVERGED = 1e-14
"""Correction of positions at which the iterations of a step stop [m]."""


def block(along: float, across: float, direction: complex) -> Array:
    """A matrix with these values along and across a direction."""
    a, b = direction.real, direction.imag
    mixed = (along - across) * a * b
    return np.array([[along * a * a + across * b * b, mixed], [mixed, along * b * b + across * a * a]])


@dataclass(frozen=True)
class Elements:
    """Three elements between A, B, C and D; leg and wheel contribute an inertia and a torque on the crank."""

    linkage: FourBar
    appendix: Appendix
    stiffness: Array
    """E A of each element [N]."""

    @classmethod
    def gear(cls, fmu: Fmu) -> Elements:
        """The elements with the values of the gear's FMU."""
        return cls(FourBar.gear(fmu), Appendix.of(fmu), np.array([fmu.default(f"{b}.axial_stiffness") for b in BODIES]))

    def nodes(self, angle: float) -> Array:
        """Positions of B and C without stretch [m]."""
        _, l2, l3, _ = self.linkage.lengths
        crank, coupler, _ = (float(a[0]) for a in self.linkage.angles(np.array(angle)))
        b = l2 * np.exp(1j * crank)
        c = b + l3 * np.exp(1j * coupler)
        return np.array([b.real, b.imag, c.real, c.imag])

    def assembled(self, x: Array) -> tuple[Array, Array, Array, Array]:
        """Mass matrix, forces of the rods, their stiffness, and loads at these positions of the nodes B and C."""
        l1, *lengths = self.linkage.lengths
        b, c = complex(x[0], x[1]), complex(x[2], x[3])
        spans = [b, c - b, c - l1]
        along = [span / abs(span) for span in spans]
        masses = [parts[0].mass for parts in self.linkage.masses]
        l5, m5, m5k = self.appendix.leg
        # Leg and wheel turn with the transverse motion of B.
        turning = (m5 / 3.0 + m5k) * (l5 / lengths[0]) ** 2
        # Eqs. (19) and (18), rotated: the blocks of one end and of both ends of each element.
        own = [block(m / 4.0, m / 3.0, e) for m, e in zip(masses, along, strict=True)]
        own[0] += block(0.0, turning, along[0])
        both = block(masses[1] / 4.0, masses[1] / 6.0, along[1])
        rods = [block(ea / length, 0.0, e) for ea, length, e in zip(self.stiffness, lengths, along, strict=True)]
        pulls = [
            ea * (abs(span) / length - 1.0) * e
            for ea, span, length, e in zip(self.stiffness, spans, lengths, along, strict=True)
        ]
        weight = -self.appendix.gravity * cmath.exp(1j * (0.5 * math.pi - self.appendix.chi))
        leg = l5 * along[0] * cmath.exp(1j * (self.appendix.psi - math.pi))
        t1, t2 = self.appendix.torques_of(along[0], along[2])
        t1 += moment(leg, (0.5 * m5 + m5k) * weight)
        at_b = 0.5 * (masses[0] + masses[1]) * weight + t1 / abs(spans[0]) * 1j * along[0]
        at_c = 0.5 * (masses[1] + masses[2]) * weight + t2 / abs(spans[2]) * 1j * along[2]
        mass = np.block([[own[0] + own[1], both], [both, own[1] + own[2]]])
        stiffness = np.block([[rods[0] + rods[1], -rods[1]], [-rods[1], rods[1] + rods[2]]])
        forces = np.array([pulls[0] - pulls[1], pulls[1] + pulls[2]]).view(float)
        return mass, forces, stiffness, np.array([at_b, at_c]).view(float)

    def run(self, start: float, end: float, h: float) -> Array:
        """Angles of the crank [rad] at the times 0, h, ... to the end; from rest, without stretch at the start."""
        x, v = self.nodes(start), np.zeros(4)
        mass, forces, _, loads = self.assembled(x)
        a = np.linalg.solve(mass, loads - forces)
        found = [start]
        for _ in range(round(end / h)):
            before, after = x + h * v + 0.25 * h * h * a, a.copy()
            while True:
                mass, forces, stiffness, loads = self.assembled(before + 0.25 * h * h * after)
                correction = np.linalg.solve(mass + 0.25 * h * h * stiffness, loads - forces - mass @ after)
                after += correction
                if 0.25 * h * h * np.abs(correction).max() < CONVERGED:
                    break
            x, v, a = before + 0.25 * h * h * after, v + 0.5 * h * (a + after), after
            found.append(float(np.arctan2(x[1], x[0])))
        return np.array(found)


def section(fmu: Fmu, travel: Travel) -> Section:
    """The figure."""
    elements = Elements.gear(fmu)
    reduced, own = (retract(fmu, travel, values) for values in ({}, {METHOD: RIGID_FEM}))
    count = round(INSTANT / STEP)
    fine = elements.run(travel.down, INSTANT, STEP / SUBSTEPS)[::SUBSTEPS] - reduced.angle[: count + 1]
    finer = elements.run(travel.down, INSTANT, STEP / (2 * SUBSTEPS))[-1] - reduced.angle[count]
    coarse = elements.run(travel.down, INSTANT, COARSE)[-1] - reduced.angle[count]
    exact = own.angle[: count + 1] - reduced.angle[: count + 1]
    time = reduced.time[: count + 1] * 1e3
    curves: list[Line] = [
        (time, exact * 1e6, "--", ORANGE, f"FMU, {METHOD} = {RIGID_FEM}"),
        (time, fine * 1e6, "-", BLUE, "the paper's elements, literally"),
    ]
    caption = (
        "Paper: eqs. (18), (19), turned by eqs. (23), (24), and the 4 x 4 matrices of eq. (25), solved by Newmark's "
        "method. Ours: the report computes these equations itself, without the FMU. Half of a rod's weight acts at "
        "each end of the rod. Leg and wheel are an inertia and a torque of the crank. T₁ and T₂ act as forces across "
        "crank and follower. The rods start without stretch, and each step is iterated until it converges. With steps "
        f"of {STEP / SUBSTEPS * 1e6:g} µs the crank angle after {INSTANT:g} s is {fine[-1]:.1e} rad from that of rigid "
        f"links. The distance is {finer:.1e} rad with half of the step, and {coarse:.1e} rad with steps of "
        f"{COARSE * 1e3:g} ms. The FMU with `{RIGID_FEM}` is {exact[-1]:.1e} rad away. Its rods also carry forces that "
        "eq. (25) leaves out: the pull of leg and wheel along the crank, and the force by the rotation of M. The small "
        "waves are vibrations of the rods after the sudden start."
    )
    claim = Claim(
        "[HF08] (18)-(25)",
        f"finite elements taken literally, crank angle after {INSTANT:g} s against rigid links",
        '"very close"',
        f"{fine[-1]:.1e} rad",
        f"{coarse:.1e} rad with steps of {COARSE * 1e3:g} ms",
    )
    title = "[HF08] (18)-(25): finite elements taken literally"
    draw = lines("time [ms]", "crank angle less that of rigid links [µrad]", curves, zero=True)
    values = {"literal": float(fine[-1]), "finer": float(finer), "coarse": float(coarse), "exact": float(exact[-1])}
    return Section("[HF08] finite elements", [Figure("hf08_elements", title, caption, draw)], [claim], values)
