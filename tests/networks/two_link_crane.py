"""The crane of examples/crane and its hydraulics as one system, integrated by SciPy: the reference for a coupling.

Usage: python tests/networks/two_link_crane.py > examples/crane/reference_both.txt writes times and the angles of boom
and jib. With the argument `one`, for reference_one.txt, the crane is without the cylinder of the jib. The equations
of the oil are those of integrate.py. The crane's are Lagrange's, from positions and energies. This program shares the
numbers of the example, and no equation.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from integrate import Element, Network, Vector, integrate

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "crane"
sys.path.append(str(FOLDER))
import crane  # noqa: E402

TIMES = [round(0.02 * k, 9) for k in range(1, 101)]
STEP = 1e-40
"""Step of a complex-step derivative, which has no rounding error."""


def direction(angle: float) -> Vector:
    return np.array([np.cos(angle), np.sin(angle)])


def mass(q: Vector) -> Vector:
    """Mass matrix, from the positions of the centres of both links and of the load."""
    across = [direction(angle + np.pi / 2) for angle in (q[0], q[0] + q[1])]
    boom, jib = crane.BOOM * across[0], crane.JIB * across[1]
    none = np.zeros(2)
    of = {crane.BOOM_MASS: (boom / 2, none), crane.JIB_MASS: (boom + jib / 2, jib / 2), crane.LOAD: (boom + jib, jib)}
    spins = {crane.BOOM_MASS: (crane.BOOM, [1, 0]), crane.JIB_MASS: (crane.JIB, [1, 1])}
    total = sum(m * np.array([[a @ b for b in columns] for a in columns]) for m, columns in of.items())
    return total + sum(m * length**2 / 12 * np.outer(turn, turn) for m, (length, turn) in spins.items())


def potential(q: Vector) -> float:
    elbow = crane.BOOM * direction(q[0])
    end = elbow + crane.JIB * direction(q[0] + q[1])
    parts = {crane.BOOM_MASS: elbow / 2, crane.JIB_MASS: (elbow + end) / 2, crane.LOAD: end}
    return crane.G * sum(m * position[1] for m, position in parts.items())


def lengths(q: Vector) -> Vector:
    """Lengths of the cylinders between the points that they connect."""
    (a, b), (c, d) = crane.SIDES
    elbow = crane.BOOM * direction(q[0])
    lift = b * direction(q[0]) - a * direction(-crane.TURNED[0])
    jib = elbow + d * direction(q[0] + q[1] + crane.TURNED[1] - np.pi) - (elbow - c * direction(q[0]))
    found = np.sqrt(np.array([lift @ lift, jib @ jib]))
    return np.where(crane.ACTIVE, found, crane.UNUSED)


def derivative(law: object, q: Vector) -> Vector:
    """Derivatives of a law with respect to both angles. The last index selects the angle."""
    return np.stack([law(q + 1j * STEP * unit).imag / STEP for unit in np.eye(2)], axis=-1)


class Crane(Network):
    """The network with the crane that it moves."""

    def moving(self) -> list[str]:
        return ["boom.angle", "jib.angle", "boom.speed", "jib.speed"]

    def moving_start(self) -> Element:
        return dict(zip(self.moving(), [*crane.START, 0.0, 0.0], strict=True))

    def angles(self, y: Element) -> tuple[Vector, Vector]:
        q = np.array([y[name] for name in self.moving()])
        return q[:2], q[2:]

    def motion(self, y: Element) -> dict[str, tuple[float, float]]:
        q, w = self.angles(y)
        return dict(zip(crane.CYLINDERS, zip(lengths(q), derivative(lengths, q) @ w, strict=True), strict=True))

    def moved(self, y: Element, force: dict[str, float]) -> Element:
        q, w = self.angles(y)
        change = derivative(mass, q)
        q_force = derivative(lengths, q).T @ [force[name] for name in crane.CYLINDERS] - derivative(potential, q)
        inertia = (change @ w) @ w - 0.5 * np.array([w @ change[:, :, k] @ w for k in range(2)])
        return dict(zip(self.moving(), [*w, *np.linalg.solve(mass(q), q_force - inertia)], strict=True))


if __name__ == "__main__":
    if "one" in sys.argv[1:]:
        crane.remove_jib_cylinder()
    definition = json.loads((FOLDER / "network.json").read_text(encoding="utf-8"))
    for valve, command in crane.COMMANDS.items():
        definition["valves"][valve.split(".")[0]]["command"] = command
    own = Crane(definition)
    for time, state in zip(TIMES, integrate(own, TIMES), strict=True):
        print(time, *(repr(float(state[own.index[name]])) for name in own.moving()[:2]))
