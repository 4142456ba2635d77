"""Exceptions of the package."""

from __future__ import annotations

# Not from typing, whose import takes longer than that of this package.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any, NoReturn

    from ._report import Report
    from ._result import Result


class LinkageError(Exception):
    """Base class of all exceptions of the package. The text of an exception states the quantity, the value, the limit
    and the remedy."""


class InputError(LinkageError, ValueError):
    """An argument is wrong: a name is unknown, a value is out of range or not finite, or a unit or array shape is
    wrong."""


class InputTypeError(InputError, TypeError):
    """An argument has a wrong type, for example a number instead of a list of names."""


class MechanismError(LinkageError, ValueError):
    """The definition of a mechanism contains errors. The attribute `report` of the exception contains all findings."""

    def __init__(self, report: Report) -> None:
        super().__init__(str(report))
        self.report = report


class SimulationError(LinkageError, RuntimeError):
    """A simulation cannot start or cannot continue. After a call of `simulate`, the attribute `result` of the exception
    contains the rows up to the end of the simulation."""

    result: Result | None = None


class InternalError(LinkageError, RuntimeError):
    """An internal error of the package. The Python interpreter continues after the error. Please report an internal
    error."""


class LinkageWarning(UserWarning):
    """A warning about a definition or a simulation."""


def wrong(argument: str, given: Any, expected: str) -> NoReturn:  # noqa: ANN401
    """Raise the exception for an argument with a wrong type."""
    shown = repr(given)
    shown = shown if len(shown) <= 60 else f"{shown[:60]}..."
    raise InputTypeError(f"{argument} = {shown}: must be {expected}")


def require(package: str) -> None:
    """Import a package that the user may not have installed.

    Raises:
        ModuleNotFoundError: the package is not installed.
    """
    try:
        __import__(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        text = f"this call needs the Python package {package}; run: pip install {package}"
        raise ModuleNotFoundError(text, name=package) from None


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
