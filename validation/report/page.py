"""What the report is made of, and its text as Markdown.

It must not know where numbers come from or how figures are drawn.
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
"""What stands in a caption between the words about the paper and those about the runs."""
ROUNDING = 1e-12
"""Relative errors below this are rounding, and not told apart."""


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
        """The title without brackets, for those who do not see the figure."""
        return self.title.replace("[", "").replace("]", "")

    @property
    def paper(self) -> str:
        """What the caption says of the paper."""
        return sentence(self.caption.partition(OURS)[0].removeprefix("Paper: ").strip())

    @property
    def ours(self) -> str:
        """What the caption says of the runs."""
        return sentence(self.caption.partition(OURS)[2])


@dataclass(frozen=True)
class Claim:
    """A row of the table: where it stands, what the paper says, what the runs give, what to know when comparing."""

    source: str
    statement: str
    paper: str
    ours: str
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A group of figures with the claims they answer; `values` are their numbers, to be checked by a test."""

    title: str
    figures: list[Figure]
    claims: list[Claim] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)
    introduction: str = ""


def sentence(text: str) -> str:
    """With a capital at its beginning, unless a symbol stands there."""
    return text[:1].upper() + text[1:] if text[1:2].isalpha() else text


def bound(values: float | Iterable[float]) -> str:
    """A power of ten that all of these errors stay below by a factor of three or more: their digits are noise."""
    largest = max([values] if isinstance(values, float) else values)
    return f"1e{math.ceil(math.log10(max(3.0 * largest, ROUNDING)))}"


def text(sections: list[Section]) -> str:
    """The page."""
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
