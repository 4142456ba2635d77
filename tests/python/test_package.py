"""The package as a whole: import, types, command."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import linkage_fmu as lf
import pytest

PACKAGE = Path(lf.__file__).parent


def python(*words: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], cwd=folder, capture_output=True, text=True, check=False)


def test_large_packages_are_imported_at_first_use() -> None:
    names = "('numpy', 'pandas', 'matplotlib', 'json', 'typing')"
    done = python("-c", f"import sys; import linkage_fmu; print([n for n in {names} if n in sys.modules])")
    assert done.stdout.strip() == "[]", done


def test_every_name_is_there() -> None:
    for name in lf.__all__:
        assert getattr(lf, name).__doc__, name
    assert lf.__version__
    with pytest.raises(AttributeError, match="simulat"):
        _ = lf.simulat


def test_a_missing_package_is_named_before_a_study(gear: lf.Mechanism, monkeypatch: pytest.MonkeyPatch) -> None:
    study = {
        "factors": {"load_factor": {"values": [1, 2]}},
        "scenario": {},
        "responses": {"a": {"final": "crank.angle"}},
    }
    run = gear.simulate(stop_time=0.0)
    for name in ("pandas", "matplotlib"):
        # Python raises ModuleNotFoundError for such a package.
        monkeypatch.setitem(sys.modules, name, None)
    done: list[int] = []
    for call in (
        run.to_pandas,
        gear.kinematics(2).to_pandas,
        lambda: lf.sweep(study, gear, progress=lambda *_: done.append(1)),
    ):
        with pytest.raises(ModuleNotFoundError, match="pip install pandas"):
            call()
    assert not done
    with pytest.raises(ModuleNotFoundError, match="pip install matplotlib"):
        run.plot("crank.angle")


def test_the_types_are_strict(tmp_path: Path) -> None:
    """The package, and a program of a user."""
    # In a separate folder, because mypy ignores files of an environment.
    shutil.copytree(PACKAGE, tmp_path / "linkage_fmu", ignore=shutil.ignore_patterns("*.so", "*.pyd", "__pycache__"))
    user = tmp_path / "user.py"
    user.write_text(
        "import linkage_fmu as lf\n"
        "gear: lf.Mechanism = lf.example('FourBar')\n"
        "run: lf.Result = gear.simulate(stop_time=0.1, output=['crank.angle'])\n"
        "simulation: lf.Simulation = gear.simulation({'crank.mass': 1.0})\n"
        "value = simulation.get(simulation.prepare(['crank.angle']))[0]\n",
        encoding="utf-8",
    )
    settings = Path(__file__).parent / "pyproject.toml"
    done = python("-m", "mypy", "--config-file", str(settings), "linkage_fmu", "user.py", folder=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stubs_agree_with_the_extension() -> None:
    stubs = (PACKAGE / "_engine.pyi").read_text(encoding="utf-8")
    for own in (lf.Simulation, lf.State, lf.Names, lf._engine.Model, lf._engine.Plan):
        for name in vars(own):
            if not name.startswith("_") or name in ("__getitem__", "__setitem__", "__copy__", "__enter__"):
                assert f"def {name}(" in stubs, f"{own.__name__}.{name}"
    for name in dir(lf._engine):
        assert name.startswith("__") or f"def {name}(" in stubs or f"class {name}" in stubs, name


def test_the_module_is_the_command(tmp_path: Path) -> None:
    done = python("-m", "linkage_fmu", "--help", folder=tmp_path)
    assert done.returncode == 0
    assert "Usage: linkage-fmu" in done.stdout
    assert "cargo" not in done.stdout
    done = python("-m", "linkage_fmu", "check", "nowhere.json", folder=tmp_path)
    assert done.returncode == 1
    assert "there is no such file" in done.stdout
    done = python("-m", "linkage_fmu", "simulat", folder=tmp_path)
    assert done.returncode == 2
