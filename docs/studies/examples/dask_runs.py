"""FMPy with Dask by hand: a grid of runs on processes, each with one instance. usage: dask_runs.py FMU [SIDE]"""

from __future__ import annotations

import sys

import numpy as np
from dask import bag
from gear import FORCES, LOADS, Gear


def retractions(points: list[tuple[float, float]], fmu: str) -> list[tuple[float, float, float]]:
    """The runs of one part of the bag."""
    gear = Gear(fmu)
    rows = [(force, load, gear.retraction(actuator__force=force, load_factor=load)) for force, load in points]
    gear.close()
    return rows


if __name__ == "__main__":
    side = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    grid = [(force, load) for force in np.linspace(*FORCES, side) for load in np.linspace(*LOADS, side)]
    runs = bag.from_sequence(grid, npartitions=8).map_partitions(retractions, sys.argv[1])
    rows = runs.compute(scheduler="processes")
    fastest, slowest = min(rows, key=lambda row: row[2]), max(rows, key=lambda row: row[2])
    print(f"{len(rows)} runs")
    print(f"fastest: {fastest[2]:.6f} s under {fastest[0]:.0f} N at load factor {fastest[1]:.2f}")
    print(f"slowest: {slowest[2]:.6f} s under {slowest[0]:.0f} N at load factor {slowest[1]:.2f}")
