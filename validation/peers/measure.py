"""One point of a curve: error, run time and set-up time; and the timer."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class Point:
    """Result of one setting of one method. Times in s, errors in rad; evaluations of the right-hand side, if known."""

    scene: str
    tool: str
    method: str
    setting: str
    error: float
    run: float
    setup: float
    evaluations: int | None = None


class LeftOutError(Exception):
    """A tool that is not installed, with the package that contains it."""


SLICE = 1e-3
"""Runs longer than this are timed with the processor's clock, as other programs may interrupt them [s]."""


def fastest(run: Callable[[], Value]) -> tuple[Value, float]:
    """Result and time of the fastest of at least three runs [s], repeated for 60 ms, or for 1 s if one takes long."""
    best, count, began = math.inf, 0, time.perf_counter()
    while True:
        start, used = time.perf_counter(), time.process_time()
        value = run()
        now = time.perf_counter()
        seconds = now - start
        best = min(best, seconds if seconds < SLICE else time.process_time() - used)
        count += 1
        if (now - began > 0.06 and count >= 3) or now - began > 1.0:
            return value, best
