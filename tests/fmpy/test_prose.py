"""The prose of the documentation: short sentences in the words of mechanical engineers, without private words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import REPOSITORY

DOCS = REPOSITORY / "docs"
PAGES = [
    *(REPOSITORY / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "ARCHITECTURE.md")),
    *(REPOSITORY / "validation" / name for name in ("README.md", "src/pages.md", "src/stress_report.md")),
    *sorted(DOCS.rglob("*.md")),
]
"""The pages of docs/, the pages that people read first, and the texts of the pages of measurements."""
LONGEST = 35
"""Largest number of words of a sentence."""
AVERAGE = 17
"""Largest number of words of a sentence in the mean of all pages."""
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

BANNED_IN_MESSAGES = BANNED | {
    r"\bstands? (twice|above|below)\b": "occurs twice, is above",
    r"(?<!there )\b(is|are) no\b": "is not a, there is no",
    r"\basks? for\b": "needs",
    r"\bforeseen\b": "predicted",
    r"\b(is|are) meant\b": "if you mean",
    r"\bholds no\b|\blacks?\b": "contains no, does not have",
    r"\bmeets?\b": "reaches",
}
"""Private words in texts of the program."""
CODE = [
    path
    for folder in ("src", "fmu-build")
    for path in sorted((REPOSITORY / folder).rglob("*.rs"))
    if not {"tests", "target"} & set(path.relative_to(REPOSITORY).parts) and path.name != "tests.rs"
]
"""The sources with texts for users."""
RUST = re.compile(
    r"""(?P<comment>//[^\n]*)|b?r(?P<hash>#*)"(?P<raw>.*?)"(?P=hash)|b?'(?:\\.[^']*|[^'\\])'|"(?P<text>(?:\\.|[^"\\])*)\"""",
    re.DOTALL,
)


def prose(text: str) -> str:
    """A page without code, comments, rules of tables, pictures and the targets of links."""
    text = re.sub(r"^---\n.*?^---\n", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^ *```.*?^ *```$", "\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^( {4}|\t)(?! *[-*\d]).*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"`[^`\n]*`", "code", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)


def sentences(text: str) -> list[str]:
    """The sentences of paragraphs, lists and cells of tables. One may start with a symbol: u1 is ..."""
    lines = [line for line in prose(text).splitlines() if not line.lstrip().startswith("#")]
    cells = [cell for line in lines if line.lstrip().startswith("|") for cell in re.split(r"(?<!\\)\|", line)]
    lines = [line for line in lines if not line.lstrip().startswith("|")]
    blocks = re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines)) + cells
    found = []
    for block in blocks:
        flat = re.sub(r"^\s*(?:[-*]|\d+\.) ", "", " ".join(block.split()))
        found += re.split(r"(?<=[.?!:])[\s\"*)]+(?=[A-Z\"*(\d]|code|linkage-fmu|[a-z]\d? is |$)", flat)
    return [sentence for sentence in found if re.search(r"\w+ \w+", sentence)]


def words(sentence: str) -> int:
    """Number of words."""
    return len(re.findall(r"[\w'.,/-]*\w[\w'./-]*", sentence))


def name(page: Path) -> str:
    """Name of a page in the names of tests."""
    return page.relative_to(DOCS if page.is_relative_to(DOCS) else REPOSITORY).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_no_private_words(page: Path) -> None:
    text = prose(page.read_text(encoding="utf-8"))
    found = [
        f"'{match[0]}': write {better}"
        for pattern, better in BANNED.items()
        for match in re.finditer(pattern, text, re.IGNORECASE)
    ]
    assert not found


def texts(source: str) -> list[str]:
    """The texts with a blank in a Rust source, except in its tests: messages, descriptions, help."""
    source = re.split(r"#\[cfg\(test\)\]\n(?:#\[[^\n]*\n)*mod \w+ \{", source)[0]
    found = [match["raw"] or match["text"] or "" for match in RUST.finditer(source)]
    return [text for text in (re.sub(r"\\\n\s*", "", one) for one in found) if " " in text.strip()]


def test_texts_are_found() -> None:
    source = """// "none"\nlet a = "one two"; let b = 'c'; let d = "x \\\n    y";\n#[cfg(test)]\nmod tests {"no one"}"""
    assert texts(source) == ["one two", "x y"]


@pytest.mark.parametrize("path", CODE, ids=lambda path: path.relative_to(REPOSITORY).as_posix())
def test_no_private_words_in_messages(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    said = texts(source)
    if path.parent == REPOSITORY / "fmu-build" / "cli" / "src":
        # The help of the command line consists of doc comments.
        said += re.findall(r"^ {4}/// (.*)$", source, re.MULTILINE)
    found = [
        f"'{match[0]}' in '{text}': write {better}"
        for text in said
        for pattern, better in BANNED_IN_MESSAGES.items()
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
