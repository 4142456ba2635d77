"""Many runs of one mechanism."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _engine
from ._errors import InputError, LinkageWarning, wrong
from ._result import Result

if TYPE_CHECKING:
    from ._mechanism import Mechanism

#: Largest number of bytes of a result.
MOST_BYTES = 2e9


def simulate_many(
    mechanism: Mechanism,
    start_values: Mapping[str, Any],
    stop_time: float | None,
    output: Iterable[str] | None,
    threads: int | None,
) -> Result:
    """Outputs of each run at the stop time."""
    if not isinstance(start_values, Mapping):
        wrong("start_values", start_values, "a dict of names and values")
    shared: dict[str, Any] = {}
    varied: dict[str, np.ndarray[Any, Any]] = {}
    for name, given in start_values.items():
        try:
            is_one = isinstance(given, str | bytes) or np.ndim(given) == 0
        except ValueError:
            # Entries of different lengths.
            is_one = False
        if is_one:
            shared[name] = given
        else:
            varied[name] = _column(name, given)
    if not varied:
        raise InputError("start_values: no value is an array; give an array with one number for each run")
    counts = {name: len(column) for name, column in varied.items()}
    if len(set(counts.values())) > 1:
        stated = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise InputError(f"start_values: the arrays have different lengths ({stated}); give one number for each run")
    columns = mechanism._recorded(list(output) if output is not None and not isinstance(output, str) else output)
    names = [name for name in columns.dtype.names or () if name != "time"]
    count = next(iter(counts.values()))
    if (bytes_needed := 8.0 * count * (len(varied) + len(names))) > MOST_BYTES:
        raise InputError(
            f"start_values: {count} runs with {len(names)} outputs need {bytes_needed / 1e9:.1f} GB, but a result has "
            f"at most {MOST_BYTES / 1e9:.1f} GB; give fewer runs or fewer outputs"
        )
    rows = np.column_stack(list(varied.values()))
    raw, remarks = _engine.many(
        mechanism._model, list(varied), rows.tobytes(), stop_time, columns.plan, shared, threads
    )
    values = np.frombuffer(raw).reshape(count, len(names))
    # A Boolean of a failed run has no value.
    has_nan = {name: np.isnan(values[:, place]).any() for place, name in enumerate(names)}
    types = [
        (name, np.dtype(np.float64) if name in varied or has_nan[name] else columns.dtype[name])
        for name in dict.fromkeys([*varied, *names])
    ]
    result: Result = np.empty(count, dtype=types).view(Result)
    result.units, result._origin = dict(columns.units), None
    result.units.pop("time")
    fields = result.view(np.ndarray)
    for place, name in enumerate(names):
        fields[name] = values[:, place]
    units = {variable.name: variable.unit for variable in mechanism.variables} if varied.keys() - set(names) else {}
    for name, column in varied.items():
        fields[name] = column
        result.units.setdefault(name, units.get(name, "1"))
    if remarks:
        run, reason = remarks[0]
        given = ", ".join(f"{name} = {column[run]!s}" for name, column in varied.items())
        warnings.warn(
            f"{len(remarks)} of {count} runs have outputs without a value (NaN). Run {run} ({given}): {reason}",
            LinkageWarning,
            stacklevel=3,
        )
    return result


def _column(name: str, given: Any) -> np.ndarray[Any, Any]:  # noqa: ANN401
    """Start values of one variable, one number per run."""
    try:
        column = np.asarray(given)
    except ValueError:
        # Entries of different lengths.
        column = np.empty((0, 0))
    if column.ndim != 1 or not len(column) or column.dtype.kind not in "fiu":
        raise InputError(f"start_values: {name} must be one number, or one column of numbers with one for each run")
    return column.astype(np.float64)
