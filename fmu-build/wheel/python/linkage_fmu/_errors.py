"""Exceptions of the package."""

from __future__ import annotations

# Not that of typing, whose import takes longer than that of this package.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any, NoReturn

    from ._report import Report
    from ._result import Result


class LinkageError(Exception):
    """Base of all exceptions of this package. The text states the quantity, the value, the limit and the remedy."""


class InputError(LinkageError, ValueError):
    """An argument cannot be used: an unknown name, a value out of range or not finite, a wrong unit or shape."""


class InputTypeError(InputError, TypeError):
    """An argument is of a type that cannot be used, such as a number where a list of names is expected."""


class MechanismError(LinkageError, ValueError):
    """A definition that gives no model. `report` holds all findings."""

    def __init__(self, report: Report) -> None:
        super().__init__(str(report))
        self.report = report


class SimulationError(LinkageError, RuntimeError):
    """A run or a step cannot continue. Of `simulate`, `result` holds the rows up to there."""

    result: Result | None = None


class InternalError(LinkageError, RuntimeError):
    """A fault of the engine itself. The interpreter continues; please report the fault."""


class LinkageWarning(UserWarning):
    """A warning about a definition or a run."""


def wrong(argument: str, given: Any, expected: str) -> NoReturn:  # noqa: ANN401
    """Raise that an argument is of a wrong type."""
    shown = repr(given)
    shown = shown if len(shown) <= 60 else f"{shown[:60]}..."
    raise InputTypeError(f"{argument} = {shown}: must be {expected}")


def file(argument: str, given: Any) -> str:  # noqa: ANN401
    """A path as text.

    Raises:
        InputError: it is none.
    """
    place = given.__fspath__() if hasattr(given, "__fspath__") else given
    if not isinstance(place, str):
        wrong(argument, given, "a path, as a text or a pathlib.Path")
    if "\0" in place:
        raise InputError(f"{argument} = {place!r}: a path has no null character")
    return place
