"""A four-bar linkage A-B-C-D in closed form, with the coupler above the diagonal B-D, over the crank's angle.

Points are complex numbers in the mechanism frame: A is 0, D lies on the X axis. A function is an array [value, first,
second derivative] with respect to the crank angle. The module must not depend on results of an FMU.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .fmu import Fmu
from .gear import Array

Complex = NDArray[np.complex128]
BODIES = ("crank", "coupler", "follower")


@dataclass(frozen=True)
class Mass:
    """Part of a body: mass [kg], place in the body's frame [m], moment of inertia about the place [kg m²]."""

    mass: float
    place: complex
    inertia: float

    @classmethod
    def rod(cls, fmu: Fmu, body: str, angle: float = 0.0) -> Mass:
        """A uniform rod from the origin of the frame at this angle in the frame."""
        mass, length = fmu.default(f"{body}.mass"), fmu.default(f"{body}.length")
        return cls(mass, 0.5 * length * complex(np.exp(1j * angle)), mass * length**2 / 12.0)


def turned(arm: complex, angle: Array) -> Complex:
    """The vector `arm` of a frame that has turned by `angle`."""
    value, first, second = angle
    z = arm * np.exp(1j * value)
    return np.array([z, 1j * first * z, (1j * second - first**2) * z])


def moment(arm: Complex | complex, force: Complex | complex) -> Array:
    """Moment of a force about the start of its arm."""
    return (arm.conjugate() * force).imag


@dataclass(frozen=True)
class FourBar:
    """Lengths of ground, crank, coupler, follower [m], and the masses of the three bodies."""

    lengths: tuple[float, float, float, float]
    masses: tuple[list[Mass], list[Mass], list[Mass]]

    @classmethod
    def gear(cls, fmu: Fmu) -> FourBar:
        """The landing gear: leg and wheel belong to the crank."""
        turn = fmu.default("leg.angle")
        wheel = Mass(fmu.default("wheel.mass"), fmu.default("leg.length") * complex(np.exp(1j * turn)), 0.0)
        l1, l2, l3, l4 = (fmu.default(f"{body}.length") for body in ("ground", *BODIES))
        crank = [Mass.rod(fmu, "crank"), Mass.rod(fmu, "leg", turn), wheel]
        return cls((l1, l2, l3, l4), (crank, [Mass.rod(fmu, "coupler")], [Mass.rod(fmu, "follower")]))

    def angles(self, crank: Array) -> list[Array]:
        """Angles of crank, coupler and follower: the cosine rule, then the derivatives of the closed loop."""
        l1, l2, l3, l4 = self.lengths
        b = l2 * np.exp(1j * crank)
        diagonal = l1 - b
        a = np.abs(diagonal)
        coupler = np.angle(diagonal) + np.arccos((a**2 + l3**2 - l4**2) / (2.0 * a * l3))
        follower = np.angle(b + l3 * np.exp(1j * coupler) - l1)
        u, v, w = crank - follower, crank - coupler, follower - coupler
        k3, k4 = l2 * np.sin(u) / (l3 * np.sin(w)), l2 * np.sin(v) / (l4 * np.sin(w))
        slope = (k4 - k3) / np.tan(w)
        c3 = l2 * np.cos(u) * (1.0 - k4) / (l3 * np.sin(w)) - k3 * slope
        c4 = l2 * np.cos(v) * (1.0 - k3) / (l4 * np.sin(w)) - k4 * slope
        one = np.ones_like(crank)
        return [np.array([crank, one, 0.0 * one]), np.array([coupler, k3, c3]), np.array([follower, k4, c4])]

    def origins(self, angles: list[Array]) -> list[Complex]:
        """Origins of the three frames: A, B, D."""
        still = np.zeros_like(angles[0], dtype=complex)
        return [still, turned(self.lengths[1], angles[0]), still + np.array([self.lengths[0], 0.0, 0.0])[:, None]]

    def centers(self, crank: Array) -> list[tuple[Mass, Complex, Array]]:
        """Each body as one mass, with the motion of its centre and its angle."""
        angles = self.angles(crank)
        found = []
        for parts, origin, angle in zip(self.masses, self.origins(angles), angles, strict=True):
            mass = sum(part.mass for part in parts)
            place = sum(part.mass * part.place for part in parts) / mass
            inertia = sum(part.inertia + part.mass * abs(part.place - place) ** 2 for part in parts)
            found.append((Mass(mass, place, inertia), origin + turned(place, angle), angle))
        return found
