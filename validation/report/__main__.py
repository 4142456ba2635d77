"""Write the report.

usage: python -m report FMU_FOLDER --out DIR
"""

from __future__ import annotations

import argparse
from pathlib import Path

from .build import sections
from .drawing import write
from .page import text


def main() -> None:
    """Run everything, draw, write."""
    parser = argparse.ArgumentParser(prog="report", description="Recompute the papers' figures from FMU runs.")
    parser.add_argument("fmus", type=Path, help="folder of the packed FMUs")
    parser.add_argument("--out", type=Path, required=True, help="folder for report.md and figures/")
    arguments = parser.parse_args()
    found = sections(arguments.fmus)
    folder = arguments.out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    for section in found:
        for figure in section.figures:
            write(figure, folder)
    page = arguments.out / "report.md"
    page.write_text(text(found), encoding="utf-8", newline="\n")
    for section in found:
        for claim in section.claims:
            print(f"{claim.source:22} {claim.statement}: {claim.paper} | {claim.ours}")
    print(f"page                   {page}")


if __name__ == "__main__":
    main()
