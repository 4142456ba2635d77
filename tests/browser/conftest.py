"""Pages of `cargo fmu view`, and those in FMUs, in Chromium, driven by Playwright."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

REPOSITORY = Path(__file__).resolve().parents[2]
#: Folder of the packed FMUs.
FMU_FOLDER = Path(os.environ.get("LINKAGE_FMU_DIR", REPOSITORY / "target" / "fmu"))
#: Chromium itself must not use the network. /dev/shm may be small in a container.
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
]

Mechanism = dict[str, Any]
Make = Callable[..., "Made"]


def definition(name: str) -> Mechanism:
    """The definition of one of the repository's mechanisms."""
    path = REPOSITORY / "modelDescription" / name / "resources" / "mechanism.json"
    return json.loads(path.read_text(encoding="utf-8"))


@dataclass
class Made:
    """A page that the program wrote."""

    path: Path
    code: int
    output: str


@dataclass
class Shown:
    """A page in the browser, with all errors and warnings that occurred in it."""

    page: Page
    problems: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def hear(self, kind: str, text: str) -> None:
        """A message on the console: a problem, except for Bokeh's messages at the start and the end of a drawing."""
        if kind in ("error", "warning") or not text.startswith("[bokeh "):
            self.problems.append(f"console: {text}")

    def data(self) -> dict[str, Any]:
        """The data of the page."""
        return json.loads(self.page.locator("#data").text_content() or "")

    def values(self, name: str) -> list[float]:
        """Samples of a variable of the motion, as the page reads them."""
        find = "(name) => Array.from(mechanism.data.motion.variables.find((v) => v.name === name).samples)"
        return self.page.evaluate(find, name)

    def center(self, selector: str) -> tuple[float, float]:
        """Centre of a drawn element [px]."""
        box = self.page.locator(selector).first.bounding_box()
        assert box is not None, f"{selector} is not drawn"
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def cell(self, name: str, column: int = 0) -> str:
        """Number in the table row of a variable: column 0 in SI units, column 1 in display units."""
        cells = self.page.locator(f'#values tr[data-variable="{name}"] td.number')
        return cells.nth(column).locator("span").inner_text()


def until(shown: Shown, condition: str, seconds: float = 20.0) -> None:
    """Wait until a condition holds. The page's own policy forbids evaluating the condition in the page."""
    end = time.monotonic() + seconds
    while not shown.page.evaluate(condition):
        assert time.monotonic() < end, f"not within {seconds} s: {condition}"
        time.sleep(0.02)


def inaccessible(shown: Shown) -> list[str]:
    """Serious and critical findings of axe-core, each with its element."""
    found = Axe().run(shown.page).response["violations"]
    serious = [one for one in found if one["impact"] in ("serious", "critical")]
    return [f"{one['id']}: {node['html']}" for one in serious for node in one["nodes"]]


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium. The environment variable CHROMIUM names another program."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    assert program, "no Chromium: install it (Debian: apt-get install chromium) or name it in CHROMIUM"
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def make(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Writes the page of a definition. The environment variable LINKAGE_VIEW names the program."""
    program = os.environ.get("LINKAGE_VIEW")
    assert program, "LINKAGE_VIEW names no program; run the tests by `cargo fmu test`"
    folder = tmp_path_factory.mktemp("pages")
    made: dict[str, Made] = {}

    def write(mechanism: Mechanism, *options: str) -> Made:
        key = json.dumps([mechanism, options])
        if key not in made:
            source = folder / f"{len(made)}.json"
            source.write_text(json.dumps(mechanism), encoding="utf-8")
            page = source.with_suffix(".html")
            command = [program, "view", str(source), "--out", str(page), *options]
            run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
            made[key] = Made(page, run.returncode, run.stdout + run.stderr)
        return made[key]

    return write


Show = Callable[..., Shown]


@pytest.fixture
def show(browser: Browser) -> Iterator[Show]:
    """Opens pages. Each page is closed after the test and must have had no problem."""
    contexts: list[BrowserContext] = []
    opened: list[Shown] = []

    def load(
        path: Path, width: int = 1400, height: int = 900, scheme: str = "light", ready: str = "body[data-ready]"
    ) -> Shown:
        context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark" if scheme == "dark" else "light"
        )
        contexts.append(context)
        shown = Shown(context.new_page())
        opened.append(shown)
        page = shown.page
        page.on("console", lambda message: shown.hear(message.type, message.text))
        page.on("pageerror", lambda error: shown.problems.append(f"error: {error}"))
        page.on("dialog", lambda dialog: (shown.problems.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        page.on("request", lambda request: shown.requests.append(request.url))
        page.goto(path.as_uri())
        page.wait_for_selector(ready)
        return shown

    yield load
    for shown in opened:
        assert shown.problems == []
        outside = [url for url in shown.requests if not url.startswith(("file:", "data:"))]
        assert outside == []
        assert len([url for url in shown.requests if url.startswith("file:")]) == 1
    for context in contexts:
        context.close()
