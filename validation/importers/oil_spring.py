"""An oil spring with leakage: F' = -stiffness v - F / leak_time, exact for a constant speed in each step."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class OilSpring(Fmi2Slave):
    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        self.speed, self.force, self.stiffness, self.leak_time = 0.0, 1000.0, 2e6, 0.02
        self.register_variable(Real("speed", causality=Fmi2Causality.input))
        self.register_variable(Real("force", causality=Fmi2Causality.output))
        for name in ("stiffness", "leak_time"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))

    def do_step(self, _current_time: float, step_size: float) -> bool:
        rest = -self.stiffness * self.leak_time * self.speed
        self.force = rest + (self.force - rest) * math.exp(-step_size / self.leak_time)
        return True
