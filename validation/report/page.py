"""The parts of the report, and its text as Markdown.

It must not depend on the source of the numbers or on how figures are drawn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from matplotlib.figure import Figure as Canvas

HEADER = """\
# The papers' figures, recomputed
Written by `cargo fmu report` from runs of the FMUs through FMPy; do not edit. Every number said to be *ours* is that of
a run, or of equations of the papers that the report computes next to a run.

[HF08] is M. Hać, K. From: *Design of Retraction Mechanism of Aircraft Landing Gear*, Mechanics and Mechanical
Engineering 12 (2008) 357-373; [CK16] is J. Cink, A. Kosucki: *The Dynamic Model of Plane Mechanism with Variable
Ratio*, same journal, 20 (2016) 393-415. Only the papers' text is at hand, not the curves in their figures: a comparison
is with what the text says. What the text leaves open (arms of the actuator, ends of the travel, all lengths and masses
of [CK16]) is the project's choice and stands as such in the captions. Errors are stated as the power of ten they stay
below, from 1e-12 up.
"""


OURS = "Ours: "
"""Separates the statement about the paper from that about the runs in a caption."""
ROUNDING = 1e-12
"""Relative errors below this are rounding errors and are reported as this value."""


@dataclass(frozen=True)
class Figure:
    """A figure with its caption; `draw` puts it on an empty canvas of the size `size` [inch]."""

    name: str
    title: str
    caption: str
    draw: Callable[[Canvas], None]
    size: tuple[float, float] = (6.4, 4.0)

    @property
    def words(self) -> str:
        """The title without brackets, as the alternative text."""
        return self.title.replace("[", "").replace("]", "")

    @property
    def paper(self) -> str:
        """The caption's statement about the paper."""
        return sentence(self.caption.partition(OURS)[0].removeprefix("Paper: ").strip())

    @property
    def ours(self) -> str:
        """The caption's statement about the runs."""
        return sentence(self.caption.partition(OURS)[2])


@dataclass(frozen=True)
class Claim:
    """A row of the table: section of the paper, statement, value of the paper, value of the runs, remark."""

    source: str
    statement: str
    paper: str
    ours: str
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A group of figures with the claims they concern; `values` are their numbers, which a test checks."""

    title: str
    figures: list[Figure]
    claims: list[Claim] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)
    introduction: str = ""


def sentence(text: str) -> str:
    """The text with a capital first letter, unless it starts with a symbol."""
    return text[:1].upper() + text[1:] if text[1:2].isalpha() else text


def bound(values: float | Iterable[float]) -> str:
    """A power of ten that exceeds all of these errors by a factor of three or more, as their digits are noise."""
    largest = max([values] if isinstance(values, float) else values)
    return f"1e{math.ceil(math.log10(max(3.0 * largest, ROUNDING)))}"


def text(sections: list[Section]) -> str:
    """The report as Markdown."""
    rows = ["| where | claim | paper | ours | remark |", "|---|---|---|---|---|"]
    for section in sections:
        rows += [f"| {c.source} | {c.statement} | {c.paper} | {c.ours} | {c.remark} |" for c in section.claims]
    parts = [HEADER, "## Claims\n" + "\n".join(rows) + "\n"]
    for section in sections:
        parts.append(f"## {section.title}\n{section.introduction}".rstrip() + "\n")
        for figure in section.figures:
            image = f"[![{figure.words}](figures/{figure.name}.png)](figures/{figure.name}.svg)"
            parts.append(f"{image}\n\n**{figure.title}.** {figure.caption}\n")
    return "\n".join(parts)
