"""FMUs as files."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _engine
from ._errors import file
from ._mechanism import Mechanism, Source


class Info(dict[str, Any]):
    """What a model offers to a host, as `linkage-fmu info --json` prints it. It prints as a table."""

    def __init__(self, stated: dict[str, Any], text: str) -> None:
        super().__init__(stated)
        self._text = text

    def __str__(self) -> str:
        return self._text.rstrip()


@dataclass(frozen=True)
class Validation:
    """What is wrong with an FMU. It is true if there is no error."""

    #: Why the FMU cannot be used.
    errors: tuple[str, ...]
    #: What is probably not meant.
    warnings: tuple[str, ...]
    #: What the machine that loads the FMU must have.
    notes: tuple[str, ...]

    def __bool__(self) -> bool:
        return not self.errors

    def __str__(self) -> str:
        kinds = (("error", self.errors), ("warning", self.warnings), ("note", self.notes))
        lines = [f"{kind}: {line}" for kind, all_lines in kinds for line in all_lines]
        return "\n".join([*lines, "valid" if self else "not valid"])


def info(path: str | os.PathLike[str]) -> Info:
    """Variables, units, platforms and needs of an FMU of any program, or of a definition.

    Raises:
        InputError: the path leads to no model.
    """
    text, stated = _engine.info(file("path", path))
    return Info(json.loads(stated), text)


def validate(path: str | os.PathLike[str]) -> Validation:
    """Whether an FMU is complete: archive, modelDescription.xml, libraries, and its definition.

    Raises:
        InputError: the path leads to no model.
    """
    found: dict[str, list[str]] = json.loads(_engine.validate(file("path", path)))
    return Validation(tuple(found["errors"]), tuple(found["warnings"]), tuple(found["notes"]))


def package(
    source: Source,
    path: str | os.PathLike[str] = ".",
    fmi: str | int = "both",
    platforms: Sequence[str] = (),
) -> list[Path]:
    """Pack a definition as FMUs into the folder `path`. The arguments are those of `Mechanism.package`.

    Raises:
        MechanismError: the definition gives no model.
        InputError: the package has no library for a platform, or the folder cannot be written.
    """
    return Mechanism(source).package(path, fmi, platforms)
