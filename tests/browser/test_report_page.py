"""The page of the report on the papers: it loads no other files, figures have texts, the gear moves."""

from __future__ import annotations

import time

import pytest
from conftest import REPOSITORY, Show, Shown

REPORT = REPOSITORY / "validation" / "report.html"
#: Largest allowed size of the committed page with its 32 figures [bytes].
LARGEST = 1_100_000


@pytest.fixture
def report(show: Show) -> Shown:
    """The committed page."""
    return show(REPORT)


def test_figures_have_words_and_pictures(report: Shown) -> None:
    assert REPORT.stat().st_size <= LARGEST
    page = report.page
    figures = page.locator("article[data-figure]")
    assert figures.count() >= 20
    for figure in figures.all():
        name = figure.get_attribute("data-figure")
        figure.scroll_into_view_if_needed()
        picture = figure.locator("img")
        assert len(picture.get_attribute("alt") or "") > 10, name
        picture.evaluate("(image) => image.decode()")
        assert picture.evaluate("(image) => image.naturalWidth") > 500, name
        words = figure.locator("p").all_inner_texts()
        assert words, name
        assert all(words), name
        # Figures of the papers are next to the text that describes them.
        if (name or "").startswith(("hf08", "ck16")):
            assert figure.locator("h4").all_inner_texts() == ["PAPER", "OURS"], name
    for link in page.locator("nav a").all():
        assert page.locator(link.get_attribute("href") or "").count() == 1
    assert page.locator("tbody tr").count() >= 15


def test_the_gear_moves(report: Shown) -> None:
    frame = report.page.frame_locator("iframe")
    joint = frame.locator("[data-joint=joint2]")
    joint.wait_for()
    before = joint.get_attribute("transform")
    frame.locator("#play").click()
    end = time.monotonic() + 20.0
    while joint.get_attribute("transform") == before:
        assert time.monotonic() < end, "the gear stands still"
        time.sleep(0.05)


@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_element_exceeds_the_width(width: int, scheme: str, show: Show) -> None:
    page = show(REPORT, width=width, scheme=scheme).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width
