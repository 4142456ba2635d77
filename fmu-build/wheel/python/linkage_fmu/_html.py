"""Tables and curves for notebooks, in the light or dark colours of the surrounding page."""

from __future__ import annotations

import html
from collections.abc import Iterable
from typing import Any

import numpy as np

#: Largest number of rows of a table of variables.
MOST_ROWS = 30
#: Width and height of a curve [px], and largest number of points from left to right.
WIDTH, HEIGHT, POINTS = 120.0, 22.0, 120


class Html(str):
    """A text that is HTML already."""

    __slots__ = ()


def table(caption: str, rows: Iterable[Iterable[str]], head: Iterable[str] = ()) -> str:
    """A table with a caption. All texts are escaped, except `Html`."""
    return (
        f"<table><caption style='text-align:left'>{_text(caption)}</caption>"
        f"{_row('th', head)}{''.join(_row('td', row) for row in rows)}</table>"
    )


def variables(caption: str, columns: Iterable[tuple[str, str, np.ndarray[Any, Any]]], remedy: str) -> str:
    """A table of variables with names, units and values, one row each. `remedy` states how to show all of them."""
    shown = list(columns)
    if len(shown) > MOST_ROWS:
        caption += f" ({MOST_ROWS} of {len(shown)} variables; {remedy})"
    rows = [[name, "" if unit == "1" else unit, *_extremes(values)] for name, unit, values in shown[:MOST_ROWS]]
    return table(caption, rows, ("", "unit", "first", "last", "minimum", "maximum", ""))


def number(value: float) -> str:
    """A number with at most six digits."""
    # Adding 0 removes the sign of a negative zero.
    return f"{value + 0.0:.6g}"


def _text(text: str) -> str:
    return text if isinstance(text, Html) else html.escape(text)


def _row(kind: str, cells: Iterable[str]) -> str:
    style = "text-align:left;vertical-align:top;white-space:pre-wrap"
    shown = "".join(f"<{kind} style='{style}'>{_text(cell)}</{kind}>" for cell in cells)
    return f"<tr>{shown}</tr>" if shown else ""


def _extremes(values: np.ndarray[Any, Any]) -> list[str]:
    """First, last, smallest and largest value of a column, and its curve."""
    if values.dtype == np.bool_:
        ends = [str(bool(value)) for value in (values[0], values[-1])]
        return [*ends, "", "", Html(_curve(values.astype(float)))]
    finite = values[np.isfinite(values)]
    extremes = [number(finite.min()), number(finite.max())] if finite.size else ["", ""]
    return [number(values[0]), number(values[-1]), *extremes, Html(_curve(values))]


def _curve(values: np.ndarray[Any, Any]) -> str:
    """Values from left to right as a line. A value that is not finite interrupts the line."""
    each = -(-len(values) // POINTS)
    if each > 1:
        # Several values at one position: a line from the smallest to the largest.
        groups = np.pad(values, (0, -len(values) % each), mode="edge").reshape(-1, each)
        values = np.column_stack([np.fmin.reduce(groups, axis=1), np.fmax.reduce(groups, axis=1)]).ravel()
    finite = np.isfinite(values)
    if len(values) < 2 or not finite.any():
        return ""
    # Half values are used, because the difference of two numbers may overflow.
    low, high = values[finite].min() / 2, values[finite].max() / 2
    parts, is_on = [], False
    for k, (value, is_drawn) in enumerate(zip(values, finite, strict=True)):
        if is_drawn:
            share = (high - value / 2) / (high - low) if high > low else 0.5
            x, y = WIDTH * k / (len(values) - 1), 1 + (HEIGHT - 2) * share
            parts.append(f"{'L' if is_on else 'M'}{x:.1f} {y:.1f}")
        is_on = bool(is_drawn)
    return (
        f"<svg width='{WIDTH:.0f}' height='{HEIGHT:.0f}' viewBox='0 0 {WIDTH:.0f} {HEIGHT:.0f}'>"
        f"<path d='{''.join(parts)}' fill='none' stroke='currentColor'/></svg>"
    )
