"""SciPy: its Python integrators (`solve_ivp`) and its compiled ones (`ode`, `odeint`) with the closed form."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import four_bar
import numba
import numpy as np
import scipy.integrate
from four_bar import EXACT, SPAN, START
from measure import Point, fastest
from numpy.typing import NDArray

TOOL = "SciPy"
Rate = Callable[[float, NDArray[np.float64]], object]
Outcome = tuple[float, int]
"""Value of theta2 at the end, and evaluations of the right-hand side."""


def plain(_t: float, y: NDArray[np.float64]) -> tuple[float, float]:
    """The rates of theta2 and omega, in plain Python."""
    theta2, omega = y.tolist()
    return omega, four_bar.acceleration(theta2, omega)


def compiled() -> tuple[Rate, float]:
    """The rates compiled by numba, and the compilation time [s]."""
    began = time.perf_counter()
    acceleration = numba.njit(four_bar.acceleration)

    @numba.njit
    def rate(_t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        out = np.empty(2)
        out[0] = y[1]
        out[1] = acceleration(y[0], y[1])
        return out

    rate(0.0, np.array(START))
    return rate, time.perf_counter() - began


def by_solve_ivp(method: str) -> Callable[[Rate, float, float], Outcome]:
    """A method of `solve_ivp`."""

    def run(rate: Rate, rtol: float, atol: float) -> Outcome:
        solution = scipy.integrate.solve_ivp(
            rate, (0.0, SPAN), START, method=method, t_eval=(SPAN,), rtol=rtol, atol=atol
        )
        if not solution.success:
            raise RuntimeError(solution.message)
        return float(solution.y[0, -1]), int(solution.nfev)

    return run


def by_ode(method: str) -> Callable[[Rate, float, float], Outcome]:
    """A compiled explicit Runge-Kutta method."""

    def run(rate: Rate, rtol: float, atol: float) -> Outcome:
        solver = scipy.integrate.ode(rate).set_integrator(method, rtol=rtol, atol=atol, nsteps=1_000_000)
        end = solver.set_initial_value(START, 0.0).integrate(SPAN)
        if not solver.successful():
            raise RuntimeError(f"{method} failed")
        return float(end[0]), 0

    return run


def by_odeint(rate: Rate, rtol: float, atol: float) -> Outcome:
    """Compiled LSODA, without the Python layer of `solve_ivp`."""
    states, info = scipy.integrate.odeint(
        rate, START, (0.0, SPAN), rtol=rtol, atol=atol, tfirst=True, full_output=True, mxstep=100_000, tcrit=(SPAN,)
    )
    return float(states[-1, 0]), int(info["nfe"][-1])


Solve = Callable[[Rate, float, float], Outcome]
METHODS: list[tuple[str, Solve, int, bool]] = [
    ("solve_ivp DOP853", by_solve_ivp("DOP853"), 26, False),
    ("solve_ivp LSODA", by_solve_ivp("LSODA"), 24, False),
    ("solve_ivp Radau", by_solve_ivp("Radau"), 22, False),
    ("ode dop853", by_ode("dop853"), 26, False),
    ("solve_ivp DOP853 + numba", by_solve_ivp("DOP853"), 26, True),
    ("ode dopri5 + numba", by_ode("dopri5"), 26, True),
    ("ode dop853 + numba", by_ode("dop853"), 26, True),
    ("odeint + numba", by_odeint, 24, True),
]
"""Methods, each with twice the negative exponent of the tightest tolerance, and whether numba compiles the right-hand
side."""


def points() -> Iterator[Point]:
    """All curves."""
    fast, compilation = compiled()
    for name, solve, last, numbas in METHODS:
        rate, setup = (fast, compilation) if numbas else (plain, 0.0)
        for half in range(4, last + 1):
            for ratio in (1.0, 1e-2):
                rtol = 10 ** (-half / 2)
                setting = f"rtol {rtol:.1e} atol {ratio * rtol:.1e}"
                try:
                    (theta2, evaluations), seconds = fastest(partial(solve, rate, rtol, ratio * rtol))
                except (ValueError, RuntimeError) as error:
                    print(f"{TOOL} {name} {setting}: {error}")
                    continue
                yield Point("S1", TOOL, name, setting, abs(theta2 - EXACT), seconds, setup, evaluations or None)
