"""Draw each mechanism near its start, or the cylinder of a hydraulic actuator, as the FMU's icon,
modelDescription/<Name>/model.png.

usage: icons.py DIR [NAME...]      DIR holds the packed FMUs; without names, every folder of modelDescription/

The angles come from the FMU, the points from its mechanism.json; bodies are found from the ground on through their
revolute joints. The icons are committed: draw them anew when a mechanism's shape changes.
"""

from __future__ import annotations

import argparse
import cmath
import json
from pathlib import Path
from typing import Any

import matplotlib as mpl
from fmpy import read_model_description, simulate_fmu

mpl.use("Agg")
import matplotlib.pyplot as plt

DESCRIPTIONS = Path(__file__).resolve().parents[2] / "modelDescription"
PIXELS = 128
"""Width and height of an icon."""
STEPS = 20
"""Steps after the start among which a mechanism that starts flat is drawn."""
BODY, DRIVE, GROUND = "#24527a", "#d9822b", "#555555"

OIL = "#ecc195"
"""Oil in a chamber: the colour of a drive, half transparent on white."""
CYLINDER = (
    ((0.00, 1.00), (0.0, 0.0), DRIVE, 2.0),
    ((0.18, 0.18), (0.0, -0.30), DRIVE, 1.4),
    ((0.66, 0.66), (0.0, -0.30), DRIVE, 1.4),
    ((0.08, 0.76), (0.0, 0.0), DRIVE, 8.4),
    ((0.11, 0.73), (0.0, 0.0), "white", 6.0),
    ((0.11, 0.34), (0.0, 0.0), OIL, 6.0),
    ((0.34, 0.41), (0.0, 0.0), DRIVE, 6.0),
    ((0.41, 0.76), (0.0, 0.0), DRIVE, 2.0),
)
"""Lines of a hydraulic drive from end to end: parts of its length along it and aside, colour, width. Rod, ports,
barrel, its inside, the chamber on the side of the piston, the piston, the rod within."""

Place = tuple[complex, complex]
"""Origin of a body [m], as x + i y, and the direction of its x axis."""


def points(body: dict[str, Any]) -> dict[str, complex]:
    """The points of a body in its own frame [m]."""
    own = {name: complex(*xy) for name, xy in body.get("points", {}).items()}
    return {"origin": 0j, "end": complex(body.get("length", 0.0)), **own}


