"""A crane of two links, any multibody program, coupled with the two cylinders of one HydraulicSystem FMU.

    python examples/crane/crane.py target/fmu/CraneHydraulics.fmu
    python examples/crane/crane.py target/fmu/CraneHydraulics.fmu --one-cylinder

The crane here stands for the multibody program: it has masses, joints and a solver of its own, and two numbers to give
for each cylinder: the apparent mass and the load. The FMU predicts the motion with them and gives the force back.
Prints the errors of the joint angles for each communication step, against one system integrated by SciPy
(tests/networks/two_link_crane.py).
"""

from __future__ import annotations

import argparse
import math
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

Vector = np.ndarray


class Lost(Exception):
    """A coupling is unstable."""


G = 9.81
BOOM, JIB = 3.0, 2.2
"""Lengths of the links [m]; the boom turns at the base, the jib at the boom's end."""
BOOM_MASS, JIB_MASS, LOAD = 300.0, 150.0, 400.0
"""Masses [kg]: of the links, uniform rods, and of the load at the jib's end."""
START = np.array([0.6, -0.9])
"""Angle of the boom, and of the jib relative to it, at the start [rad]."""
COMMANDS = {"lift_valve.command": 0.5, "jib_valve.command": -0.4}
CYLINDERS = ("lift", "jib")
END = 2.0
"""End of the run [s]."""
FASTEST = 20.0
"""Angular speed that says that a coupling is unstable [rad/s]."""
STEPS = (0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3)
"""Communication steps of the table [s]."""
PLAIN, HELD, CORRECTED = "plain exchange", "mean force", "mean force, corrected"
LINE, TWO_PASSES = "changing force", "two passes"
SCHEMES = (PLAIN, HELD, CORRECTED, LINE, TWO_PASSES)
"""Force and motion alone; the foreseen mean force; the same with corrected loads, which know the foreseen forces of the
other cylinder; corrected loads, and a force that changes at the foreseen rate; then also the oil under the motion of
the crane."""
SHORTEST = 1e-7
"""Change of a length within a step below which the load has no slope along it [m]."""
NO_SLOPE = 1e-9
"""Slope of a load along its cylinder [N/m] that is none, but not 0: with 0, the FMU extrapolates the load."""
REFERENCES = {count: Path(__file__).with_name(f"reference_{count}.txt") for count in ("both", "one")}
"""Times and angles of one system of crane and oil, by SciPy, with both cylinders and with one."""
ACTIVE = np.ones(2)
"""1: the cylinder moves its joint; 0: the crane is without this cylinder, which keeps its length."""

# A cylinder between two points at the distances a and b from its joint: length^2 = a^2 + b^2 - 2 a b cos(angle + c).
SIDES = ((0.8, 1.0), (0.9, 0.6))
TURNED = (0.7, math.pi - 0.55)
UNUSED = 1.15
"""Length of a cylinder that moves nothing [m]."""


def remove_jib_cylinder() -> None:
    """The jib swings freely, and the valve of its cylinder stays closed."""
    ACTIVE[1], COMMANDS["jib_valve.command"] = 0, 0.0


# Numbers and `math` instead of arrays of two values: the crane is computed a million times for the table.


def length(cylinder: int, angle: float) -> tuple[float, float, float]:
    """Length s of a cylinder [m], its derivative J = ds/dq with respect to the angle of its own joint, and dJ/dq."""
    if not ACTIVE[cylinder]:
        return UNUSED, 0.0, 0.0
    (a, b), turned = SIDES[cylinder], angle + TURNED[cylinder]
    c, s = a * b * math.cos(turned), math.sqrt(a**2 + b**2 - 2 * a * b * math.cos(turned))
    j = a * b * math.sin(turned) / s
    return s, j, (c - j**2) / s


def lengths(q: Vector) -> tuple[Vector, Vector, Vector]:
    """Lengths of the cylinders [m], their derivatives J and dJ/dq."""
    s, j, j_q = zip(length(0, q[0]), length(1, q[1]), strict=True)
    return np.array(s), np.array(j), np.array(j_q)


