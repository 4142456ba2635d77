"""The forms in which a definition can be given."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any, TypeGuard

from . import _engine
from ._errors import InputError, file, wrong
from ._report import Report, report

#: Form of a definition: a path, a dictionary, or the text of a file.
Source = str | os.PathLike[str] | Mapping[str, Any]


def is_text(source: Source) -> TypeGuard[str | Mapping[str, Any]]:
    """Whether a definition is a dict or the text of a file, not a path."""
    return isinstance(source, Mapping) or (isinstance(source, str) and source.lstrip().startswith("{"))


def read(source: Source) -> tuple[str, str, str]:
    """Kind, place and text of a definition."""
    if is_text(source):
        text = source if isinstance(source, str) else as_json("source", source)
    elif isinstance(source, str | os.PathLike):
        return _engine.read(file("source", source))
    else:
        wrong("source", source, "a path, a dict or a text")
    try:
        return _engine.kind_of(text), "definition", text
    except UnicodeEncodeError as error:
        raise InputError(f"source: the text contains a character that UTF-8 cannot represent: {error}") from None


def check(source: Source) -> Report:
    """Check a definition of a mechanism. Return a `Report` with all errors and warnings, and with computed facts about
    the mechanism. The function `check` raises no exception for a definition with errors.

    Args:
        source: definition of the mechanism: path of a definition file, of a folder with a definition file, or of an
            FMU. The definition can also be a dict or a JSON text.

    Raises:
        InputError: no definition exists at the path in `source`.
    """
    kind, shown, text = read(source)
    return report(kind, text, shown)


def as_json(argument: str, stated: Mapping[str, Any]) -> str:
    """A dict as JSON text. Arrays and numbers of numpy become lists and numbers.

    Raises:
        InputError: the dict contains a value that JSON has not, such as a set or NaN.
    """
    try:
        return json.dumps(stated, indent=2, ensure_ascii=False, allow_nan=False, default=_plain)
    except (TypeError, ValueError, RecursionError) as error:
        if "JSON compliant" in str(error):
            raise InputError(f"{argument}: {_not_finite(stated)}: must be a finite number") from None
        raise InputError(f"{argument}: the dict cannot be written as JSON: {error}") from None


def _plain(value: Any) -> Any:  # noqa: ANN401
    """An array or a number of numpy as a list or a number of Python."""
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a value of the type {type(value).__name__} has no form in JSON")


def _not_finite(value: Any, path: str = "") -> str | None:  # noqa: ANN401
    """Path and value of the first number that is not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        return f"{path} = {value}"
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        return _not_finite(value.tolist(), path)
    parts = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list | tuple) else ()
    found = (_not_finite(part, f"{path}.{key}" if path else str(key)) for key, part in parts)
    return next((line for line in found if line is not None), None)
