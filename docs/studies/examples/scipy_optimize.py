"""scipy.optimize: the force that brings the gear up in a given time. usage: scipy_optimize.py FMU [SECONDS]"""

from __future__ import annotations

import sys

from gear import FORCES, Gear
from scipy.optimize import minimize_scalar, root_scalar

wanted = float(sys.argv[2]) if len(sys.argv) > 2 else 0.130
gear = Gear(sys.argv[1])
found = root_scalar(lambda force: gear.retraction(actuator__force=force) - wanted, bracket=FORCES, xtol=1e-6)
print(f"force {found.root:.6f} N: retraction {gear.retraction(actuator__force=found.root):.12f} s")

# The load factor at which a retraction under 30 kN takes longest: gravity pulls the gear up in a part of the travel.
slowest = minimize_scalar(
    lambda load: -gear.retraction(actuator__force=30e3, load_factor=load), bounds=(0.0, 6.0), method="bounded"
)
print(f"load factor {slowest.x:.3f}: retraction {-slowest.fun:.6f} s, the longest from 0 to 6")
gear.close()
