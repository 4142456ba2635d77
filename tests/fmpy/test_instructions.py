"""Instruction counts of the landing gear: a cost that grows is found without a clock."""

from __future__ import annotations

import csv
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import NAME, REPOSITORY
from counted import SCENES

COUNTED = REPOSITORY / "validation" / "results" / "instructions.csv"
"""Counts of `cargo fmu bench instructions`."""
MARGIN = 1.1
"""Largest count of a run, divided by the stated count. Other compilers and libraries differ by less."""


def counts(folder: Path) -> list[int]:
    """Instructions in the FMU's library, between two calls of getppid."""
    found = []
    for number in range(1, 4 * len(SCENES) + 1):
        total, inside, called = 0, False, False
        for line in (folder / f"out.{number}").read_text().splitlines():
            if line.startswith("ob="):
                inside = line.endswith(f"{NAME}.so")
            elif inside and line[:1].isdigit():
                # The line after `calls=` repeats the cost of the called function.
                total += 0 if called else int(line.split()[1])
            called = line.startswith("calls=")
        found.append(total)
    return found


@pytest.mark.skipif(not shutil.which("valgrind"), reason="valgrind is not installed")
def test_no_run_costs_more_than_stated(extracted: Path, tmp_path: Path) -> None:
    callgrind = [
        "valgrind",
        "--tool=callgrind",
        f"--callgrind-out-file={tmp_path}/out",
        "--dump-before=getppid",
    ]
    program = [
        sys.executable,
        str(Path(__file__).with_name("counted.py")),
        str(extracted),
    ]
    options = ["--compress-strings=no", "--compress-pos=no"]
    done = subprocess.run([*callgrind, *options, *program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with COUNTED.open(encoding="utf-8", newline="") as file:
        stated = {
            (row["scene"], row["reads"], int(row["steps"])): float(row["instructions_per_run"])
            for row in csv.DictReader(file)
        }
    # Four intervals for each scene: set-up, the first run, a pause, the second run.
    second = dict(zip(SCENES, counts(tmp_path)[3::4], strict=True))
    ratios = {scene: count / stated[scene] for scene, count in second.items()}
    print(ratios)
    assert all(0.5 < ratio < MARGIN for ratio in ratios.values()), ratios
