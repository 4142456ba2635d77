"""The documentation in an FMU, compared with FMPy: reference results, the notebook that FMPy creates, pictures."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import nbformat
import numpy as np
import pytest
from conftest import FMUS, REPOSITORY, program
from fmpy import read_csv, read_model_description, simulate_fmu
from fmpy.util import create_jupyter_notebook
from lxml import etree

RESULTS = "extra/org.fmi-standard.fmi-ls-ref"
LAYERED = "{http://fmi-standard.org/fmi-ls-manifest}"
#: Roles of the layered standard.
ROLES = {"result", "other", "model", "document"}
#: Outputs that consist of rounding only.
ERRORS = {"energy.drift", "energy.balance"}
#: Allowed change of a column by rounded inputs, relative to its largest value. The tolerance is 1e-9 per step.
ROUNDED = 1e-6
#: Allowed difference of a column that consists of rounding only, such as a force of a joint on a line [SI units].
NOTHING = 1e-9


def unpacked(fmu: Path, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    return folder


@pytest.mark.parametrize("fmu", FMUS, ids=[fmu.stem for fmu in FMUS])
def test_the_reference_results_are_those_of_the_fmu(fmu: Path, tmp_path: Path) -> None:
    """FMPy's run of the packed library in steps of the default size is bit-identical to the results in the FMU. With
    their inputs, which FMPy interpolates and so rounds, it agrees to the tolerance."""
    folder = unpacked(fmu, tmp_path)
    manifest = etree.parse(folder / RESULTS / "fmi-ls-manifest.xml").getroot()
    assert manifest.tag == "fmiReferences"
    assert manifest.get(f"{LAYERED}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    assert manifest.get(f"{LAYERED}fmi-ls-version") == "1.0.0-alpha.1"
    sources = {related.get("source"): related for related in manifest.iter("Related")}
    assert {related.get("role") for related in sources.values()} <= ROLES
    assert [source for source in sources if not (folder / RESULTS / source).is_file()] == []
    expected = read_csv(folder / RESULTS / f"{fmu.stem}_out.csv")
    assert sources[f"{fmu.stem}_out.csv"].get("role") == "result"
    described = read_model_description(str(fmu))
    outputs = {variable.name for variable in described.modelVariables if variable.causality == "output"}
    assert set(expected.dtype.names) == {"time"} | outputs
    stop = float(described.defaultExperiment.stopTime)
    assert (expected["time"][0], expected["time"][-1]) == (0.0, pytest.approx(stop))
    assert 10 < len(expected) <= 202
    step = float(described.defaultExperiment.stepSize)
    run = simulate_fmu(str(fmu), output_interval=step)
    rows = np.searchsorted(run["time"], expected["time"])
    for name in expected.dtype.names:
        np.testing.assert_array_equal(run[name][rows].astype(float), expected[name], err_msg=name)
    inputs = folder / RESULTS / f"{fmu.stem}_in.csv"
    if inputs.exists():
        run = simulate_fmu(str(fmu), input=read_csv(inputs), output_interval=step)
        for name in set(expected.dtype.names) - ERRORS:
            scale = np.max(np.abs(expected[name]))
            np.testing.assert_allclose(
                run[name][rows].astype(float), expected[name], rtol=0.0, atol=ROUNDED * scale + NOTHING, err_msg=name
            )


@pytest.mark.parametrize("fmu", FMUS, ids=[fmu.stem for fmu in FMUS])
def test_fmpys_notebook_runs(fmu: Path, tmp_path: Path) -> None:
    """`fmpy create-jupyter-notebook`: the notebook is valid, and its cells run to the end as one program, with the plot
    that docs/viewers.md names. Plotly draws it. No browser shows it."""
    shutil.copy(fmu, tmp_path)
    create_jupyter_notebook(str(tmp_path / fmu.name))
    notebook = nbformat.read(tmp_path / f"{fmu.stem}.ipynb", as_version=4)
    nbformat.validate(notebook)
    cells = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    text = (REPOSITORY / "docs" / "viewers.md").read_text(encoding="utf-8")
    (documented,) = re.findall(r"`(plot_result\(result, names=.*?\))`", text)
    line = documented if fmu.stem == "SliderCrank" else "plot_result(result, names=output[:17])"
    assert cells.endswith("\nplot_result(result)")
    before = "import plotly.graph_objects as go\nshown = []\ngo.Figure.show = lambda figure: shown.append(figure)\n"
    after = "\nassert len(shown) == 1 and 0 < len(shown[0].data) <= 17\nprint(len(result), *result.dtype.names)\n"
    program = before + cells.removesuffix("plot_result(result)") + line + after
    (tmp_path / "notebook.py").write_text(program, encoding="utf-8")
    done = subprocess.run([sys.executable, "notebook.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300.0)
    assert done.returncode == 0, done.stderr
    count, time, *names = done.stdout.split()
    assert (int(count) > 10, time) == (True, "time")
    variables = read_model_description(str(fmu)).modelVariables
    assert set(names) == {variable.name for variable in variables if variable.causality == "output"}


def test_pictures_are_pictures(tmp_path: Path) -> None:
    for fmu in FMUS:
        with zipfile.ZipFile(fmu) as archive:
            pixels = archive.read("model.png")
            assert archive.read("terminalsAndIcons/icon.png") == pixels
            root = etree.fromstring(archive.read("terminalsAndIcons/icon.svg"))
        # Width and height in the header of the PNG file.
        assert (pixels[:8], pixels[16:24]) == (b"\x89PNG\r\n\x1a\n", b"\x00\x00\x01\x00" * 2), fmu.stem
        assert root.get("viewBox") == "0 0 256 256"


def test_own_files_replace_generated_ones_and_excluded_files_are_omitted(tmp_path: Path) -> None:
    folder = tmp_path / "FourBar"
    shutil.copytree(REPOSITORY / "modelDescription" / "FourBar", folder)
    (folder / "documentation").mkdir()
    (folder / "documentation" / "index.html").write_text("<html>mine</html>", encoding="utf-8")
    (folder / "documentation" / "more.txt").write_text("more", encoding="utf-8")
    options = ["--out", str(tmp_path), "--no-animation", "--no-results"]
    command = [*program("fmu-build"), "package", str(folder), *options]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=900.0)
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stdout.splitlines() if "your own files are packed" in line]
    assert len(said) == 1
    assert said[0].endswith("instead of the generated files: documentation/index.html")
    with zipfile.ZipFile(tmp_path / "FourBar.fmu") as archive:
        names = archive.namelist()
        assert archive.read("documentation/index.html") == b"<html>mine</html>"
    assert "documentation/more.txt" in names
    assert not [name for name in names if name.startswith("extra/") or name.endswith("animation.html")]