class Figure:
    """A mechanism in its position at the start."""

    def __init__(self, mechanism: dict[str, Any], angles: dict[str, float]) -> None:
        self.bodies = mechanism["bodies"]
        self.places: dict[str, Place] = {"ground": (0j, 1 + 0j)}
        self.joints = [joint for joint in mechanism["joints"].values() if joint["type"] == "revolute"]
        for _ in self.bodies:
            for name, body in self.bodies.items():
                if "fixed_to" in body and self.knows(body["fixed_to"]) and name not in self.places:
                    carrier = body["fixed_to"].split(".")[0]
                    turn = cmath.exp(1j * body.get("angle", 0.0))
                    self.places[name] = (self.at(body["fixed_to"]), self.places[carrier][1] * turn)
            for joint in self.joints:
                for known, found in ((joint["first"], joint["second"]), (joint["second"], joint["first"])):
                    body, point = found.split(".")
                    if self.knows(known) and body not in self.places:
                        direction = cmath.exp(1j * angles.get(f"{body}.angle", 0.0))
                        self.places[body] = (self.at(known) - points(self.bodies[body])[point] * direction, direction)
        self.drives = [d for d in mechanism.get("actuators", {}).values() if "first" in d]

    def knows(self, point: str) -> bool:
        """Whether the body of a point, such as `crank.end`, has its place."""
        return point.split(".")[0] in self.places

    def at(self, point: str) -> complex:
        """Place of a point [m]."""
        body, name = point.split(".")
        origin, direction = self.places[body]
        return origin + points(self.bodies[body])[name] * direction

    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest x and y of all points [m]."""
        every = [self.at(f"{name}.{point}") for name in self.places for point in points(self.bodies[name])]
        x, y = [p.real for p in every], [p.imag for p in every]
        return (min(x), max(x)), (min(y), max(y))

    def flatness(self) -> float:
        """Smaller by larger side of what it fills: 0 on a line."""
        sides = [high - low for low, high in self.extent()]
        return min(sides) / max(sides)

    def draw(self, path: Path) -> None:
        """Write the icon."""
        figure = plt.figure(figsize=(1, 1), dpi=PIXELS)
        axes = figure.add_axes((0.06, 0.06, 0.88, 0.88))
        axes.set_aspect("equal")
        axes.axis("off")

        def line(ends: list[complex], colour: str, width: float, *, square: bool = False) -> None:
            x, y = [p.real for p in ends], [p.imag for p in ends]
            axes.plot(x, y, color=colour, linewidth=width, solid_capstyle="butt" if square else "round")

        for name in self.places:
            own = [self.at(f"{name}.{point}") for point in points(self.bodies[name])]
            for end in own[1:]:
                line([own[0], end], GROUND if name == "ground" else BODY, 0.8 if name == "ground" else 3.0)
        for drive in self.drives:
            ends = self.at(drive["first"]), self.at(drive["second"])
            if "hydraulics" not in drive:
                line(list(ends), DRIVE, 2.2)
                continue
            for parts, aside, colour, width in CYLINDER:
                offsets = [complex(part, off) for part, off in zip(parts, aside, strict=True)]
                line([ends[0] + offset * (ends[1] - ends[0]) for offset in offsets], colour, width, square=True)
            for end in ends:
                pin = {"color": "white", "markeredgecolor": BODY, "markersize": 2.4, "markeredgewidth": 0.8}
                axes.plot(end.real, end.imag, "o", **pin)
        for joint in self.joints:
            pin = self.at(joint["first"])
            colour = GROUND if "ground" in joint["first"] + joint["second"] else "white"
            axes.plot(pin.real, pin.imag, "o", color=colour, markeredgecolor=BODY, markersize=3.2, markeredgewidth=0.8)
        (left, right), (low, high) = self.extent()
        half = 0.55 * max(right - left, high - low)
        axes.set_xlim(0.5 * (left + right) - half, 0.5 * (left + right) + half)
        axes.set_ylim(0.5 * (low + high) - half, 0.5 * (low + high) + half)
        figure.savefig(path, transparent=True, metadata={"Software": None})
        plt.close(figure)


def draw_cylinder(path: Path) -> None:
    """Write the icon of a hydraulic actuator: cylinder with piston and rod, and the two lines to its chambers."""
    figure = plt.figure(figsize=(1, 1), dpi=PIXELS)
    axes = figure.add_axes((0.06, 0.06, 0.88, 0.88))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.add_patch(plt.Rectangle((0.08, 0.40), 0.58, 0.30, facecolor="white", edgecolor=BODY, linewidth=2.2))
    axes.add_patch(plt.Rectangle((0.10, 0.42), 0.20, 0.26, facecolor=DRIVE, alpha=0.5, linewidth=0))
    axes.plot([0.34, 0.34], [0.42, 0.68], color=BODY, linewidth=4.0, solid_capstyle="butt")
    axes.plot([0.34, 0.93], [0.55, 0.55], color=BODY, linewidth=3.0)
    for x in (0.16, 0.58):
        axes.plot([x, x], [0.40, 0.20], color=DRIVE, linewidth=2.2)
    for x in (0.08, 0.93):
        axes.plot(x, 0.55, "o", color="white", markeredgecolor=BODY, markersize=3.2, markeredgewidth=0.8)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)
    figure.savefig(path, transparent=True, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """Draw the icons."""
    parser = argparse.ArgumentParser(description="Draw the icons of the mechanisms.")
    parser.add_argument("fmus", type=Path, metavar="DIR", help="folder of the packed FMUs")
    parser.add_argument("names", nargs="*", metavar="NAME", help="folders of modelDescription/")
    arguments = parser.parse_args()
    for name in arguments.names or sorted(path.parent.parent.name for path in DESCRIPTIONS.glob("*/resources/*.json")):
        path = DESCRIPTIONS / name / "model.png"
        if (DESCRIPTIONS / name / "resources" / "hydraulics.json").is_file():
            draw_cylinder(path)
            print(path)
            continue
        mechanism = json.loads((DESCRIPTIONS / name / "resources" / "mechanism.json").read_text(encoding="utf-8"))
        fmu = str(arguments.fmus / f"{name}.fmu")
        outputs = [v.name for v in read_model_description(fmu).modelVariables if v.name.endswith(".angle")]
        outputs = [v for v in outputs if v.split(".")[0] in mechanism["bodies"]]
        step = mechanism.get("experiment", {}).get("step_size", 1e-3)
        result = simulate_fmu(fmu, stop_time=STEPS * step, output_interval=step, output=outputs)
        figures = [Figure(mechanism, {output: float(row[output]) for output in outputs}) for row in result]
        # Some start flat, where there is little to be seen.
        start, best = figures[0], max(figures, key=Figure.flatness)
        (best if start.flatness() < 0.1 else start).draw(path)
        print(path)


if __name__ == "__main__":
    main()
