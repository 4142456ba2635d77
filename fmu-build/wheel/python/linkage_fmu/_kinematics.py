"""A mechanism along its travel, without time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError, require, wrong
from ._mechanism import Mechanism, StartValue

if TYPE_CHECKING:
    import pandas

Array = np.ndarray[Any, np.dtype[np.float64]]

# Quantities that depend on the position, and on the inputs at rest.
_OF_POSITION = ("angle", "position", "length", "x", "y")
_OF_MASSES = ("reduced_mass", "reduced_inertia", "holding_force", "holding_torque")


class Kinematics:
    """Values of outputs at positions along the travel of the mechanism (result of `Mechanism.kinematics`). For
    example, `kinematics["crank.angle"]` is an array with one angle for each position."""

    def __init__(self, names: list[str], table: Array, units: dict[str, str]) -> None:
        #: Names of the outputs in the result of `kinematics`.
        self.names = names
        #: Unit of each output.
        self.units = units
        self._values = {name: table[:, 1 + k] for k, name in enumerate(names)}
        self._rates = {name: table[:, 1 + len(names) + k] for k, name in enumerate(names)}
        self._second = {name: table[:, 1 + 2 * len(names) + k] for k, name in enumerate(names)}

    def __getitem__(self, name: str) -> Array:
        """Values of an output, at rest, in SI units."""
        self._known(name)
        return self._values[name]

    def influence(self, of: str, by: str) -> Array:
        """Return the influence coefficient d(of) / d(by) at each position. The influence coefficient is infinite at
        positions in which `by` has a dead centre.

        Raises:
            InputError: the result does not contain an output with the given name.
        """
        self._known(of)
        self._known(by)
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = self._rates[of] / self._rates[by]
        return found

    def second_influence(self, of: str, by: str) -> Array:
        """Return the second influence coefficient d2(of) / d(by)2 at each position. If `of` or `by` is not a position,
        the second influence coefficient is NaN.

        The acceleration of `of` is `influence(of, by)` times the acceleration of `by`, plus `second_influence(of, by)`
        times the square of the speed of `by`.

        Raises:
            InputError: the result does not contain an output with the given name.
        """
        ratio = self.influence(of, by)
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = (self._second[of] - ratio * self._second[by]) / self._rates[by] ** 2
        return found

    def to_pandas(self) -> pandas.DataFrame:
        """Return the values of the outputs as a pandas data frame with one row for each position."""
        require("pandas")
        import pandas

        frame = pandas.DataFrame(self._values)
        frame.attrs["units"] = self.units
        return frame

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self._values[self.names[0]]) if self.names else 0

    def __repr__(self) -> str:
        return f"<Kinematics: {len(self)} positions of {', '.join(self.names)}>"

    def _repr_html_(self) -> str:
        from ._html import variables

        columns = [(name, self.units[name], self._values[name]) for name in self.names]
        return variables(f"Kinematics at {len(self)} positions of the travel", columns, "to_pandas() shows all outputs")

    def _known(self, name: str) -> None:
        if not isinstance(name, str) or name not in self._values:
            from ._result import _unknown

            raise InputError(_unknown(name, self.names))


def kinematics(
    mechanism: Mechanism, count: int, outputs: Iterable[str] | None, start_values: Mapping[str, StartValue] | None
) -> Kinematics:
    """See `Mechanism.kinematics`."""
    variables = {own.name: own for own in mechanism.variables}
    if outputs is None:
        all_outputs = [own.name for own in variables.values() if own.causality == "output"]
        names = [name for name in all_outputs if name.rpartition(".")[2] in _OF_POSITION + _OF_MASSES]
    else:
        try:
            names = [] if isinstance(outputs, str) else list(outputs)
        except TypeError:
            names = []
        if not names:
            wrong("outputs", outputs, "a list of names")
    flat = mechanism._model.travel(count, names, start_values)
    table = np.frombuffer(flat).reshape(-1, 1 + 3 * len(names))
    return Kinematics(names, table, {name: variables[name].unit for name in names})
