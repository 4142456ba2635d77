"""An oil spring and its leak: F' = -stiffness v - F / leak_time, exact under a speed held over the step."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class OilSpring(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.speed, self.force, self.stiffness, self.leak_time = 0.0, 1000.0, 2e6, 0.02
        self.register_variable(Real("speed", causality=Fmi2Causality.input))
        self.register_variable(Real("force", causality=Fmi2Causality.output))
        for name in ("stiffness", "leak_time"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))

    def do_step(self, current_time, step_size):
        rest = -self.stiffness * self.leak_time * self.speed
        self.force = rest + (self.force - rest) * math.exp(-step_size / self.leak_time)
        return True
