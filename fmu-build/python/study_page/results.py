"""The data of the pictures: successful runs, effects, surfaces, Sobol's indices. The module must not know plotting."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
from numpy.typing import NDArray
from plot import unit_with_prefix
from SALib.analyze import sobol
from scipy.interpolate import LinearNDInterpolator

Array = NDArray[np.float64]

ROUNDING = 1e-12
"""Relative difference up to which values of different runs count as equal."""
MOST_LEVELS = 30
"""Up to this number of different values of a factor, each value is a separate level."""
BINS = 12
"""Number of equally filled bins of a factor with more values."""
MOST_POINTS = 4000
"""Largest number of runs that are drawn as points. Of more runs, equally spaced ones are drawn."""
CELLS = 60
"""Number of cells of a surface along each side."""
RESAMPLES = 200
"""Number of resamplings for the intervals of Sobol's indices."""


def bins(values: NDArray[np.float64]) -> int | str:
    """Bins of a histogram of these values."""
    return "auto" if len(values) < 2000 else 50


@dataclass(frozen=True)
class Effect:
    """A response over a factor: mean and standard deviation of the runs at each level."""

    places: Array
    means: Array
    deviations: Array

    @property
    def size(self) -> float:
        """Largest mean minus smallest mean."""
        return float(np.ptp(self.means))


@dataclass(frozen=True)
class Surface:
    """A response over two factors."""

    names: tuple[str, str]
    x: Array
    y: Array
    values: Array
    how: str


@dataclass(frozen=True)
class Indices:
    """Sobol's indices of a response, with their half intervals of 95 %."""

    names: list[str]
    first: Array
    first_interval: Array
    total: Array
    total_interval: Array
    points: int


