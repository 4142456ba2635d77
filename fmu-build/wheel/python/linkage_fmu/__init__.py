"""Planar mechanisms with one degree of freedom: checked, simulated, studied and packed as FMUs.

```python
import linkage_fmu as lf

gear = lf.example("LandingGearRetraction")
result = gear.simulate(stop_time=0.13, output_interval=1e-3)
print(result["crank.angle"][-1])
```

All values are in SI units. numpy is imported when the first array is made; pandas and matplotlib when they are asked
for.
"""

from __future__ import annotations

import sys
from importlib import import_module
from os import path

from . import _engine
from ._errors import (
    InputError,
    InputTypeError,
    InternalError,
    LinkageError,
    LinkageWarning,
    MechanismError,
    SimulationError,
)

# Not from typing, whose import takes longer than that of this package.
TYPE_CHECKING = False

_FOLDER = _engine.folder(path.realpath(__path__[0]), sys.executable or None)

__version__ = _engine.__version__
Simulation = _engine.Simulation
State = _engine.State
Names = _engine.Names

if TYPE_CHECKING:
    from typing import Any

    from . import build
    from ._definition import check
    from ._fmu import Info, Validation, info, package, validate
    from ._kinematics import Kinematics
    from ._linear import LinearModel
    from ._mechanism import Mechanism, Variable, example, examples
    from ._page import Page
    from ._report import Fact, Finding, Quantity, Report
    from ._result import Result
    from ._study import Optimum, optimise, sweep

# Modules of the names that are imported at their first use.
_LAZY = {
    "build": "build",
    "check": "_definition",
    "Info": "_fmu",
    "Validation": "_fmu",
    "info": "_fmu",
    "package": "_fmu",
    "validate": "_fmu",
    "Kinematics": "_kinematics",
    "LinearModel": "_linear",
    "Mechanism": "_mechanism",
    "Variable": "_mechanism",
    "example": "_mechanism",
    "examples": "_mechanism",
    "Page": "_page",
    "Fact": "_report",
    "Finding": "_report",
    "Quantity": "_report",
    "Report": "_report",
    "Result": "_result",
    "Optimum": "_study",
    "optimise": "_study",
    "sweep": "_study",
}

__all__ = [
    "Fact",
    "Finding",
    "Info",
    "InputError",
    "InputTypeError",
    "InternalError",
    "Kinematics",
    "LinearModel",
    "LinkageError",
    "LinkageWarning",
    "Mechanism",
    "MechanismError",
    "Names",
    "Optimum",
    "Page",
    "Quantity",
    "Report",
    "Result",
    "Simulation",
    "SimulationError",
    "State",
    "Validation",
    "Variable",
    "build",
    "check",
    "example",
    "examples",
    "info",
    "optimise",
    "package",
    "sweep",
    "validate",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f".{_LAZY[name]}", __name__)
    value = module if name == "build" else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
