"""The measured points as curves of run time over error, and the comparison of the tools."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from measure import Point

LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)
"""Errors at which the tools are compared [rad]."""
DECADES = tuple(10.0**-k for k in range(3, 13))
"""Errors in the tables of each method [rad]."""
TOOL, METHOD = "linkage-fmu", "tables"
"""This project with its default settings."""
HEADER = ("scene", "tool", "method", "setting", "error_rad", "run_s", "setup_s", "evaluations")


@dataclass(frozen=True)
class Curve:
    """All settings of one method."""

    tool: str
    method: str
    points: list[Point]

    @property
    def floor(self) -> float:
        """Least error of any setting [rad]."""
        return min(point.error for point in self.points)

    @property
    def setup(self) -> float:
        """Time before the first run [s], of the fastest setting."""
        return min(point.setup for point in self.points)

    def best(self, error: float) -> Point | None:
        """The fastest setting with at most this error; None if there is none."""
        return min((p for p in self.points if p.error <= error), key=lambda p: p.run, default=None)

    def frontier(self) -> list[Point]:
        """Settings for which no other setting is better in both error and run time, by increasing error."""
        found: list[Point] = []
        for point in sorted(self.points, key=lambda p: (p.error, p.run)):
            if not found or point.run < found[-1].run:
                found.append(point)
        return found


def curves(points: Iterable[Point], scene: str) -> list[Curve]:
    """The curves of a scene, in the order of measurement."""
    grouped: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        if point.scene == scene and math.isfinite(point.error):
            grouped.setdefault((point.tool, point.method), []).append(point)
    return [Curve(tool, method, members) for (tool, method), members in grouped.items()]


def own(found: list[Curve]) -> Curve:
    """This project's curve, with which the others are compared."""
    return next(curve for curve in found if (curve.tool, curve.method) == (TOOL, METHOD))


def faster(found: list[Curve]) -> list[str]:
    """One line for each error at which this project is not the fastest."""
    lines = []
    for level in LEVELS:
        mine = own(found).best(level)
        for curve in found:
            point = curve.best(level)
            if curve.tool != TOOL and point and (mine is None or point.run <= mine.run):
                ours = f"{mine.run:.3g} s" if mine else "never"
                lines.append(f"at {level:.0e} rad {curve.tool} {curve.method} takes {point.run:.3g} s, {TOOL} {ours}")
    return lines


def read(path: Path) -> list[Point]:
    """Points from a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = [[row[name] for name in HEADER] for row in csv.DictReader(file)]
    return [Point(*row[:4], *map(float, row[4:7]), int(row[7]) if row[7] else None) for row in rows]


def write(path: Path, points: Iterable[Point]) -> None:
    """Write points to a CSV file."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        for p in points:
            numbers = (f"{p.error:.3e}", f"{p.run:.4e}", f"{p.setup:.3e}")
            evaluations = "" if p.evaluations is None else p.evaluations
            writer.writerow((p.scene, p.tool, p.method, p.setting, *numbers, evaluations))
