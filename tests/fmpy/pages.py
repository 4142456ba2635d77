"""The blocks of a page of the documentation, run from the top to the bottom in one folder, as its reader would.

    python tests/fmpy/pages.py docs/how-to/sweep.md             # runs the page and prints what each block printed
    python tests/fmpy/pages.py --pictures docs/tutorials/*.md   # and keeps the pictures that the page shows

| block | what happens |
|---|---|
| `bash` | runs; `cargo fmu` and `linkage-fmu` are the program, `python` is this interpreter |
| `python` without a title | runs |
| `json`, `csv`, `python`, `yaml`, `toml` with `title="NAME"` | is written to that file |
| `json` with `title="add to NAME"` | goes into that file, entry by entry |
| `json` without a title | must be JSON |
| `text` | what the block above it printed, `...` for any lines or the rest of one; numbers to the last digit shown |

A comment above a block says what differs: `<!-- exit 1 -->`: it ends with this code; `<!-- not run: REASON -->`.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("LINKAGE_FMU_PROGRAM", "")
"""An existing binary of the program. Without it cargo builds the program."""
CARGO = f"cargo run --release --quiet --manifest-path '{REPOSITORY / 'Cargo.toml'}' --package fmu-cli --"
FENCE = re.compile(
    r"(?:^ *<!-- (?P<note>[^\n]*?) -->\n)?"
    r"^(?P<indent> *)```(?P<language>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<body>.*?)^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
ANSI = re.compile(r"\x1b\[[0-9;]*m")


class Wrong(Exception):
    """A statement of a page is wrong."""


@dataclass
class Block:
    """A fenced block of a page."""

    language: str
    title: str | None
    note: str
    body: str
    line: int


def blocks(text: str) -> list[Block]:
    """The fenced blocks of a page, in order."""
    found = []
    for match in FENCE.finditer(text):
        indent = match["indent"]
        body = "".join(line.removeprefix(indent) for line in match["body"].splitlines(keepends=True))
        line = text.count("\n", 0, match.start("language")) + 1
        found.append(Block(match["language"], match["title"], match["note"] or "", body, line))
    return found


def merge(whole: dict[str, Any], part: dict[str, Any]) -> None:
    """Merge a part into a whole, entry by entry. null removes an entry."""
    for key, value in part.items():
        if value is None:
            del whole[key]
        elif isinstance(value, dict) and isinstance(whole.get(key), dict):
            merge(whole[key], value)
        else:
            whole[key] = value


def agree(expected: str, printed: str) -> bool:
    """Whether two lines agree: in words, and in numbers to the last digit that the page shows. `...` skips the rest of
    a line."""
    if expected.endswith(" ..."):
        expected = expected.removesuffix(" ...").rstrip(",")
        if printed.startswith(expected):
            return True
        words = len(expected.split())
        printed = " ".join(printed.split()[:words]).rstrip(",")
    if NUMBER.sub("#", expected).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(printed), strict=True)
    return all(near(one, other) for one, other in pairs)


def near(expected: str, printed: str) -> bool:
    """Whether a number agrees with the page, rounded or truncated."""
    mantissa, _, exponent = expected.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    unit = 10.0 ** (int(exponent or 0) - decimals)
    return abs(float(expected) - float(printed)) <= 1.000001 * unit if "." in mantissa else expected == printed


def compare(expected: str, printed: str) -> None:
    """Compare the output that a page shows with the printed output."""
    lines = [line for line in ANSI.sub("", printed).splitlines() if line.strip()]
    at, skipping = 0, False
    for line in expected.splitlines():
        if not line.strip():
            continue
        if line.strip() == "...":
            skipping = True
            continue
        while skipping and at < len(lines) and not agree(line, lines[at]):
            at += 1
        if at == len(lines) or not agree(line, lines[at]):
            raise Wrong(f"the page shows\n    {line}\nand this was printed:\n{printed}")
        at, skipping = at + 1, False
    if at < len(lines) and not skipping:
        raise Wrong(f"more was printed than the page shows:\n{printed}")


class Reader:
    """Runs the blocks of one page in a folder."""

    def __init__(self, folder: Path, fmus: Path) -> None:
        self.folder = folder
        self.printed = ""
        for name in ("modelDescription", "docs", "examples"):
            (folder / name).symlink_to(REPOSITORY / name)
        (folder / "target").mkdir()
        (folder / "target" / "fmu").symlink_to(fmus)
        commands = folder / ".commands"
        commands.mkdir()
        cargo = shlex.quote(shutil.which("cargo") or "cargo")
        program = shlex.quote(PROGRAM) if PROGRAM else CARGO.replace("cargo", cargo, 1)
        task = f'if [ "$1" = fmu ]; then shift; exec {program} "$@"; fi\nexec {cargo} "$@"'
        for name, script in (("cargo", task), ("linkage-fmu", f'exec {program} "$@"')):
            (commands / name).write_text(f"#!/bin/bash\n{script}\n", encoding="utf-8")
            (commands / name).chmod(0o755)
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
        environment["PATH"] = os.pathsep.join([str(commands), str(Path(sys.executable).parent), environment["PATH"]])
        environment["MPLBACKEND"] = "Agg"
        self.environment = environment

    def run(self, block: Block) -> None:
        """Run, write or check a block."""
        path = self.folder / (block.title or "")
        if block.note.startswith("not run"):
            self.printed = ""
        elif block.language == "text":
            if self.printed:
                compare(block.body, self.printed)
        elif block.language == "bash":
            self.start(["bash", "-e", "-c", block.body], block)
        elif block.language == "json" and block.title and block.title.startswith("add to "):
            path = self.folder / block.title.removeprefix("add to ")
            whole = json.loads(path.read_text(encoding="utf-8"))
            merge(whole, json.loads(block.body))
            path.write_text(json.dumps(whole, indent=2), encoding="utf-8")
        elif block.title:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.body, encoding="utf-8")
        elif block.language == "json":
            json.loads(block.body)
        elif block.language == "python":
            self.start([sys.executable, "-c", block.body], block)

    def start(self, command: list[str], block: Block) -> None:
        """Run a program to its end."""
        done = subprocess.run(
            command,
            cwd=self.folder,
            env=self.environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=600,
            check=False,
        )
        self.printed = done.stdout
        code = int(block.note.removeprefix("exit ")) if block.note.startswith("exit ") else 0
        if done.returncode != code:
            raise Wrong(f"the block ended with the code {done.returncode}, not {code}:\n{done.stdout}")


def run(page: Path, folder: Path, fmus: Path, show: bool = False) -> None:
    """Run a page.

    # Errors
    `Wrong`, with the line of the page.
    """
    reader = Reader(folder, fmus)
    for block in blocks(page.read_text(encoding="utf-8")):
        try:
            reader.run(block)
        except (Wrong, ValueError, OSError) as error:
            if not show:
                raise Wrong(f"{page.name}, line {block.line}: {error}") from error
            print(f"WRONG, line {block.line}: {error}")
        if show and block.language in ("bash", "python") and not block.title:
            print(f"--- line {block.line}\n{block.body}>>>\n{ANSI.sub('', reader.printed)}")


def main() -> None:
    """Run pages for their authors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--pictures", action="store_true", help="keep the pictures that the pages show")
    parser.add_argument("--fmus", type=Path, default=REPOSITORY / "target" / "fmu", help="folder of the packed FMUs")
    arguments = parser.parse_args()
    for page in arguments.pages:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            run(page, folder, arguments.fmus.resolve(), show=not arguments.pictures)
            if arguments.pictures:
                for target in PICTURE.findall(page.read_text(encoding="utf-8")):
                    made = folder / Path(target).name
                    if made.is_file():
                        shutil.copyfile(made, page.parent / target)
                        print(page.parent / target)


if __name__ == "__main__":
    main()
