"""Pages with a moving mechanism."""

from __future__ import annotations

import html
import os
import tempfile
import webbrowser
from pathlib import Path

from ._errors import InputError, file, wrong


class Page:
    """Web page (HTML) that needs no other files. A notebook displays the web page in the output of a cell."""

    def __init__(self, text: str, height: int) -> None:
        if isinstance(height, bool) or not isinstance(height, int):
            wrong("height", height, "a whole number of pixels > 0")
        if height <= 0:
            raise InputError(f"height = {height!r}: must be a whole number of pixels > 0")
        #: Text of the HTML page.
        self.html = text
        self._height = height

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the web page to a file, and return the path of the file."""
        path = Path(file("path", path))
        path.write_text(self.html, encoding="utf-8")
        return path

    def open(self) -> None:
        """Open the web page in a web browser."""
        with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
            file.write(self.html)
        webbrowser.open(Path(file.name).as_uri())

    def _repr_html_(self) -> str:
        # A separate frame: neither style nor script affects the notebook.
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self._height}" '
            'style="border:0" sandbox="allow-scripts"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<Page of {len(self.html) // 1000} kB; save(path) writes it, open() shows it>"
