"""One point of a curve: the error, what it cost; and the clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class Point:
    """What one setting of one method gives. Times in s, errors in rad; evaluations of the right-hand side, if told."""

    scene: str
    tool: str
    method: str
    setting: str
    error: float
    run: float
    setup: float
    evaluations: int | None = None


def fastest(run: Callable[[], Value], once: bool = False) -> tuple[Value, float]:
    """Result and time of the fastest of several runs [s]: of at least three, for 60 ms, or of two if one takes long."""
    best, count, began = math.inf, 0, time.perf_counter()
    while True:
        start = time.perf_counter()
        value = run()
        now = time.perf_counter()
        best = min(best, now - start)
        count += 1
        if once or (now - began > 0.06 and count >= 3) or now - began > 1.0:
            return value, best
