"""This project compared with other tools: run time over error, measured in one call.

usage: peers.py FMU RUST.csv --out DIR --work DIR

RUST.csv contains the points that the Rust program of this folder has just measured. Ends with an error if a tool does
not converge to the exact value, or if this project is not the fastest at one of the compared errors.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import curves
import exudyn_peer
import figure
import fmi_peer
import mujoco_peer
import native_peer
import report
import scenes
import scipy_peer
from measure import LeftOutError, Point

MISMODELLED = 1e-3
"""Least error of a method above which it solves another problem [rad]."""


def heyoka_points() -> Iterator[Point]:
    """The curves of heyoka, where it is installed."""
    if importlib.util.find_spec("heyoka") is None:
        raise LeftOutError("not installed (PyPI: pip install heyoka; conda-forge on other platforms)")
    yield from importlib.import_module("heyoka_peer").points()


def main() -> None:
    """Measure all tools, write the report, and check the results."""
    parser = argparse.ArgumentParser(description="Measure this project beside other tools.")
    parser.add_argument("fmu", type=Path, help="LandingGearRetraction.fmu")
    parser.add_argument("rust", type=Path, help="what the Rust solvers gave")
    parser.add_argument("--out", type=Path, required=True, help="folder with results/ and figures/")
    parser.add_argument("--work", type=Path, required=True, help="folder for the unpacked FMU")
    arguments = parser.parse_args()

    points = curves.read(arguments.rust)
    versions: list[str] = []
    left_out: list[str] = []
    gear, squeezer = scenes.landing_gear(), scenes.squeezer()
    for title, source in (
        ("FMU from Python", fmi_peer.points(arguments.fmu, arguments.work)),
        ("GSL", native_peer.points(native_peer.GSL, arguments.work, versions)),
        ("CVODE", native_peer.points(native_peer.CVODE, arguments.work, versions)),
        ("SciPy", scipy_peer.points()),
        ("heyoka", heyoka_points()),
        ("EXUDYN", exudyn_peer.points(gear)),
        ("MuJoCo", mujoco_peer.points(gear)),
        ("EXUDYN, squeezer", exudyn_peer.points(squeezer)),
        ("MuJoCo, squeezer", mujoco_peer.points(squeezer)),
    ):
        began = time.perf_counter()
        try:
            settings = list(source)
        except LeftOutError as reason:
            left_out.append(f"{title} is left out: {reason}.")
            print(left_out[-1], flush=True)
            continue
        points += settings
        print(f"{len(settings)} settings of {title} measured in {time.perf_counter() - began:.0f} s", flush=True)

    results = arguments.out / "results"
    curves.write(results / "peers.csv", points)
    (results / "peers.md").write_text(report.page(points, versions, left_out), encoding="utf-8")
    figure.save(points, arguments.out / "figures")
    complaints = []
    for scene in ("S1", "Andrews"):
        found = curves.curves(points, scene)
        print(f"\n{scene}", *report.by_tool(found), sep="\n")
        for curve in [*found, *curves.curves(points, f"{scene} limit")]:
            if curve.floor > MISMODELLED:
                complaints.append(f"{scene}: {curve.tool} {curve.method} comes no closer than {curve.floor:.1e} rad")
        complaints += [f"{scene}: not the fastest: {line}" for line in curves.faster(found)]
    print(f"\nwritten to {results / 'peers.md'}")
    if complaints:
        sys.exit("\n".join(f"error: {line}" for line in complaints))


if __name__ == "__main__":
    main()
