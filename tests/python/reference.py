"""Writes the page of the reference about the module, from its docstrings.

python tests/python/reference.py        # prints the page
python tests/python/reference.py --write
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import linkage_fmu as lf

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "python.md"
HEAD = """# Python module

`import linkage_fmu` needs the Python package (wheel) of linkage-fmu (see [Install](../install.md#without-rust)). The
page [Python](../how-to/python.md) contains short examples. All values of variables are in SI units. This page is
generated from the docstrings of the module.

"""
FUNCTIONS = ("check", "example", "examples", "sweep", "optimise", "package", "info", "validate")
CLASSES = (
    "Mechanism", "Simulation", "State", "Names", "Result", "Kinematics", "LinearModel", "Report", "Finding", "Fact",
    "Quantity", "Variable", "Optimum", "Validation", "Info", "Page",
)  # fmt: skip
ERRORS = (
    "LinkageError", "InputError", "InputTypeError", "MechanismError", "SimulationError", "InternalError",
    "LinkageWarning",
)  # fmt: skip


def words(docstring: str | None) -> str:
    """A docstring as Markdown: lists of arguments and of exceptions become tables."""
    text = inspect.cleandoc(docstring or "")
    out = []
    for paragraph in text.split("\n\n"):
        head, _, rest = paragraph.partition("\n")
        if head in ("Args:", "Raises:"):
            column = "argument" if head == "Args:" else "exception"
            out.append(f"| {column} | meaning |\n|---|---|\n" + "\n".join(rows(rest)))
        elif head == "Returns:":
            out.append("Returns: " + " ".join(rest.split()))
        else:
            out.append(paragraph if "```" in paragraph else " ".join(paragraph.split()))
    return "\n\n".join(out)


def rows(text: str) -> list[str]:
    """Rows of a table, one for each `name: meaning`; a deeper line continues the row before it."""
    found: list[str] = []
    for line in text.splitlines():
        start = re.match(r" {4}(\w+): (.*)", line)
        if start:
            found.append(f"| `{start[1]}` | {start[2]}")
        else:
            found[-1] += " " + line.strip()
    return [row + " |" for row in found]


def signature(name: str, own: Any) -> str:  # noqa: ANN401
    """A call with its arguments and defaults."""
    try:
        stated = inspect.signature(own)
    except ValueError:
        return f"{name}(...)"
    parts = []
    for parameter in stated.parameters.values():
        if parameter.name in ("self", "cls"):
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and not any(part.startswith("*") for part in parts):
            parts.append("*")
        star = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        default = "" if parameter.default is parameter.empty else f"={parameter.default!r}"
        parts.append(f"{star}{parameter.name}{default}")
    return f"{name}({', '.join(parts)})"


def fields(own: type) -> list[str]:
    """Rows of the attributes that comments `#:` describe."""
    try:
        source = inspect.getsource(own)
    except (OSError, TypeError):
        return []
    found, comments = [], []
    for line in source.splitlines():
        comment = re.match(r" +#: (.*)", line)
        name = re.match(r" +(?:self\.)?(\w+)(?:: .*| = .*)", line)
        if comment:
            comments.append(comment[1])
        else:
            if comments and name:
                found.append(f"| `{name[1]}` | {' '.join(comments)} |")
            comments = []
    return found


def members(own: type) -> list[tuple[str, Any]]:
    """Public methods and properties that have a docstring, in their order."""
    return [
        (name, value)
        for name, value in vars(own).items()
        if not name.startswith("_")
        and getattr(value, "__doc__", None)
        and not isinstance(value, str | list | dict)
        and (callable(value) or isinstance(value, property) or type(value).__name__ == "getset_descriptor")
    ]


def class_section(name: str) -> str:
    own = getattr(lf, name)
    out = [f"## {name}", words(own.__doc__)]
    attributes = fields(own)
    values = [(m, v) for m, v in members(own) if not callable(v)]
    attributes += [f"| `{m}` | {' '.join(words(v.__doc__).split())} |" for m, v in values]
    if attributes:
        out.append("| attribute | meaning |\n|---|---|\n" + "\n".join(attributes))
    for method, value in members(own):
        if callable(value):
            out += [f"### {name}.{method}", f"`{signature(method, value)}`", words(value.__doc__)]
    return "\n\n".join(out)


def module_section(module: ModuleType) -> str:
    out = ["## build", words(module.__doc__)]
    tree = ast.parse(inspect.getsource(module))
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            own = getattr(module, node.name)
            out += [f"### build.{node.name}", f"`{signature(node.name, own)}`", words(own.__doc__)]
    return "\n\n".join(out)


def page() -> str:
    parts = [HEAD + "## Functions"]
    for name in FUNCTIONS:
        own = getattr(lf, name)
        parts += [f"### {name}", f"`{signature(name, own)}`", words(own.__doc__)]
    parts += [class_section(name) for name in CLASSES]
    parts.append(module_section(lf.build))
    parts.append("## Exceptions\n\n| exception | meaning |\n|---|---|")
    errors = [f"| `{name}` | {' '.join(words(getattr(lf, name).__doc__).split())} |" for name in ERRORS]
    return "\n\n".join(parts) + "\n" + "\n".join(errors) + "\n"


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page())
