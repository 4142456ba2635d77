"""Runs of the landing gear for callgrind, as in `cargo fmu bench instructions`.

Each scene runs twice, because the first run fills caches. callgrind writes the counts since the last call of getppid at
each call of getppid.

usage: counted.py FOLDER, where FOLDER contains the extracted FMU
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from conftest import Instance

SPAN = 0.13
"""Duration of a run [s]."""
BUMPER = {
    "upstop__angle": -1.1,
    "upstop__stiffness": 1e6,
    "upstop__damping": 5e3,
    "upstop__rigid": False,
}
SCENES: dict[tuple[str, str, int], dict[str, float]] = {
    ("default", "nothing", 1): {},
    ("default", "nothing", 130): {},
    ("default", "outputs", 130): {},
    ("default", "serialised", 130): {},
    ("friction", "scene", 1): {"friction__enabled": True},
    ("bumper", "scene", 1): BUMPER,
    ("drag", "scene", 1): {"airspeed": 70.0},
}
"""Scene, calls after a step, number of steps; parameters that differ from the default."""


def main() -> None:
    """Run each scene twice."""
    for (_, calls, steps), parameters in SCENES.items():
        instance = Instance(Path(sys.argv[1])).start(tolerance=1e-9, **parameters)
        slave, outputs = (
            instance.slave,
            [v for v in instance.variables.values() if v.causality == "output"],
        )
        reals = [variable.valueReference for variable in outputs if variable.type == "Real"]
        start = slave.getFMUstate()
        for _ in range(2):
            slave.setFMUstate(start)
            os.getppid()
            for step in range(steps):
                slave.doStep(step * SPAN / steps, SPAN / steps)
                if calls == "outputs":
                    slave.getReal(reals)
                if calls == "serialised":
                    state = slave.getFMUstate()
                    slave.serializeFMUstate(state)
                    slave.freeFMUstate(state)
            os.getppid()


if __name__ == "__main__":
    main()
