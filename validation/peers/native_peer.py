"""Solvers in C (`native/*.c`): compiled with the system's libraries, executed, and their output parsed."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import curves
from measure import LeftOutError, Point

SOURCES = Path(__file__).resolve().parent / "native"
FLAGS = ("-std=gnu11", "-O3")
"""Flags as for the Rust solvers: optimised, for the generic processor, with IEEE arithmetic."""


@dataclass(frozen=True)
class Library:
    """A library in C: a header that exists if it is installed, the libraries to link, and the Debian package."""

    tool: str
    program: str
    header: str
    link: tuple[str, ...]
    package: str


GSL = Library("GSL", "gsl_peer", "gsl/gsl_odeiv2.h", ("gsl", "gslcblas"), "libgsl-dev")
CVODE = Library(
    "CVODE",
    "cvode_peer",
    "cvode/cvode.h",
    (
        "sundials_cvode",
        "sundials_nvecserial",
        "sundials_sunlinsoldense",
        "sundials_sunmatrixdense",
        "sundials_sunnonlinsolfixedpoint",
    ),
    "libsundials-dev",
)


def compiler() -> str:
    """The C compiler: CC, or cc."""
    return os.environ.get("CC") or "cc"


def missing(library: Library) -> str:
    """The package to install first; empty if the library is installed."""
    try:
        found = subprocess.run(
            [compiler(), "-E", "-x", "c", "-"], input=f"#include <{library.header}>\n", capture_output=True, text=True
        )
    except OSError:
        return "there is no C compiler (Debian: apt-get install gcc)"
    return "" if found.returncode == 0 else f"not installed (Debian: apt-get install {library.package})"


def points(library: Library, work: Path, versions: list[str]) -> Iterator[Point]:
    """All curves; adds the version of the linked library to `versions`."""
    if reason := missing(library):
        raise LeftOutError(reason)
    program, table = work / library.program, work / f"{library.program}.csv"
    source = SOURCES / f"{library.program}.c"
    link = [f"-l{name}" for name in (*library.link, "m")]
    subprocess.run([compiler(), *FLAGS, str(source), "-o", str(program), *link], check=True)
    with table.open("w", encoding="utf-8") as file:
        ended = subprocess.run([str(program)], stdout=file, stderr=subprocess.PIPE, text=True, check=True)
    version, *rest = ended.stderr.splitlines()
    versions.append(version)
    print(*rest, sep="\n", end="\n" if rest else "")
    yield from curves.read(table)
