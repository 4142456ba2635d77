"""Small motions about rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._mechanism import Mechanism, StartValue

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class LinearModel:
    """Linear model of small motions of a mechanism about one position at rest: x' = A x + B u, y = C x + D u. The
    state x consists of one coordinate of the mechanism, the time derivative of this coordinate, and the states of
    controllers."""

    #: Name of the coordinate in the state x.
    coordinate: str
    #: Names of the inputs u of the linear model.
    inputs: tuple[str, ...]
    #: Names of the outputs y of the linear model.
    outputs: tuple[str, ...]
    #: Value of the coordinate at the position about which the linear model is valid [rad or m].
    position: float
    #: Acceleration of the coordinate [rad/s2 or m/s2]. The acceleration of the coordinate is 0 at an equilibrium.
    acceleration: float
    #: Value of the input that keeps the mechanism at rest [N or N.m]. Without the argument `held_by`, the attribute
    #: `holding` is None.
    holding: float | None
    #: Eigenfrequency of small undamped motions about the position [Hz]. The eigenfrequency is NaN if the small motions
    #: are not oscillations.
    eigenfrequency: float
    #: Damping ratio of small motions about the position [1]. The damping ratio is NaN if the small motions are not
    #: oscillations.
    damping_ratio: float
    #: Eigenvalues of the linear model [1/s].
    eigenvalues: tuple[complex, ...]
    #: Matrix A of x' = A x + B u, with one row and one column for each state.
    A: Array
    #: Matrix B of x' = A x + B u, with one row for each state and one column for each input.
    B: Array
    #: Matrix C of y = C x + D u, with one row for each output and one column for each state.
    C: Array
    #: Matrix D of y = C x + D u, with one row for each output and one column for each input.
    D: Array

    def __iter__(self) -> Any:  # noqa: ANN401
        """The matrices A, B, C, D, for `scipy.signal.StateSpace(*model)`."""
        return iter((self.A, self.B, self.C, self.D))


def linearise(
    mechanism: Mechanism,
    what: tuple[str | None, Sequence[str], Sequence[str], str | None],
    count: int | None,
    start_values: Mapping[str, StartValue] | None,
) -> list[LinearModel]:
    """See `Mechanism.linearise`."""
    found = mechanism._model.linearise(what, count, start_values)
    name, u, y, all_at = found
    models = []
    for at in all_at:
        eigenvalues = tuple(complex(*pair) for pair in at.pop("eigenvalues"))
        a, b, c, d = (np.array(at.pop(key), dtype=float) for key in "abcd")
        b, d = b.reshape(len(a), len(u)), d.reshape(len(y), len(u))
        models.append(LinearModel(name, tuple(u), tuple(y), eigenvalues=eigenvalues, A=a, B=b, C=c, D=d, **at))
    return models
