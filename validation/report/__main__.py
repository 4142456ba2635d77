"""Write the report.

usage: python -m report FMU_FOLDER --motion PAGE --out DIR
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench_figures import figures as benchmarks

from .build import sections
from .drawing import drawn, write
from .html import Shown, html
from .page import text


def main() -> None:
    """Run everything, draw, write."""
    parser = argparse.ArgumentParser(prog="report", description="Recompute the papers' figures from FMU runs.")
    parser.add_argument("fmus", type=Path, help="folder of the packed FMUs")
    parser.add_argument("--motion", type=Path, required=True, help="page of `cargo fmu view` with the landing gear")
    parser.add_argument("--out", type=Path, required=True, help="folder for report.md, report.html and figures/")
    arguments = parser.parse_args()
    found = sections(arguments.fmus)
    folder = arguments.out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    for section in found:
        for figure in section.figures:
            write(figure, folder)
    page = arguments.out / "report.md"
    page.write_text(text(found), encoding="utf-8", newline="\n")
    pictures = {
        figure.name: (folder / f"{figure.name}.png").read_bytes() for section in found for figure in section.figures
    }
    measured = [Shown(figure, drawn(figure)[0]) for figure in benchmarks(Path(__file__).parents[1] / "results")]
    whole = arguments.out / "report.html"
    motion = arguments.motion.read_text(encoding="utf-8")
    whole.write_text(html(found, pictures, motion, measured), encoding="utf-8", newline="\n")
    for section in found:
        for claim in section.claims:
            print(f"{claim.source:22} {claim.statement}: {claim.paper} | {claim.ours}")
    for written in (page, whole):
        print(f"page                   {written} ({written.stat().st_size / 1000:.0f} kB)")


if __name__ == "__main__":
    main()