@dataclass(frozen=True)
class Results:
    """Runs of a study that did not fail."""

    plan: dict[str, Any]
    factors: dict[str, Array]
    """Numeric factors that change."""
    responses: dict[str, Array]
    """Responses that change and have a value in some runs."""
    labels: dict[str, str]
    """Names with units, which have a prefix if the values have it too."""
    violation: Array | None
    numbers: Array
    """Numbers of the runs."""
    runs: int
    failed: int
    whole: dict[str, Array]
    """All numeric columns, including failed runs."""

    @classmethod
    def read(cls, path: Path, plan: dict[str, Any]) -> Results:
        """Read a table."""
        table = pyarrow.parquet.read_table(path)
        failed = np.array(table["failed"], dtype=bool)
        numeric = [name for name, is_number in zip(plan["factors"], plan["numbers"], strict=True) if is_number]
        whole = {name: np.array(table[name], dtype=float) for name in [*numeric, *plan["responses"]]}
        good = ~failed

        def changing(name: str) -> bool:
            values = whole[name][good]
            values = values[np.isfinite(values)]
            # Values that differ only by rounding count as constant.
            return values.size > 1 and bool(np.ptp(values) > ROUNDING * np.abs(values).max())

        units = json.loads((table.schema.metadata or {}).get(b"linkage_fmu.units", b"{}"))
        labels = {}
        for name, values in whole.items():
            known = values[good & np.isfinite(values)]
            unit, factor = unit_with_prefix(units.get(name, "1"), float(np.abs(known).max(initial=0.0)))
            whole[name] = factor * values
            labels[name] = name if unit == "1" else f"{name} [{unit}]"
        listed = [name for name in plan["responses"] if not name.endswith(".time") and name != "violation"]
        return cls(
            plan,
            {name: whole[name][good] for name in numeric if changing(name)},
            {name: whole[name][good] for name in listed if changing(name)},
            labels,
            whole["violation"][good] if "violation" in whole else None,
            np.array(table["run"])[good],
            len(failed),
            int(failed.sum()),
            whole,
        )

    def thinned(self) -> NDArray[np.int64]:
        """Indices of the runs that are drawn as points."""
        count = len(self.numbers)
        if count <= MOST_POINTS:
            return np.arange(count)
        return np.linspace(0, count - 1, MOST_POINTS).astype(np.int64)

    def effect(self, factor: str, response: str) -> Effect:
        """Mean response as a function of a factor, over all values of the other factors."""
        x, y = self.factors[factor], self.responses[response]
        good = np.isfinite(y)
        x, y = x[good], y[good]
        levels = np.unique(x)
        if len(levels) > MOST_LEVELS:
            edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, BINS + 1)))
            groups = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
        else:
            groups = np.searchsorted(levels, x)
        known = np.unique(groups)
        parts = [y[groups == group] for group in known]
        places = np.array([x[groups == group].mean() for group in known])
        return Effect(places, np.array([part.mean() for part in parts]), np.array([part.std() for part in parts]))

    def strongest(self, response: str) -> list[str]:
        """Factors, sorted by their effect on a response, the largest first."""
        return sorted(self.factors, key=lambda factor: -self.effect(factor, response).size)

    def surface(self, response: str) -> Surface | None:
        """A response over its two strongest factors. None if fewer than two factors change, or if there are too few
        runs."""
        names = self.strongest(response)[:2]
        if len(names) < 2:
            return None
        z = self.responses[response]
        good = np.isfinite(z)
        all_x = np.column_stack([values[good] for values in self.factors.values()])
        z = z[good]
        a, b = (self.factors[name][good] for name in names)
        x, y = (np.linspace(values.min(), values.max(), CELLS) for values in (a, b))
        grid_x, grid_y = np.meshgrid(x, y)
        if len(self.factors) == 2:
            points = np.column_stack([(a - a.min()) / np.ptp(a), (b - b.min()) / np.ptp(b)])
            if len(points) < 4:
                return None
            value = LinearNDInterpolator(points, z)((grid_x - a.min()) / np.ptp(a), (grid_y - b.min()) / np.ptp(b))
            return Surface((names[0], names[1]), x, y, value, "linear interpolation between the runs")
        middle, half = all_x.mean(axis=0), np.ptp(all_x, axis=0) / 2.0
        terms = quadratic((all_x - middle) / half)
        if len(z) <= terms.shape[1]:
            return None
        fitted, *_ = np.linalg.lstsq(terms, z, rcond=None)
        explained = 1.0 - np.var(z - terms @ fitted) / np.var(z)
        places = np.zeros((grid_x.size, all_x.shape[1]))
        for name, values in zip(names, (grid_x, grid_y), strict=True):
            index = list(self.factors).index(name)
            places[:, index] = (values.ravel() - middle[index]) / half[index]
        value = (quadratic(places) @ fitted).reshape(grid_x.shape)
        how = f"quadratic fit, R² = {explained:.4f},\nother factors at their means"
        return Surface((names[0], names[1]), x, y, value, how)

    def indices(self, response: str) -> Indices | None:
        """Sobol's indices (Saltelli 2010) by SALib; none without Saltelli's design.

        Points of the design with a failed run are left out whole.
        """
        names = self.plan["sampled"]
        if not self.plan["saltelli"] or self.runs % (len(names) + 2) or len(names) != len(self.plan["factors"]):
            return None
        y = self.whole[response].reshape(-1, len(names) + 2)
        y = y[np.isfinite(y).all(axis=1)]
        if len(y) < 8 or np.ptp(y) == 0.0:
            return None
        problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
        found = sobol.analyze(
            problem, y.ravel(), calc_second_order=False, num_resamples=RESAMPLES, print_to_console=False, seed=1
        )
        parts = (np.asarray(found[key], dtype=float) for key in ("S1", "S1_conf", "ST", "ST_conf"))
        return Indices(names, *parts, len(y))

    def rows_of_indices(self) -> Iterator[list[str | float]]:
        """Sobol's indices as rows of a table after the names of its columns. No row without Saltelli's design."""
        for number, response in enumerate(self.responses):
            indices = self.indices(response)
            if indices is None:
                return
            if number == 0:
                yield ["response", "factor", "first", "first_interval", "total", "total_interval"]
            columns = (indices.first, indices.first_interval, indices.total, indices.total_interval)
            for name, *values in zip(indices.names, *(column.tolist() for column in columns), strict=True):
                yield [response, name, *values]


def quadratic(x: Array) -> Array:
    """The terms 1, x_i, x_i x_j of a quadratic polynomial, one row per point."""
    count = x.shape[1]
    products = [x[:, i] * x[:, j] for i in range(count) for j in range(i, count)]
    return np.column_stack([np.ones(len(x)), x, *products])
