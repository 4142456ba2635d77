"""`cargo fmu sweep --page`: the pictures exist and load nothing, and known Sobol's indices are found."""

from __future__ import annotations

import csv
import json
import re
import subprocess
from pathlib import Path

import pyarrow.parquet as parquet
import pytest
from conftest import NAME, REPOSITORY, program

COMMAND = program("fmu-studies")
SAMPLED = {"actuator.force": [28e3, 36e3], "load_factor": [1.0, 3.0], "airspeed": [40.0, 90.0]}
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a small study with Saltelli's design."""
    folder = tmp_path_factory.mktemp("study")
    study = {
        "mechanism": str(REPOSITORY / "modelDescription" / NAME),
        "factors": {name: {"uniform": ends} for name, ends in SAMPLED.items()},
        "sampling": {"method": "saltelli", "count": 128, "seed": 3},
        "scenario": {"stop_time": 0.6, "stop_at": "retracted"},
        # The response `load` is a factor itself, so its indices are 1 and 0.
        "responses": {"retraction": {"event": "retracted"}, "load": {"final": "load_factor"}},
    }
    path = folder / "small.json"
    path.write_text(json.dumps(study), encoding="utf-8")
    command = [*COMMAND, "sweep", str(path), "--page", "--csv", "--out", str(folder / "out")]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout
    return folder / "out"


def test_saltellis_design_has_its_runs_and_its_indices(drawn: Path) -> None:
    with (drawn / "runs.csv").open(encoding="utf-8", newline="") as file:
        runs = list(csv.DictReader(file))
    assert len(runs) == 128 * (len(SAMPLED) + 2)
    with (drawn / "sobol_indices.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * len(SAMPLED)
    for row in rows:
        first, total = float(row["first"]), float(row["total"])
        if row["response"] == "load":
            expected = 1.0 if row["factor"] == "load_factor" else 0.0
            # 128 points of Sobol's sequence: the error of the estimators is some percent.
            assert first == pytest.approx(expected, abs=0.05)
            assert total == pytest.approx(expected, abs=0.05)
        elif row["factor"] == "actuator.force":
            assert 0.8 < first < 1.05


def test_the_table_states_units_and_seed(drawn: Path) -> None:
    stated = parquet.read_schema(drawn / "runs.parquet").metadata
    assert stated[b"linkage_fmu.seed"] == b"3"
    units = json.loads(stated[b"linkage_fmu.units"])
    assert (units["actuator.force"], units["retraction"]) == ("N", "s")


def test_the_pictures_are_there_and_the_page_loads_nothing(drawn: Path) -> None:
    names = ("main_effects", "scatter_matrix", "distributions", "response_surfaces", "sobol_indices")
    for name in names:
        picture = (drawn / f"{name}.png").read_bytes()
        assert picture.startswith(PNG), name
        assert len(picture) > 10_000, name
    page = (drawn / "page.html").read_text(encoding="utf-8")
    assert not re.search(r'<(script|link|img)[^>]*(src|href)="(https?:)?//', page)
    for title in ("Main effects", "Scatter matrix", "Distributions", "Response surfaces", "Sobol's indices"):
        assert f'"title":"{title}"' in page.replace('": "', '":"'), title
