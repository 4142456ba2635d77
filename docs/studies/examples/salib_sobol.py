"""SALib: how much of the scatter of the retraction time each input causes. usage: salib_sobol.py FMU [POINTS]"""

from __future__ import annotations

import sys

import numpy as np
from gear import FORCES, LOADS, Gear
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

problem = {"num_vars": 2, "names": ["actuator.force", "load_factor"], "bounds": [FORCES, LOADS]}
gear = Gear(sys.argv[1])
points = sampling.sample(problem, int(sys.argv[2]) if len(sys.argv) > 2 else 1024, seed=1)
times = np.array([gear.retraction(actuator__force=force, load_factor=load) for force, load in points])
gear.close()
indices = analysis.analyze(problem, times, seed=1)
for name, first, total in zip(problem["names"], indices["S1"], indices["ST"], strict=True):
    print(f"{name}: first order {first:.4f}, total {total:.4f}")
