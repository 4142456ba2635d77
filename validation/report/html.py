"""The report as one self-contained HTML page: figures with their captions, the gear in motion, benchmarks."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from .page import HEADER, Figure, Section


@dataclass(frozen=True)
class Shown:
    """A figure with its PNG picture."""

    figure: Figure
    picture: bytes

    @property
    def source(self) -> str:
        """The picture as a data URL."""
        return "data:image/png;base64," + base64.b64encode(self.picture).decode("ascii")


def marked(text: str) -> Markup:
    """HTML of a caption with `code` and *emphasis*."""
    safe = re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text)))
    return Markup(re.sub(r"(?<![\w*])\*(?=\S)([^*<]+?)(?<=\S)\*(?![\w*])", r"<em>\1</em>", safe))


def anchor(title: str) -> str:
    """Anchor of a section."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def html(sections: list[Section], pictures: dict[str, bytes], motion: str, measured: list[Shown]) -> str:
    """The page; `pictures` by figure name, `motion` the view of the gear, `measured` the figures of the benchmarks."""
    title, _, introduction = HEADER.removeprefix("# ").partition("\n")
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters |= {"marked": marked, "anchor": anchor}
    groups = [(section, [Shown(figure, pictures[figure.name]) for figure in section.figures]) for section in sections]
    return environment.get_template("report.html").render(
        title=title,
        introduction=[part.replace("\n", " ") for part in introduction.split("\n\n")],
        groups=groups,
        motion=motion,
        measured=measured,
    )
