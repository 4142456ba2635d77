"""FMUs as files."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _engine
from ._definition import Source
from ._errors import file
from ._mechanism import Mechanism


class Info(dict[str, Any]):
    """Interface of an FMU or of a definition: variables, units, platforms and requirements. The content of an `Info`
    object is equal to the output of the command `linkage-fmu info --json`. The function `print` shows the interface as
    a table."""

    def __init__(self, stated: dict[str, Any], text: str) -> None:
        super().__init__(stated)
        self._text = text

    def __str__(self) -> str:
        return self._text.rstrip()


@dataclass(frozen=True)
class Validation:
    """Result of the check of an FMU. The condition `if validation:` is true if the FMU has no error."""

    #: List of errors of the FMU. An FMU with an error cannot be used.
    errors: tuple[str, ...]
    #: List of warnings: properties of the FMU that are probably mistakes.
    warnings: tuple[str, ...]
    #: List of requirements of the FMU on the computer that loads the FMU.
    notes: tuple[str, ...]

    def __bool__(self) -> bool:
        return not self.errors

    def __str__(self) -> str:
        kinds = (("error", self.errors), ("warning", self.warnings), ("note", self.notes))
        lines = [f"{kind}: {line}" for kind, all_lines in kinds for line in all_lines]
        return "\n".join([*lines, "valid" if self else "not valid"])


def info(path: str | os.PathLike[str]) -> Info:
    """Return the variables, units, platforms and requirements of a definition or of an FMU. The function `info` can
    also read an FMU of another program.

    Raises:
        InputError: neither an FMU nor a definition exists at the path.
    """
    text, stated = _engine.info(file("path", path))
    return Info(json.loads(stated), text)


def validate(path: str | os.PathLike[str]) -> Validation:
    """Check that an FMU is complete: archive, modelDescription.xml, libraries, and definition.

    Raises:
        InputError: neither an FMU nor a definition exists at the path.
    """
    found: dict[str, list[str]] = json.loads(_engine.validate(file("path", path)))
    return Validation(tuple(found["errors"]), tuple(found["warnings"]), tuple(found["notes"]))


def package(
    source: Source,
    path: str | os.PathLike[str] = ".",
    fmi: str | int = "both",
    platforms: Sequence[str] = (),
) -> list[Path]:
    """Build FMUs from a definition of a mechanism, and write the FMUs into the folder `path`. The arguments `path`,
    `fmi` and
    `platforms` have the same meaning as in `Mechanism.package`.

    Raises:
        MechanismError: the definition contains errors.
        InputError: the Python package contains no compiled library for one of the platforms, or the folder `path`
            cannot be written.
    """
    return Mechanism(source).package(path, fmi, platforms)
