"""The arm of modelDescription/LiftArm with its network as one system, integrated by SciPy: the reference for the FMU.

Usage: python lift_arm.py > lift_arm.txt writes times, names and values. The equations of the oil are those of
integrate.py; the arm's are written here from the numbers of the file, without the code of the FMU.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from integrate import Element, Network, integrate

TIMES = [0.01, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0]
FILE = Path(__file__).resolve().parents[2] / "modelDescription" / "LiftArm" / "resources" / "mechanism.json"
G = 9.81


class Arm(Network):
    """The network with the arm that it moves: one angle."""

    def __init__(self, mechanism: Element) -> None:
        self.ground = mechanism["bodies"]["ground"]["points"]
        arm, load = mechanism["bodies"]["arm"], mechanism["bodies"]["load"]
        self.points = arm["points"]
        self.ends = {name: (one["first"], one["second"]) for name, one in mechanism["actuators"].items()}
        length = arm["length"]
        self.inertia = arm["mass"] * length**2 / 3 + load["mass"] * length**2
        self.moment = G * (arm["mass"] * length / 2 + load["mass"] * length)
        self.angle = mechanism["start"]["angle"]
        super().__init__(mechanism["hydraulics"])

    def moving(self) -> list[str]:
        return ["arm.angle", "arm.speed"]

    def moving_start(self) -> Element:
        return {"arm.angle": self.angle, "arm.speed": 0.0}

    def lever(self, name: str, angle: float) -> tuple[float, float]:
        """Length of a cylinder, and its derivative with respect to the angle."""
        first, second = (end.split(".")[1] for end in self.ends[name])
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        point = turn @ np.array(self.points[second])
        way = point - np.array(self.ground[first])
        length = float(np.sqrt(way @ way))
        return length, float(way @ np.array([-point[1], point[0]])) / length

    def motion(self, y: Element) -> dict[str, tuple[float, float]]:
        found = {name: self.lever(name, y["arm.angle"]) for name in self.ends}
        return {name: (length, lever * y["arm.speed"]) for name, (length, lever) in found.items()}

    def moved(self, y: Element, force: dict[str, float]) -> Element:
        torque = sum(force[name] * self.lever(name, y["arm.angle"])[1] for name in self.ends)
        torque -= self.moment * np.cos(y["arm.angle"])
        return {"arm.angle": y["arm.speed"], "arm.speed": torque / self.inertia}


if __name__ == "__main__":
    own = Arm(json.loads(FILE.read_text(encoding="utf-8")))
    for time, state in zip(TIMES, integrate(own, TIMES), strict=True):
        for name, value in zip(own.names, state, strict=True):
            print(time, name, repr(float(value)))
