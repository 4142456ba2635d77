"""The results of a check of a definition."""

from __future__ import annotations

import html
import json
from dataclasses import dataclass
from typing import Any

from . import _engine
from ._errors import wrong


@dataclass(frozen=True)
class Finding:
    """An error or a warning about one place in a definition."""

    #: Severity of the finding: `error` or `warning`.
    severity: str
    #: Path of the key with the error or warning, such as `bodies.crank.length`. The attribute `path` is empty if the
    #: finding concerns the whole file.
    path: str
    #: Description of the error or warning, with the wrong value and the limit.
    message: str
    #: Correction of the error or warning. The attribute `remedy` is empty if the attribute `message` already states the
    #: correction.
    remedy: str
    #: Line number of the finding in the text of the definition. The first line is 1.
    line: int
    #: Column number of the finding in the text of the definition. The first column is 1.
    column: int

    def __str__(self) -> str:
        place = f"{self.path}: " if self.path and not self.message.startswith(self.path) else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        return f"{self.severity}: {place}{self.message}{remedy}"


@dataclass(frozen=True)
class Quantity:
    """A number with its name and unit."""

    #: Name of the number, such as `stroke`.
    name: str
    #: Value of the number in SI units.
    value: float
    #: Unit of the number. The unit is `1` for a number without a unit.
    unit: str

    def __str__(self) -> str:
        return f"{self.name} {self.value:.6g}" + ("" if self.unit == "1" else f" {self.unit}")


@dataclass(frozen=True)
class Fact:
    """A computed fact about the mechanism, such as a travel, a dead centre, a stroke or an equilibrium."""

    #: Topic of the fact, such as `Travel`.
    topic: str
    #: Name of the coordinate, drive, joint or other element that the fact describes. The attribute `of` is empty for a
    #: fact about the whole model.
    of: str
    #: Numbers of the fact, with names and units.
    quantities: tuple[Quantity, ...]
    #: Additional explanation of the fact in words. The explanation can be empty.
    text: str

    def __getitem__(self, name: str) -> float:
        """Value of the quantity with this name, in SI units."""
        for quantity in self.quantities:
            if isinstance(name, str) and quantity.name == name:
                return quantity.value
        known = ", ".join(quantity.name for quantity in self.quantities)
        raise KeyError(f"this fact has no quantity {name!r}; it has: {known or 'none'}")

    def __str__(self) -> str:
        parts = [", ".join(map(str, self.quantities)), self.text]
        return (f"{self.of}: " if self.of else "") + "; ".join(part for part in parts if part)


@dataclass(frozen=True)
class Report:
    """All findings (errors and warnings) about a definition, and computed facts about its mechanism. The function
    `print` shows the report in the same form as the command `linkage-fmu check`."""

    #: Name of the model. The name of the model is empty if the program could not read the definition.
    name: str
    #: List of errors and warnings about the definition.
    findings: tuple[Finding, ...]
    #: List of computed facts about the mechanism, such as travel and dead centres, sorted by topic.
    facts: tuple[Fact, ...]
    #: Text of the report.
    text: str

    @property
    def errors(self) -> list[Finding]:
        """List of errors in the definition. The program cannot simulate a definition with an error."""
        return [finding for finding in self.findings if finding.severity == "error"]

    @property
    def warnings(self) -> list[Finding]:
        """List of warnings about the definition. The program can simulate a definition with a warning, but the
        definition probably contains a mistake."""
        return [finding for finding in self.findings if finding.severity == "warning"]

    def about(self, topic: str) -> list[Fact]:
        """Return the facts whose topic starts with the text in `topic`, such as `Travel` or `Equilibri`."""
        if not isinstance(topic, str):
            wrong("topic", topic, "a text")
        return [fact for fact in self.facts if fact.topic.startswith(topic)]

    def __str__(self) -> str:
        return self.text.rstrip()

    def __repr__(self) -> str:
        return f"<Report on {self.name or 'no model'}: {len(self.errors)} errors, {len(self.warnings)} warnings>"

    def _repr_html_(self) -> str:
        # Imported here, because the import also imports numpy.
        from ._html import Html, table

        rows: list[tuple[str, ...]] = []
        for finding in self.findings:
            remedy = f"<br><i>{html.escape(finding.remedy)}</i>" if finding.remedy else ""
            rows.append(
                (
                    Html(f"<b>{html.escape(finding.severity)}</b>"),
                    finding.path,
                    Html(html.escape(finding.message) + remedy),
                )
            )
        for fact in self.facts:
            numbers = ", ".join(map(str, fact.quantities))
            rows.append((fact.topic, fact.of, "; ".join(part for part in (numbers, fact.text) if part)))
        return table(f"{self.name or 'no model'}: {len(self.errors)} errors, {len(self.warnings)} warnings", rows)


def report(kind: str, text: str, shown: str) -> Report:
    """Check the text of a definition of this kind."""
    checked, words = _engine.check(kind, text, shown)
    found: dict[str, Any] = json.loads(checked)
    keys = ("severity", "path", "message", "remedy", "line", "column")
    findings = tuple(Finding(**{key: finding[key] for key in keys}) for finding in found["findings"])
    facts = tuple(
        Fact(fact["topic"], fact["of"], tuple(Quantity(**own) for own in fact["quantities"]), fact["text"])
        for fact in found["facts"]
    )
    return Report(found["name"], findings, facts, words)
