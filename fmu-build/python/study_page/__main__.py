"""Pictures of a study: `page.html` for the browser, PNG files next to it, Sobol's indices as CSV.

usage: study_page TABLE PLAN --out DIR

The table is written by `cargo fmu sweep` or `cargo fmu optimise`; the plan describes its columns.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parent))

import pictures
from page import html
from results import Results


def main() -> None:
    """Read the results, draw them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=Path)
    parser.add_argument("plan", type=json.loads)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    results = Results.read(arguments.table, arguments.plan)
    if not results.responses:
        sys.exit(f"{arguments.table}: nothing can be drawn, because each response has the same value in all runs")
    for name, canvas in pictures.all_of(results):
        canvas.savefig(arguments.out / f"{name}.png", dpi=110, metadata={"Software": None})
    if rows := list(results.rows_of_indices()):
        with (arguments.out / "sobol_indices.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(rows)
    (arguments.out / "page.html").write_text(html(results), encoding="utf-8")


if __name__ == "__main__":
    main()
