"""The prose of the documentation: short sentences in the words of mechanical engineers, without private ones."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import REPOSITORY

DOCS = REPOSITORY / "docs"
PAGES = [
    *(REPOSITORY / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")),
    *sorted(DOCS.rglob("*.md")),
]
"""The pages of docs/ and those that people read first; ARCHITECTURE.md, a table in words of the code, is left out."""
LONGEST = 35
"""Most words of a sentence."""
AVERAGE = 17
"""Most words of a sentence in the mean of all pages."""
BANNED = {
    r"\b(tells?|told|telling)\b": "reports, prints, outputs, returns, states",
    r"\b(is|are|be|was|were) refused\b|\brefuses?\b": "is rejected (input); returns an error (call)",
    r"\bbeside\b": "next to, together with, compared with",
    r"\b(goes|go|going|went) on\b": "continues",
    r"\bhand(s|ed)? (over|on)\b": "passes, is connected to",
    r"\b(is|are) led to\b": "is connected to",
    r"\berrs? by\b": "has an error of",
    r"\bto the bit\b|\bsame bits\b": "identical",
    r"\bbegins?\b|\bbegan\b": "starts",
    r"\bcomes? to rest\b": "stops",
    r"\bgets? there\b": "reaches",
    r"\bof (its|one's|their) own\b": "own, separate",
    r"\b(is|are|was|were|be) met\b": "is reached",
    r"\bby hand\b": "manually",
}
EXCEPT = {
    # What the program prints.
    "reference/messages.md": {r"\b(is|are|was|were|be) met\b"},
    "how-to/it-jams.md": {r"\b(is|are|was|were|be) met\b"},
    "tutorials/landing-gear.md": {r"\b(is|are|was|were|be) met\b"},
}


def prose(text: str) -> str:
    """A page without code, comments, tables' rules, pictures and the targets of links."""
    text = re.sub(r"^---\n.*?^---\n", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^ *```.*?^ *```$", "\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^( {4}|\t)(?! *[-*\d]).*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"`[^`\n]*`", "code", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)


def sentences(text: str) -> list[str]:
    """The sentences of paragraphs and lists; headings and tables have none."""
    lines = [line for line in prose(text).splitlines() if not line.lstrip().startswith(("#", "|"))]
    blocks = re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines))
    found = []
    for block in blocks:
        flat = re.sub(r"^\s*(?:[-*]|\d+\.) ", "", " ".join(block.split()))
        found += re.split(r"(?<=[.?!:])[\s\"*)]+(?=[A-Z\"*(\d]|code|$)", flat)
    return [sentence for sentence in found if re.search(r"\w+ \w+", sentence)]


def words(sentence: str) -> int:
    """Number of words."""
    return len(re.findall(r"[\w'.,/-]*\w[\w'./-]*", sentence))


def name(page: Path) -> str:
    """Name of a page in EXCEPT and in the names of tests."""
    return page.relative_to(DOCS).as_posix() if page.is_relative_to(DOCS) else page.name


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_no_private_words(page: Path) -> None:
    text = prose(page.read_text(encoding="utf-8"))
    found = [
        f"'{match[0]}': write {better}"
        for pattern, better in BANNED.items()
        if pattern not in EXCEPT.get(name(page), set())
        for match in re.finditer(pattern, text, re.IGNORECASE)
    ]
    assert not found


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_no_long_sentence(page: Path) -> None:
    long = [line for line in sentences(page.read_text(encoding="utf-8")) if words(line) > LONGEST]
    assert not long


def test_the_sentences_are_short() -> None:
    lengths = [words(line) for page in PAGES for line in sentences(page.read_text(encoding="utf-8"))]
    assert len(lengths) > 500
    assert sum(lengths) / len(lengths) <= AVERAGE
