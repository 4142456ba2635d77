"""The landing gear: its travel, and its retraction or extension under a constant force.

Angles of rotation are those of [HF08]: 0 deg with the gear extended, increasing in retraction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .fmu import Fmu, Value

Array = NDArray[np.float64]

METHOD = "solver.method"
"""Enumeration of FMUs with more than one formulation."""
RIGID_FEM = "rigid_fem"
"""Its item for the finite elements with rigid links of [HF08] section 3."""
AIRSPEED = 70.0
"""Airspeed of [HF08] section 2 [m/s]."""
STEP = 0.25e-3
"""Communication step [s]; the time at which the gear is up is interpolated within a step."""
LONGEST = 0.5
"""Time limit of a motion through the travel [s]."""
FREE = {"upstop.enabled": False, "downstop.enabled": False}
"""Values without stops, so that the motion passes the end of the travel and the end can be interpolated."""


@dataclass(frozen=True)
class Travel:
    """Angles of the crank with the gear down and up [rad]."""

    down: float
    up: float

    @classmethod
    def of(cls, fmu: Fmu) -> Travel:
        """Travel between the FMU's start angle and the angle of its stop."""
        return cls(fmu.default("crank.start_angle"), fmu.default("upstop.angle"))

    @property
    def degrees(self) -> float:
        """Angle of rotation of the gear when it is up [deg]."""
        return float(self.rotation(np.array([self.up]))[0])

    def rotation(self, angle: Array) -> Array:
        """Angle of rotation of the gear [deg] for an angle of the crank [rad]."""
        return np.degrees(self.down - angle)


@dataclass(frozen=True)
class Motion:
    """Angle [rad], speed [rad/s] and acceleration [rad/s2] of the crank over time [s], up to the end of the travel."""

    time: Array
    angle: Array
    speed: Array
    acceleration: Array

    @property
    def duration(self) -> float:
        """Time to the end of the travel [s]."""
        return float(self.time[-1])


def retract(fmu: Fmu, travel: Travel, values: dict[str, Value]) -> Motion:
    """A retraction from rest with all defaults except these values."""
    return turn(fmu, travel.up, values)


def turn(fmu: Fmu, end: float, values: dict[str, Value]) -> Motion:
    """A motion from rest to this angle of the crank [rad], with all defaults except these values."""
    fmu.start({**FREE, **values})
    rows = [[0.0, *fmu.read("crank.angle", "crank.speed", "crank.acceleration")]]
    way = end - rows[0][1]
    steps = 0
    while (end - rows[-1][1]) * way > 0.0:
        if fmu.time > LONGEST:
            raise SystemExit(f"error: crank.angle does not reach {end} rad within {LONGEST} s under {values}")
        # Multiples of the step, which have less rounding error than sums of it.
        steps += 1
        fmu.step(steps * STEP - fmu.time)
        rows.append([fmu.time, *fmu.read("crank.angle", "crank.speed", "crank.acceleration")])
    rows[-1] = passing(rows[-2], rows[-1], end)
    return Motion(*np.array(rows).T)


def passing(before: list[float], after: list[float], angle: float) -> list[float]:
    """Time, angle, speed and acceleration where the motion passes the angle, by the quintic through both ends of a
    step."""
    h = after[0] - before[0]
    [a0, v0, c0], [a1, v1, c1] = ([row[1], h * row[2], h * h * row[3]] for row in (before, after))
    rest = np.array([a1 - a0 - v0 - 0.5 * c0, v1 - v0 - c0, c1 - c0])
    powers = np.array([[1.0, 1.0, 1.0], [3.0, 4.0, 5.0], [6.0, 12.0, 20.0]])
    course = np.polynomial.Polynomial([a0, v0, 0.5 * c0, *np.linalg.solve(powers, rest)])
    speed, acceleration = course.deriv(), course.deriv(2)
    s = (angle - a0) / (a1 - a0)
    for _ in range(20):
        s -= float((course(s) - angle) / speed(s))
    return [before[0] + s * h, angle, float(speed(s)) / h, float(acceleration(s)) / h**2]
