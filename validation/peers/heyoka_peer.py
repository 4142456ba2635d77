"""heyoka: Taylor's method with an order chosen for the tolerance, compiled for the equation of motion at set-up.

Scalar, and in batches of as many runs as the processor's vectors have elements; the time of a batch is divided by the
number of its runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from types import FunctionType

import four_bar
import heyoka
import numpy as np
from four_bar import EXACT, SPAN, START
from measure import Point, fastest
from numpy.typing import NDArray

TOOL = "heyoka"
Run = Callable[[], float]


def equation() -> list[tuple[heyoka.expression, heyoka.expression]]:
    """The hand-written equation of motion as an expression of heyoka, by means of heyoka's functions."""
    functions = {name: getattr(heyoka, name) for name in ("cos", "sin", "sqrt")}
    acceleration = FunctionType(four_bar.acceleration.__code__, vars(four_bar) | functions)
    theta2, omega = heyoka.make_vars("theta2", "omega")
    return [(theta2, omega), (omega, acceleration(theta2, omega))]


def scalar(tolerance: float) -> Run:
    """One run."""
    start: NDArray[np.float64] = np.array(START)
    solver = heyoka.taylor_adaptive(equation(), list(START), tol=tolerance)

    def run() -> float:
        solver.time = 0.0
        solver.state[:] = start
        solver.propagate_until(SPAN)
        return float(solver.state[0])

    return run


def batch(tolerance: float, size: int) -> Run:
    """`size` runs at once, all with the same initial state; returns the angle with the largest error."""
    start = np.tile(np.array(START)[:, None], (1, size))
    solver = heyoka.taylor_adaptive_batch(equation(), start.copy(), tol=tolerance)

    def run() -> float:
        solver.set_time(0.0)
        solver.state[:] = start
        solver.propagate_until(SPAN)
        angles = solver.state[0]
        return float(angles[np.argmax(np.abs(angles - EXACT))])

    return run


def points() -> Iterator[Point]:
    """Both curves. The set-up time is that of the expression and its compilation."""
    size = heyoka.recommended_simd_size()
    for exponent in range(2, 13):
        tolerance = 10.0**-exponent
        for method, runs in (("Taylor", 1), (f"Taylor; batch of {size}", size)):
            began = time.perf_counter()
            run = scalar(tolerance) if runs == 1 else batch(tolerance, runs)
            setup = time.perf_counter() - began
            angle, seconds = fastest(run)
            yield Point("S1", TOOL, method, f"tolerance {tolerance:.0e}", abs(angle - EXACT), seconds / runs, setup)
