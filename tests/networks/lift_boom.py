"""The lift boom of examples/lift_boom and its hydraulics as one system by SciPy: the reference for a coupling.

Usage: python tests/networks/lift_boom.py > examples/lift_boom/reference.txt writes times, the angle of the boom and
the pressures of both chambers. The equations of the oil are those of integrate.py. The boom is Lagrange's pendulum. The
program shares the numbers of the example, and no equation.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from integrate import Element, Network, Vector
from scipy.integrate import solve_ivp

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "lift_boom"
SCHEDULE = ((0.2, 0.0), (1.4, 1.0), (1.8, 0.0), (2.6, -1.0), (3.0, 0.0))
"""Ends of the intervals [s] in which the valve has a command."""
TOLERANCE = 1e-12


class Boom(Network):
    """The network with the boom that it moves."""

    def __init__(self, definition: Element, mechanism: Element) -> None:
        bodies = mechanism["bodies"]
        self.body, self.ground = bodies["boom"], bodies["ground"]["points"]
        self.gravity, self.angle = mechanism["gravity"]["acceleration"], mechanism["start"]["angle"]
        super().__init__(definition)

    def moving(self) -> list[str]:
        return ["boom.angle", "boom.speed"]

    def moving_start(self) -> Element:
        return {"boom.angle": self.angle, "boom.speed": 0.0}

    def length(self, angle: float) -> tuple[float, float]:
        """Length of the cylinder, and its derivative with respect to the angle."""
        turn = np.exp(1j * angle) * complex(*self.body["points"]["cylinder"])
        line = turn + complex(*self.ground["boom"]) - complex(*self.ground["cylinder"])
        return abs(line), (np.conj(line) * 1j * turn).real / abs(line)

    def motion(self, y: Element) -> dict[str, tuple[float, float]]:
        length, lever = self.length(y["boom.angle"])
        return {"lift": (length, lever * y["boom.speed"])}

    def moved(self, y: Element, force: dict[str, float]) -> Element:
        center = complex(*self.body["center"])
        inertia = self.body["inertia"] + self.body["mass"] * abs(center) ** 2
        weight = self.body["mass"] * self.gravity * (np.exp(1j * y["boom.angle"]) * center).real
        lever = self.length(y["boom.angle"])[1]
        return {"boom.angle": y["boom.speed"], "boom.speed": (lever * force["lift"] - weight) / inertia}


def run(own: Boom) -> list[tuple[float, Vector]]:
    """States every 20 ms. The integration starts again wherever the command jumps."""
    state, begin, rows = own.start(), 0.0, []
    size = np.array([1e5 if name in own.pressures else 1e-2 for name in own.names])
    for end, command in SCHEDULE:
        own.valves["valve"]["command"] = command
        times = [time for time in np.round(np.arange(1, 151) * 0.02, 9) if begin < time <= end]
        result = solve_ivp(
            own.rates, (begin, end), state, "Radau", t_eval=times, rtol=TOLERANCE, atol=TOLERANCE * size, max_step=0.01
        )
        assert result.success, result.message
        rows += list(zip(times, result.y.T, strict=True))
        state, begin = result.y[:, -1], end
    return rows


if __name__ == "__main__":
    network, mechanism = (
        json.loads((FOLDER / name).read_text(encoding="utf-8")) for name in ("network.json", "mechanism.json")
    )
    own = Boom(network, mechanism)
    for time, state in run(own):
        print(float(time), *(repr(float(state[own.index[name]])) for name in ("boom.angle", "lift.a", "lift.b")))
    sys.stdout.flush()