def dynamics(q: Vector, w: Vector) -> tuple[tuple[float, float, float], tuple[float, float]]:
    """Mass matrix M (elements 11, 12, 22) and generalised force Q of weight and inertia: M q'' = Q + J^T F."""
    (boom_angle, jib_angle), (v, w) = q.tolist(), w.tolist()
    one = (BOOM_MASS / 3 + JIB_MASS + LOAD) * BOOM**2
    two = (JIB_MASS / 3 + LOAD) * JIB**2
    cross = (JIB_MASS / 2 + LOAD) * BOOM * JIB
    c, s = cross * math.cos(jib_angle), cross * math.sin(jib_angle)
    boom = (BOOM_MASS / 2 + JIB_MASS + LOAD) * BOOM * math.cos(boom_angle)
    jib = (JIB_MASS / 2 + LOAD) * JIB * math.cos(boom_angle + jib_angle)
    return (one + two + 2 * c, two + c, two), (s * w * (2 * v + w) - G * (boom + jib), -s * v**2 - G * jib)


def acceleration(q: Vector, w: Vector, forces: Vector) -> Vector:
    """Angular accelerations q'' under the forces of the cylinders."""
    (m11, m12, m22), (q1, q2) = dynamics(q, w)
    q1 += length(0, q[0])[1] * forces[0]
    q2 += length(1, q[1])[1] * forces[1]
    determinant = m11 * m22 - m12**2
    return np.array([(m22 * q1 - m12 * q2) / determinant, (m11 * q2 - m12 * q1) / determinant])


def elements(q: Vector, w: Vector, forces: Vector) -> tuple[Vector, Vector]:
    """Apparent mass [kg] and load [N] of each cylinder: with A = J M^-1 J^T and s'' = A F + b, each cylinder sees
    m s'' = F - W with m = 1/A_ii and W = -m (b_i + sum over the other cylinders of A_ij F_j)."""
    (m11, m12, m22), q_force = dynamics(q, w)
    _, j, j_q = lengths(q)
    inverse = np.array([[m22, -m12], [-m12, m11]]) / (m11 * m22 - m12**2)
    a = j[:, None] * inverse * j[None, :]
    b = j * (inverse @ q_force) + j_q * w**2
    m = np.divide(1, np.diag(a), out=np.zeros(2), where=np.diag(a) > 0)
    return m, -m * (b + a @ forces - np.diag(a) * forces)


def move(q: Vector, w: Vector, force: Callable[[float], Vector], h: float) -> tuple[Vector, Vector]:
    """The crane after a step of h [s] under forces over time: Runge and Kutta's method in short steps."""
    count = max(4, round(h / 2.5e-4))
    dt = h / count
    for k in range(count):
        t = k * dt
        first, middle, last = force(t), force(t + dt / 2), force(t + dt)
        a = acceleration(q, w, first)
        b = acceleration(q + dt / 2 * w, w + dt / 2 * a, middle)
        c = acceleration(q + dt / 2 * w + dt**2 / 4 * a, w + dt / 2 * b, middle)
        d = acceleration(q + dt * w + dt**2 / 2 * b, w + dt * c, last)
        q, w = q + dt * w + dt**2 / 6 * (a + b + c), w + dt / 6 * (a + 2 * b + 2 * c + d)
    return q, w


class Oil:
    """The HydraulicSystem FMU: all inputs and outputs of both cylinders by one call each."""

    def __init__(self, fmu: Path, follow: bool) -> None:
        self.folder = extract(fmu)
        described = read_model_description(self.folder)
        self.references = {variable.name: variable.valueReference for variable in described.modelVariables}
        identifier = described.coSimulation.modelIdentifier
        self.slave = FMU2Slave(
            guid=described.guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName="oil"
        )
        self.slave.instantiate()
        self.slave.setReal([self.references[name] for name in COMMANDS], list(COMMANDS.values()))
        if follow:
            [items] = [v.declaredType.items for v in described.modelVariables if v.name == "coupling.mode"]
            [item] = [int(item.value) for item in items if item.name == "follow"]
            self.slave.setInteger([self.references["coupling.mode"]], [item])
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()

    def give(self, **inputs: Vector) -> None:
        """Set inputs of both cylinders by their names."""
        for name, values in inputs.items():
            self.slave.setReal([self.references[f"{one}.{name}"] for one in CYLINDERS], list(values))

    def read(self, name: str) -> Vector:
        """An output of both cylinders."""
        return np.array(self.slave.getReal([self.references[f"{one}.{name}"] for one in CYLINDERS]))

    def give_speeds(self, derivatives: Vector) -> None:
        """Derivatives of the speeds of both cylinders, of orders 1 to 4, for the next step."""
        for one, own in zip(CYLINDERS, derivatives.T, strict=True):
            self.slave.setRealInputDerivatives([self.references[f"{one}.speed"]] * 4, [1, 2, 3, 4], list(own))

    def close(self) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def hermite(v: Vector, v_end: Vector, way: Vector, a: Vector, a_end: Vector, h: float) -> Vector:
    """Derivatives of orders 1 to 4 of the speed that has the values and slopes of both ends and the integral `way`."""
    rise, slope = v_end - v - a * h, (a_end - a) * h
    mean = way / h - v - 0.5 * a * h
    fourth = 30 * (mean - 0.5 * rise + slope / 12)
    third = slope - 2 * rise - 2 * fourth
    second = rise - third - fourth
    return np.array([a, 2 * second / h**2, 6 * third / h**3, 24 * fourth / h**4])


