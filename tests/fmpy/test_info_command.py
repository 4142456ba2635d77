"""`cargo fmu info` and `validate`: agreement with FMPy, and every kind of damage of an FMU."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
from conftest import BOTH_VERSIONS, FMU_FOLDER, NAME, REPOSITORY, program
from fmpy import read_model_description

Command = Callable[..., subprocess.CompletedProcess[str]]
Change = Callable[[str, bytes], tuple[str, bytes] | None]


@pytest.fixture
def command(tmp_path: Path) -> Command:
    """`cargo fmu` with these arguments, called in a separate folder."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        words = [*program("fmu-build"), *map(str, arguments)]
        return subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", timeout=900.0)

    return run


@pytest.mark.skipif(sys.platform != "linux", reason="glibc is Linux's")
def test_the_required_glibc_is_reported(command: Command, extracted: Path) -> None:
    library = extracted / "binaries" / "linux64" / f"{NAME}.so"
    asked = {version.decode() for version in re.findall(rb"GLIBC_(2\.\d+(?:\.\d+)?)\0", library.read_bytes())}
    newest = max(asked, key=lambda version: [int(part) for part in version.split(".")])
    fmu = FMU_FOLDER / f"{NAME}.fmu"
    needs = json.loads(command("info", fmu, "--json").stdout)["needs"]["linux64"]
    assert needs["glibc"] == newest
    assert needs["functions"]
    assert f"linux64 (needs glibc {newest})" in command("info", fmu).stdout
    done = command("validate", fmu)
    assert f"needs glibc {newest} or later (for {', '.join(needs['functions'])})" in done.stdout
    assert "0 errors, 0 warnings" in done.stdout


@pytest.mark.parametrize("name", [NAME, "HydraulicActuator"])
def test_info_agrees_with_fmpy(command: Command, name: str) -> None:
    fmu = FMU_FOLDER / f"{name}.fmu"
    done = command("info", fmu, "--json")
    assert done.returncode == 0, done.stderr
    info = json.loads(done.stdout)
    read = read_model_description(str(fmu))
    assert (info["fmi_version"], info["name"], info["guid"]) == (read.fmiVersion, read.modelName, read.guid)
    assert info["description"] == read.description
    assert info["generation_tool"] == read.generationTool
    kinds = {"CoSimulation": read.coSimulation, "ModelExchange": read.modelExchange}
    assert info["interfaces"] == {kind: offered.modelIdentifier for kind, offered in kinds.items() if offered}
    assert info["platforms"] == fmpy.supported_platforms(str(fmu))
    experiment = read.defaultExperiment
    assert info["experiment"] == {
        "start_time": float(experiment.startTime),
        "stop_time": float(experiment.stopTime),
        "step_size": float(experiment.stepSize),
        "tolerance": float(experiment.tolerance),
    }
    for here, there in zip(info["variables"], read.modelVariables, strict=True):
        assert here == {
            "name": there.name,
            "reference": str(there.valueReference),
            "kind": there.type,
            "causality": there.causality,
            "variability": there.variability,
            "unit": there.unit or "",
            "start": there.start,
            "description": there.description,
        }


def test_info_in_words(command: Command) -> None:
    done = command("info", REPOSITORY / "modelDescription" / NAME)
    assert done.returncode == 0, done.stderr
    lines = [line.split() for line in done.stdout.splitlines()]
    read = read_model_description(str(FMU_FOLDER / f"{NAME}.fmu"))
    for variable in read.modelVariables:
        words = [
            variable.name,
            *([variable.start] if variable.start is not None else []),
            variable.unit or variable.type,
        ]
        assert any(line[: len(words)] == words for line in lines), words
    inputs = sum(variable.causality == "input" for variable in read.modelVariables)
    assert f"variables    {len(read.modelVariables)}: {inputs} inputs" in done.stdout


def test_every_packed_fmu_is_valid(command: Command) -> None:
    done = command("validate", *BOTH_VERSIONS, REPOSITORY / "docs" / "gallery" / "peaucellier.json")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("valid: 0 errors, 0 warnings") == len(BOTH_VERSIONS) + 1


def without(part: str) -> Change:
    return lambda name, content: None if part in name else (name, content)


def edited(part: str, old: bytes, new: bytes) -> Change:
    return lambda name, content: (name, content.replace(old, new)) if part in name else (name, content)


def cut(part: str, size: int) -> Change:
    return lambda name, content: (name, content[:size]) if part in name else (name, content)


@pytest.mark.parametrize(
    ("change", "said", "is_valid"),
    [
        (
            edited("mechanism.json", b'"force": 30000', b'"force": 20000'),
            "the start value of actuator.force in modelDescription.xml differs",
            True,
        ),
        (edited("mechanism.json", b"coupler", b"kuppler"), "modelDescription.xml has no variable kuppler.angle", False),
        (edited("modelDescription", b'guid="{', b'guid="{0'), "guid is", False),
        (edited("modelDescription", b'unit="kg"', b'unit="g"'), "unit of crank.mass are", False),
        (edited("mechanism.json", b'"mass"', b'"weight"'), "weight", False),
        (edited("mechanism.json", b'"mass"', b'"ma\xdf"'), "is not UTF-8", False),
        (without("binaries"), "contains no library", False),
        (cut("binaries", 5000), ".so", False),
        (without("modelDescription"), "contains no modelDescription.xml", False),
        # Truncated between two elements, and within a word.
        (cut("modelDescription", 3000), "the text is not XML", False),
        (cut("modelDescription", 2990), "the text is not XML", False),
        (without("mechanism.json"), "contains no resources/mechanism.json", False),
        (
            lambda name, content: (name.replace("documentation/", "../"), content),
            "leads out of the folder",
            False,
        ),
    ],
)
def test_corrupted_files_are_reported(
    command: Command, fmu: Path, tmp_path: Path, change: Change, said: str, is_valid: bool
) -> None:
    damaged = tmp_path / "damaged gear.fmu"
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(damaged, "w", zipfile.ZIP_DEFLATED) as target:
        for name in source.namelist():
            entry = change(name, source.read(name))
            if entry is not None:
                target.writestr(*entry)
    done = command("validate", damaged.name)
    assert said in done.stdout, done.stdout + done.stderr
    assert done.returncode == (0 if is_valid else 1)
    assert done.stdout.splitlines()[-1].startswith(f"damaged gear.fmu: {'valid' if is_valid else 'not valid'}: ")


def test_damaged_bytes_are_reported(command: Command, fmu: Path, tmp_path: Path) -> None:
    whole = fmu.read_bytes()
    for name, content in [
        ("half.fmu", whole[: len(whole) // 2]),
        ("bit.fmu", whole[:500_000] + bytes([whole[500_000] ^ 1]) + whole[500_001:]),
    ]:
        (tmp_path / name).write_bytes(content)
        done = command("validate", name)
        assert done.returncode == 1
        assert done.stdout.startswith("error: ")
