"""The documentation site, opened from disk: it needs no network, is readable on a phone, and its search works."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import REPOSITORY
from playwright.sync_api import Browser, Page

SITE = REPOSITORY / "target" / "docs"
PAGES = sorted(page for page in SITE.rglob("*.html") if "decisions" not in page.parts or page.name == "index.html")
PHONE, DESKTOP = 390, 1400
"""Widths [px]."""


def test_there_is_a_site() -> None:
    assert len(PAGES) > 50, f"{SITE} is missing; run `cargo fmu docs`"


@pytest.fixture(scope="module", params=[PHONE, DESKTOP])
def page(request: pytest.FixtureRequest, browser: Browser) -> Iterator[Page]:
    """A page of the browser with the width of a phone or of a desktop."""
    context = browser.new_context(viewport={"width": request.param, "height": 900})
    yield context.new_page()
    context.close()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(SITE).as_posix())
def test_a_page_fits_and_needs_no_network(page: Page, path: Path) -> None:
    asked: list[str] = []
    problems: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(path.as_uri())
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert problems == []
    assert page.evaluate("document.documentElement.scrollWidth") <= page.viewport_size["width"]
    broken = "Array.from(document.images).filter((i) => i.complete && !i.naturalWidth).map((i) => i.src)"
    assert page.evaluate(broken) == []


def test_the_search_finds(browser: Browser) -> None:
    context = browser.new_context(viewport={"width": DESKTOP, "height": 900})
    page = context.new_page()
    page.goto((SITE / "index.html").as_uri())
    page.locator(".md-search__input").fill("retraction time")
    page.wait_for_selector(".md-search-result__item")
    assert "Retraction and extension time" in page.locator(".md-search-result__list").inner_text()
    context.close()
