"""Search for the best design of a study: the optimiser behind `cargo fmu optimise`.

The first line of the standard input states the problem; then each line of the standard output asks for the worth of
points of the unit cube, and a line of the standard input answers: costs, and by how much each limit is exceeded.

Three quarters of the budget go to differential evolution, which asks for a generation at once, the rest to COBYQA from
the best point found. Neither needs derivatives, which responses of a run have none of with respect to parameters.
"""

from __future__ import annotations

import json
import math
import signal
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, NonlinearConstraint, differential_evolution, minimize
from scipy.stats import qmc

Array = NDArray[np.float64]

GLOBAL = 0.75
"""Part of the budget for differential evolution."""
MEMBERS = 15
"""Number of members of a generation per factor."""
GENERATIONS = 8
"""Number of generations for which the budget should suffice."""
RADII = (0.1, 1e-6)
"""First and last trust radius of COBYQA, with all factors scaled to 0 ... 1."""
GAIN = 1e-7
"""COBYQA is not restarted if its relative gain is below this value."""
TOLERANCE = 1e-5
"""Differential evolution ends if the relative scatter of the costs of a generation is below this value."""


class OverError(Exception):
    """The budget is used up."""


class Problem:
    """The points that were evaluated, with their values."""

    def __init__(self, stated: dict[str, Any]) -> None:
        self.start = np.array(stated["start"], dtype=float)
        self.limits: int = stated["limits"]
        self.left: int = stated["evaluations"]
        self.seed: int = stated["seed"]
        self.known: dict[bytes, tuple[float, Array]] = {}
        self.points: list[Array] = []
        self.why = ""

    def ask(self, points: Array) -> None:
        """Evaluate these points, one per row, except for known points."""
        new = {point.tobytes(): point for point in points if point.tobytes() not in self.known}
        wanted = list(new.values())[: self.left]
        if wanted:
            print(json.dumps({"points": [point.tolist() for point in wanted]}), flush=True)
            line = sys.stdin.readline()
            if not line:
                sys.exit(0)
            answer = json.loads(line)
            self.left -= len(wanted)
            for point, cost, excess in zip(wanted, answer["costs"], answer["excess"], strict=True):
                worth = (math.inf, np.full(self.limits, math.inf)) if cost is None else (cost, np.array(excess))
                self.known[point.tobytes()] = worth
                self.points.append(point)
        if len(wanted) < len(new):
            raise OverError

    def rows(self, x: Array) -> Array:
        """Points as rows, within the cube. SciPy passes them as columns."""
        return np.ascontiguousarray(np.clip(np.atleast_2d(x.T), 0.0, 1.0))

    def cost(self, x: Array) -> Any:  # noqa: ANN401
        """Costs of points, or the cost of a single point."""
        points = self.rows(x)
        self.ask(points)
        costs = np.array([self.known[point.tobytes()][0] for point in points])
        return costs if x.ndim == 2 else float(costs[0])

    def excess(self, x: Array) -> Array:
        """Excess over each limit: one row per limit."""
        points = self.rows(x)
        self.ask(points)
        excess = np.array([self.known[point.tobytes()][1] for point in points]).T
        return excess if x.ndim == 2 else excess[:, 0]

    def best(self) -> tuple[float, float, Array]:
        """Violation, cost and coordinates of the best point."""

        def rank(point: Array) -> tuple[float, float]:
            cost, excess = self.known[point.tobytes()]
            return max([0.0, *excess]), cost

        point = min(self.points, key=rank)
        return *rank(point), point


def search_everywhere(problem: Problem) -> None:
    """Differential evolution with Lampinen's rules for limits. A whole generation is requested at once."""
    count = len(problem.start)
    members = max(5, min(MEMBERS * count, problem.left // GENERATIONS))
    generations = int(GLOBAL * problem.left / members) - 1
    first = qmc.LatinHypercube(count, rng=problem.seed).random(members)
    first[0] = problem.start
    found = differential_evolution(
        problem.cost,
        [(0.0, 1.0)] * count,
        maxiter=max(generations, 1),
        tol=TOLERANCE,
        rng=problem.seed,
        polish=False,
        init=first,
        updating="deferred",
        vectorized=True,
        constraints=[NonlinearConstraint(problem.excess, -np.inf, 0.0)] if problem.limits else [],
    )
    problem.why = f"differential evolution: {found.nit} generations of {members} designs"


def search_nearby(problem: Problem) -> None:
    """COBYQA from the best point, restarted as long as it gains."""
    rounds = 0
    while True:
        _, before, start = problem.best()
        if not math.isfinite(before):
            return
        rounds += 1
        size = abs(before) or 1.0
        minimize(
            lambda x, size=size: problem.cost(x) / size,
            start,
            method="COBYQA",
            bounds=Bounds(0.0, 1.0),
            constraints=[NonlinearConstraint(problem.excess, -np.inf, 0.0)] if problem.limits else [],
            options={
                "maxfev": problem.left + len(start) * len(start),
                "initial_tr_radius": RADII[0] / 4.0 ** (rounds - 1),
                "final_tr_radius": RADII[1],
                "feasibility_tol": 0.0,
            },
        )
        problem.why = problem.why.partition("; ")[0] + f"; local search by COBYQA: {rounds} times"
        _, after, _ = problem.best()
        if before - after <= GAIN * size:
            return


def main() -> None:
    """Read the problem, search, report the reason for the end of the search."""
    # The program that evaluates the points ends this program.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    problem = Problem(json.loads(sys.stdin.readline()))
    np.seterr(all="ignore")
    try:
        search_everywhere(problem)
        search_nearby(problem)
        problem.why += "; a further search finds no better design"
    except OverError:
        problem.why += "; the allowed number of evaluations is reached"
    print(json.dumps({"end": problem.why.removeprefix("; ")}), flush=True)


if __name__ == "__main__":
    main()
