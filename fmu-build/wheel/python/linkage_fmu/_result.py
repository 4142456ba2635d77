"""Results of runs as numpy arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError, require, wrong

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from ._engine import Plan
    from ._mechanism import Mechanism
    from ._page import Page


#: Times, and the name and values of each input.
Signals = tuple[list[float], list[tuple[str, list[float]]]]


class Columns:
    """Layout of a result, and the units of its columns."""

    __slots__ = ("dtype", "plan", "units")

    def __init__(self, plan: Plan) -> None:
        columns = plan.layout()
        self.plan = plan
        types = [(name, np.bool_ if is_boolean else np.float64) for name, _, is_boolean in columns]
        self.dtype = np.dtype([("time", np.float64), *types])
        self.units = {"time": "s", **{name: unit for name, unit, _ in columns}}

    def result(self, rows: bytearray, origin: tuple[Mechanism, dict[str, Any], bool]) -> Result:
        """The result with these rows."""
        dtype = self.dtype
        result: Result = np.ndarray.__new__(Result, (len(rows) // dtype.itemsize,), dtype, rows)
        result.units, result._origin = self.units, origin
        return result


def signals(given: Any) -> Signals:  # noqa: ANN401
    """Times and columns of inputs over time."""
    if "time" in getattr(getattr(given, "index", None), "names", ()):
        # A data frame as from Result.to_pandas.
        given = given.reset_index()
    names = getattr(getattr(given, "dtype", None), "names", None)
    if names is None and (isinstance(given, dict) or hasattr(given, "columns")):
        names = list(given)
    if not names or "time" not in names:
        wrong(
            "input",
            given,
            'a structured array, a dict of columns or a data frame, with a field "time" [s] and one for each input',
        )
    columns = []
    for name in names:
        try:
            values = np.asarray(given[name])
        except ValueError:
            # Entries of different lengths.
            values = np.empty((0, 0))
        if values.ndim != 1 or values.dtype.kind not in "fiub":
            raise InputError(f"input: {name} must be one column of numbers or truth values")
        columns.append((str(name), values.astype(float).tolist()))
    times = next(values for name, values in columns if name == "time")
    return times, [column for column in columns if column[0] != "time"]


class Result(np.ndarray[Any, Any]):
    """Result of a simulation: a structured array with the field `time` [s] and one field for each variable, in SI
    units. A result of `simulate_many` has one row for each run, and no field `time`.

    Functions of FMPy for simulation results, such as `fmpy.plot_result`, can process a `Result`.
    """

    #: Unit of each column.
    units: dict[str, str]
    _origin: tuple[Mechanism, dict[str, Any], bool] | None

    def __array_finalize__(self, other: Any) -> None:  # noqa: ANN401
        if other is not None:
            self.units = getattr(other, "units", {})
            self._origin = getattr(other, "_origin", None)

    @property
    def names(self) -> list[str]:
        """Names of the columns of the result. The first column of a result of `simulate` is `time`."""
        return list(self.dtype.names or ())

    def __getitem__(self, key: Any) -> Any:  # noqa: ANN401
        if isinstance(key, str):
            if key not in (self.dtype.names or ()):
                raise InputError(_unknown(key, self.names))
            return self.view(np.ndarray)[key]
        return super().__getitem__(key)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the result as a pandas data frame. The index of the data frame is the time. For a result of
        `simulate_many`, the index of the data frame is the number of the run. The attribute `attrs["units"]` of the
        data frame contains the units of the columns."""
        require("pandas")
        import pandas

        if "time" in self.names:
            index = pandas.Index(self["time"], name="time")
        else:
            index = pandas.RangeIndex(len(self), name="run")
        columns = {name: self[name] for name in self.names if name != "time"}
        frame = pandas.DataFrame(columns, index=index)
        frame.attrs["units"] = self.units
        return frame

    def plot(self, *names: str, x: str = "time", show: bool = False) -> Figure:
        """Plot variables over time, or over another variable, with matplotlib. The plot contains one diagram for each
        unit.

        Args:
            names: names of the variables to plot. By default, `plot` shows all variables.
            x: name of the variable on the horizontal axis.
            show: if True, `plot` opens a window with the plot.

        Raises:
            InputError: the result does not contain a variable with the given name.
        """
        require("matplotlib")
        from matplotlib import pyplot

        for name in (x, *names):
            if not isinstance(name, str):
                wrong("a name", name, "the name of a variable, a text")
        if not isinstance(show, bool | np.bool_):
            wrong("show", show, "True or False")
        self[x]
        chosen = list(names) or [name for name in self.names if name != x]
        groups: dict[str, list[str]] = {}
        for name in chosen:
            if chosen.count(name) > 1:
                raise InputError(f"names: {name} occurs twice; remove one of the two")
            self[name]
            groups.setdefault(self.units.get(name, "1"), []).append(name)
        figure, axes = pyplot.subplots(
            len(groups), 1, sharex=True, squeeze=False, layout="constrained", figsize=(7.0, 1.2 + 1.8 * len(groups))
        )
        for axis, (unit, own) in zip(axes[:, 0], groups.items(), strict=True):
            for name in own:
                axis.plot(self[x], self[name], label=name)
            axis.set_ylabel(own[0] if unit == "1" and len(own) == 1 else f"[{unit}]")
            axis.legend()
            axis.grid(True)
        axes[-1, 0].set_xlabel(f"{x} [{self.units.get(x, '1')}]")
        if show:
            pyplot.show()
        else:
            # A notebook shows the figure that a cell returns. An open figure would be shown twice.
            pyplot.close(figure)
        return figure

    def animate(self, height: int = 640) -> Page:
        """Return a web page that shows the motion of the mechanism in this simulation. A notebook displays the web page
        in the output of a cell.

        Raises:
            InputError: the inputs of the simulation changed over time. The web page of `animate` can show only constant
                inputs.
        """
        if self._origin is None or not len(self):
            raise InputError("only a complete result of simulate can be animated, not a part of a result")
        mechanism, start_values, has_input = self._origin
        if has_input:
            raise InputError("a run with inputs over time cannot be animated; use mechanism.view(start_values=...)")
        return mechanism.view(float(self["time"][-1]), start_values, height)

    def _repr_html_(self) -> str | None:
        if self.ndim != 1 or not self.dtype.names or not len(self):
            return None
        from ._html import number, variables

        rows = f"{len(self)} rows"
        if "time" in self.dtype.names:
            rows += f" from {number(self['time'][0])} s to {number(self['time'][-1])} s"
        of = f"Result of {self._origin[0].name}: " if self._origin else "Result: "
        columns = [(name, self.units.get(name, "1"), self[name]) for name in self.names if name != "time"]
        # A user may have made an array with other types from this one.
        numbers = [own for own in columns if own[2].ndim == 1 and own[2].dtype.kind in "fiub"]
        return variables(of + rows, numbers, "to_pandas() shows all columns")

    def __reduce__(self) -> Any:  # noqa: ANN401
        return (_restored, (np.asarray(self).copy(), self.units, self._origin))


def _restored(
    values: np.ndarray[Any, Any], units: dict[str, str], origin: tuple[Mechanism, dict[str, Any], bool] | None
) -> Result:
    result: Result = values.view(Result)
    result.units, result._origin = units, origin
    return result


def _unknown(name: str, names: list[str]) -> str:
    from difflib import get_close_matches

    near = get_close_matches(str(name), names, 3, 0.0)
    return f"the result has no variable {name!r}: the most similar names are {', '.join(near)}"