def correct_loads(oil: Oil, q: Vector, w: Vector, h: float) -> None:
    """Give loads that contain the foreseen forces of the other cylinders, at both ends of the step of h [s]."""
    force, rate = oil.read("preview.force"), oil.read("preview.force_rate")
    change = oil.read("preview.length") - lengths(q)[0]
    _, load = elements(q, w, force)
    _, end = elements(*move(q, w, lambda t: force + rate * t, h), force + rate * h)
    moves = np.abs(change) > SHORTEST
    slope = np.where(moves, (end - load) / np.where(moves, change, 1.0), NO_SLOPE)
    oil.give(holding_force=load, holding_force_derivative=slope)


def couple(fmu: Path, h: float, scheme: str) -> dict[float, Vector]:
    """Angles of both joints at the communication points, in steps of h [s].

    # Errors
    `Lost`: the coupling is unstable.
    """
    oil = Oil(fmu, follow=scheme == TWO_PASSES)
    q, w = START.copy(), np.zeros(2)
    s, j, _ = lengths(q)
    oil.give(length=s, speed=j * w)
    oil.slave.setReal([oil.references["preview.horizon"]], [h])
    oil.slave.exitInitializationMode()
    found = {0.0: q}
    try:
        for i in range(round(END / h)):
            s, j, _ = lengths(q)
            v = j * w
            oil.give(length=s, speed=v)
            force, rate = oil.read("force"), np.zeros(2)
            if scheme != PLAIN:
                mass, load = elements(q, w, force)
                slope = np.full(2, 0.0 if scheme == HELD else NO_SLOPE)
                oil.give(reduced_mass=mass, holding_force=load, holding_force_derivative=slope)
                if scheme != HELD:
                    correct_loads(oil, q, w, h)
                force = oil.read("preview.force_mean")
            if scheme in (LINE, TWO_PASSES):
                force, rate = oil.read("preview.force"), oil.read("preview.force_rate")
            q, w = move(q, w, lambda t, force=force, rate=rate: force + rate * t, h)
            if scheme == TWO_PASSES:
                ends = [oil.read(f"preview.{name}") for name in ("start_acceleration", "acceleration")]
                s_end, j, _ = lengths(q)
                oil.give_speeds(hermite(v, j * w, s_end - s, *ends, h))
            if np.abs(w).max() > FASTEST:
                raise Lost
            oil.slave.doStep(i * h, h)
            found[round((i + 1) * h, 9)] = q
    except FMICallException as error:
        raise Lost from error
    finally:
        oil.close()
    return found


def error(fmu: Path, h: float, scheme: str) -> float:
    """Largest error of an angle [rad] against one system; infinity where the coupling is lost."""
    try:
        found = couple(fmu, h, scheme)
    except Lost:
        return float("inf")
    reference = REFERENCES["both" if ACTIVE.all() else "one"]
    rows = [row for row in np.loadtxt(reference) if round(row[0], 9) in found]
    return max(float(np.abs(found[round(row[0], 9)] - row[1:]).max()) for row in rows)


def main() -> None:
    parser = argparse.ArgumentParser(description="Couple a crane with the cylinders of a HydraulicSystem FMU.")
    parser.add_argument("fmu", type=Path, help="CraneHydraulics.fmu")
    parser.add_argument("--one-cylinder", action="store_true", help="without the cylinder of the jib")
    arguments = parser.parse_args()
    if arguments.one_cylinder:
        remove_jib_cylinder()
    print("largest error of an angle [rad]")
    print(f"{'step':24s}" + "".join(f"{1e3 * h:8g} ms" for h in STEPS))
    for scheme in SCHEMES:
        errors = [error(arguments.fmu, h, scheme) for h in STEPS]
        texts = [f"{one:.1e}" if np.isfinite(one) else "lost" for one in errors]
        print(f"{scheme:24s}" + "".join(f"{text:>11s}" for text in texts), flush=True)


if __name__ == "__main__":
    main()
