"""The pictures of a study as PNG, by Matplotlib."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from results import Results, bins

BLUE, ORANGE, RED = "#2f6db3", "#d9822b", "#b3392f"
SIDE = 2.6
"""Size of a panel [in]."""
MOST = 7
"""Largest number of columns of a scatter matrix."""
ACROSS = 2
"""Number of panels per row in the other pictures, so that they are readable on a phone."""


def all_of(results: Results) -> Iterator[tuple[str, Figure]]:
    """Every picture that the results allow, with its name."""
    if results.factors:
        yield "main_effects", main_effects(results)
        yield "scatter_matrix", scatter_matrix(results)
    yield "distributions", distributions(results)
    if (surfaces := response_surfaces(results)) is not None:
        yield "response_surfaces", surfaces
    if (indices := sobol_indices(results)) is not None:
        yield "sobol_indices", indices
    if results.violation is not None and (way := progress(results)) is not None:
        yield "progress", way


def panels(rows: int, columns: int, width: float = SIDE, height: float = SIDE) -> tuple[Figure, np.ndarray]:
    """A figure of panels, and the panels."""
    canvas = Figure(figsize=(max(width * columns, 4.0), max(height * rows, 2.4)), layout="constrained")
    return canvas, canvas.subplots(rows, columns, squeeze=False)


def main_effects(results: Results) -> Figure:
    """Mean of each response over each factor, with the standard deviation of the runs there."""
    columns = min(ACROSS, len(results.factors))
    rows = -(-len(results.factors) // columns)
    canvas, grid = panels(rows * len(results.responses), columns, 2.9, 2.1)
    for k, response in enumerate(results.responses):
        all_axes = grid[k * rows : (k + 1) * rows].flat
        for axes in all_axes[len(results.factors) :]:
            axes.set_visible(False)
        for axes, factor in zip(all_axes, results.factors, strict=False):
            effect = results.effect(factor, response)
            low, high = effect.means - effect.deviations, effect.means + effect.deviations
            axes.fill_between(effect.places, low, high, color=BLUE, alpha=0.18, linewidth=0.0)
            axes.plot(effect.places, effect.means, "o-", color=BLUE, markersize=3)
            labelled(axes, results.labels[factor], results.labels[response], axes in grid[:, 0], True)
        own = all_axes[: len(results.factors)]
        limits = [axes.get_ylim() for axes in own]
        for axes in own:
            axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    canvas.suptitle("Main effects: mean and standard deviation", fontsize=10)
    return canvas


def labelled(axes: Axes, x: str, y: str, is_left: bool, is_low: bool) -> None:
    """Show axis names at the left and lower edges only."""
    axes.tick_params(labelsize=8)
    axes.locator_params(nbins=3)
    axes.ticklabel_format(useOffset=False)
    axes.set_xlabel(x if is_low else "", fontsize=8)
    axes.set_ylabel(y if is_left else "", fontsize=8)


def scatter_matrix(results: Results) -> Figure:
    """Factors and responses against each other."""
    index = results.thinned()
    columns = {**results.factors, **results.responses}
    names = list(columns)[:MOST] if len(columns) > MOST else list(columns)
    if len(columns) > MOST:
        # If there are many factors, the responses must not be omitted.
        strongest = results.strongest(next(iter(results.responses)))
        outputs = list(results.responses)[: MOST // 2]
        names = [*strongest[: MOST - len(outputs)], *outputs]
    canvas, grid = panels(len(names), len(names), 1.7, 1.7)
    for i, row in enumerate(grid):
        for j, axes in enumerate(row):
            x, y = columns[names[j]][index], columns[names[i]][index]
            if i == j:
                known = x[np.isfinite(x)]
                axes.hist(known, bins=24, color=BLUE)
            else:
                axes.plot(x, y, ".", color=BLUE, markersize=2, alpha=0.5, rasterized=True)
            labelled(axes, results.labels[names[j]], results.labels[names[i]], j == 0, i == len(names) - 1)
    canvas.suptitle(f"Scatter matrix, {len(index)} of {results.runs} runs")
    return canvas


def distributions(results: Results) -> Figure:
    """Histogram of each response, with mean and quantiles."""
    columns = min(ACROSS, len(results.responses))
    rows = -(-len(results.responses) // columns)
    canvas, grid = panels(rows, columns, 2.9, 2.3)
    for axes in grid.flat[len(results.responses) :]:
        axes.set_visible(False)
    for axes, (name, values) in zip(grid.flat, results.responses.items(), strict=False):
        values = values[np.isfinite(values)]
        axes.hist(values, bins=bins(values), color=BLUE)
        for value, style in zip(np.quantile(values, (0.01, 0.5, 0.99)), (":", "-", ":"), strict=True):
            axes.axvline(value, color=ORANGE, linestyle=style, linewidth=1.2)
        axes.set_title(f"mean {values.mean():.5g}, deviation {values.std():.3g}", fontsize=8)
        labelled(axes, results.labels[name], "runs", True, True)
    canvas.suptitle("Distributions, with quantiles 1 %, 50 %, 99 %", fontsize=10)
    return canvas


def response_surfaces(results: Results) -> Figure | None:
    """Each response over its two strongest factors."""
    surfaces = {name: surface for name in results.responses if (surface := results.surface(name)) is not None}
    if not surfaces:
        return None
    columns = min(ACROSS, len(surfaces))
    canvas, grid = panels(-(-len(surfaces) // columns), columns, 2.9, 2.6)
    for axes in grid.flat[len(surfaces) :]:
        axes.set_visible(False)
    for axes, (name, surface) in zip(grid.flat, surfaces.items(), strict=False):
        shown = axes.contourf(surface.x, surface.y, np.ma.masked_invalid(surface.values), levels=16, cmap="viridis")
        canvas.colorbar(shown, ax=axes).ax.tick_params(labelsize=8)
        axes.set_title(f"{results.labels[name]}\n{surface.how}", fontsize=8)
        labelled(axes, *(results.labels[factor] for factor in surface.names), True, True)
    canvas.suptitle("Response surfaces over the two strongest factors", fontsize=10)
    return canvas


def sobol_indices(results: Results) -> Figure | None:
    """First and total indices of each response."""
    all_of_them = {name: indices for name in results.responses if (indices := results.indices(name)) is not None}
    if not all_of_them:
        return None
    count = max(len(indices.names) for indices in all_of_them.values())
    columns = min(ACROSS, len(all_of_them))
    canvas, grid = panels(-(-len(all_of_them) // columns), columns, 2.9, 1.3 + 0.42 * count)
    for axes in grid.flat[len(all_of_them) :]:
        axes.set_visible(False)
    for axes, (name, indices) in zip(grid.flat, all_of_them.items(), strict=False):
        places = np.arange(len(indices.names))
        first = {"color": BLUE, "label": "first order", "xerr": indices.first_interval}
        total = {"color": ORANGE, "label": "total", "xerr": indices.total_interval}
        axes.barh(places - 0.2, indices.first, 0.38, **first)
        axes.barh(places + 0.2, indices.total, 0.38, **total)
        axes.set_yticks(places, indices.names, fontsize=8)
        axes.invert_yaxis()
        axes.set_title(f"{name}, {indices.points} points", fontsize=8)
        axes.tick_params(labelsize=8)
        axes.legend(fontsize=8)
    canvas.suptitle("Sobol indices with 95 % confidence intervals", fontsize=10)
    return canvas


def progress(results: Results) -> Figure | None:
    """Objective of the designs in the order in which they were evaluated, and the best so far."""
    name = results.plan["minimise"] or results.plan["maximise"]
    if name not in results.responses or results.violation is None:
        return None
    y, kept = results.responses[name], results.violation <= 0.0
    canvas, grid = panels(1, 1, 5.8, 3.4)
    axes = grid[0][0]
    axes.plot(results.numbers[~kept], y[~kept], ".", color="0.75", markersize=3, label="exceeds a limit")
    axes.plot(results.numbers[kept], y[kept], ".", color=BLUE, markersize=3, label="satisfies all limits")
    if kept.any():
        best = np.minimum if results.plan["minimise"] else np.maximum
        axes.step(results.numbers[kept], best.accumulate(y[kept]), where="post", color=RED, label="best so far")
    axes.set(xlabel="evaluation", ylabel=results.labels[name])
    axes.legend(fontsize=8)
    canvas.suptitle("Progress of the search", fontsize=10)
    return canvas
