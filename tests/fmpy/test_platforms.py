"""`cargo fmu package --binary`: libraries of further platforms. FMPy ships some that are built elsewhere."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from conftest import NAME
from fmpy.validation import validate_fmu
from test_own_mechanism import package as package_in
from test_own_mechanism import refused

SHIPPED = Path(fmpy.__file__).parent
"""Where FMPy's own libraries are."""
CONTAINER = SHIPPED / "container_fmu" / "binaries"
"""FMPy's own FMUs, with the functions of FMI 2.0."""
LIBRARIES = {
    "win64": CONTAINER / "x86_64-windows" / "container_fmu.dll",
    "win32": SHIPPED / "remoting" / "win32" / "client_tcp.dll",
    "darwin64": CONTAINER / "aarch64-darwin" / "container_fmu.dylib",
}


def package(out: Path, *binaries: str) -> subprocess.CompletedProcess[str]:
    """`cargo fmu package` with these `--binary` arguments."""
    return package_in(Path(), "--out", str(out), *(option for binary in binaries for option in ("--binary", binary)))


def test_binaries_lie_in_their_folders(tmp_path: Path) -> None:
    done = package(tmp_path, *(f"{platform}={path}" for platform, path in LIBRARIES.items()))
    assert done.returncode == 0, done.stderr
    fmu = tmp_path / f"{NAME}.fmu"
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
        for platform, path in LIBRARIES.items():
            assert archive.read(f"binaries/{platform}/{NAME}{path.suffix}") == path.read_bytes()
    assert f"binaries/linux64/{NAME}.so" in names
    assert validate_fmu(str(fmu)) == []
    assert {*LIBRARIES, "linux64"} <= set(fmpy.supported_platforms(str(fmu)))


REFUSED = {
    "another platform's library": (f"win32={LIBRARIES['win64']}", ["container_fmu.dll", "win32", "X86_64", "I386"]),
    "another system's library": (f"darwin64={LIBRARIES['win64']}", ["darwin64", "Pe for X86_64", "MachO"]),
    "no library": (f"win64={Path(__file__)}", ["test_platforms.py", "no library"]),
    "no FMU's library": (f"win64={SHIPPED / 'logging' / 'win64' / 'logging.dll'}", ["does not export fmi2Instantiate"]),
    "no file": ("win64=nowhere.dll", ["nowhere.dll", "no such file"]),
    "a folder": (f"win64={CONTAINER}", ["no such file"]),
    "this platform": (f"linux64={CONTAINER / 'x86_64-linux' / 'container_fmu.so'}", ["linux64", "built here"]),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_library_of_the_platform_is_refused(tmp_path: Path, name: str) -> None:
    binary, fragments = REFUSED[name]
    line = refused(package(tmp_path / "out", binary))
    for fragment in fragments:
        assert fragment in line
    assert not (tmp_path / "out").exists()


def test_a_platform_twice_is_refused(tmp_path: Path) -> None:
    binary = f"win64={LIBRARIES['win64']}"
    assert "given twice" in refused(package(tmp_path, binary, binary))


def test_an_unknown_platform_is_a_wrong_usage(tmp_path: Path) -> None:
    done = package(tmp_path, f"win16={LIBRARIES['win64']}")
    assert done.returncode == 2
    assert "win16" in done.stderr
    assert "darwin64" in done.stderr
