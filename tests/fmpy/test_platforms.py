"""`cargo fmu package --binary` and `--platforms`: libraries of further platforms. FMPy ships some that are built
elsewhere."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from conftest import NAME, REPOSITORY
from fmpy.validation import validate_fmu
from test_own_mechanism import package as package_in
from test_own_mechanism import refused

SHIPPED = Path(fmpy.__file__).parent
"""Folder of FMPy's own libraries."""
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
    third = tmp_path / f"{NAME}.fmi3.fmu"
    with zipfile.ZipFile(third) as archive:
        folders = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}
    # The library for win32 has the functions of FMI 2.0 only.
    assert folders == {"x86_64-linux", "x86_64-windows", "aarch64-darwin"}
    assert f"{third}: the library for win32 is left out" in done.stdout
    assert {*LIBRARIES, "linux64"} <= set(fmpy.supported_platforms(str(fmu)))


REFUSED = {
    "another platform's library": (f"win32={LIBRARIES['win64']}", ["container_fmu.dll", "win32", "X86_64", "I386"]),
    "a processor's": (f"aarch64-linux={CONTAINER / 'x86_64-linux' / 'container_fmu.so'}", ["X86_64", "Aarch64"]),
    "another system's library": (
        f"darwin64={LIBRARIES['win64']}",
        ["darwin64", "Pe for the processor X86_64", "MachO"],
    ),
    "no library": (f"win64={Path(__file__)}", ["test_platforms.py", "not a library"]),
    "no FMU's library": (f"win64={SHIPPED / 'logging' / 'win64' / 'logging.dll'}", ["does not export fmi2Instantiate"]),
    "no file": ("win64=nowhere.dll", ["nowhere.dll", "no such file"]),
    "a folder": (f"win64={CONTAINER}", ["no such file"]),
    "this platform": (f"linux64={CONTAINER / 'x86_64-linux' / 'container_fmu.so'}", ["linux64", "adds the library"]),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_file_that_is_no_library_of_the_platform_is_rejected(tmp_path: Path, name: str) -> None:
    binary, fragments = REFUSED[name]
    line = refused(package(tmp_path / "out", binary))
    for fragment in fragments:
        assert fragment in line
    assert not (tmp_path / "out").exists()


def test_a_duplicate_platform_is_rejected(tmp_path: Path) -> None:
    binary = f"win64={LIBRARIES['win64']}"
    assert "the option occurs twice" in refused(package(tmp_path, binary, binary))


def test_an_unknown_platform_is_a_usage_error(tmp_path: Path) -> None:
    done = package(tmp_path, f"win16={LIBRARIES['win64']}")
    assert done.returncode == 2
    assert "win16" in done.stderr
    assert "darwin64" in done.stderr


@pytest.fixture
def without_arm(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that cannot link for ARM."""
    monkeypatch.setenv("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", "/nowhere/no-such-linker")


@pytest.mark.usefixtures("without_arm")
def test_a_platform_that_cannot_be_built_is_an_error_with_the_remedy(tmp_path: Path) -> None:
    out = tmp_path / "out"
    line = refused(package_in(Path(), "--out", str(out), "--platforms", "x86_64-linux,aarch64-linux"))
    assert "aarch64-linux: cannot be built here" in line
    assert "rustup target add aarch64-unknown-linux-gnu" in line or "apt-get install gcc-aarch64-linux-gnu" in line
    assert "--available" in line
    assert not out.exists()


@pytest.mark.usefixtures("without_arm")
def test_available_packs_the_other_platforms_and_names_the_omitted_ones(tmp_path: Path) -> None:
    done = package_in(Path(), "--out", str(tmp_path), "--platforms", "linux64,aarch64-linux", "--available")
    assert done.returncode == 0, done.stderr
    assert "left out: aarch64-linux: cannot be built here" in done.stdout
    assert fmpy.supported_platforms(str(tmp_path / f"{NAME}.fmu")) == ["linux64"]
    refused(package_in(Path(), "--out", str(tmp_path), "--platforms", "aarch64-linux", "--available"))


WRONG_PLATFORMS = {
    "an unknown one": (["--platforms", "x86_64-linux,vax-vms"], 2, ["vax-vms", "aarch64-linux"]),
    "one built twice": (["--platforms", "linux64", "--binary", "linux64=x.so"], 1, ["x.so", "no such file"]),
    "one folder, two processors": (
        ["--platforms", "aarch64-linux,x86_64-linux", "--compatible"],
        1,
        ["binaries/linux64", "build two FMUs"],
    ),
    "no processor to be compatible": (["--platforms", "linux64", "--compatible"], 1, ["add aarch64-linux"]),
    "a glibc that Rust does not know": (["--glibc", "2.12"], 2, ["2.17"]),
    "a glibc for Windows": (["--platforms", "win64", "--glibc", "2.17"], 1, ["for Linux"]),
    "available what": (["--available"], 2, ["--platforms"]),
}


@pytest.mark.parametrize("name", WRONG_PLATFORMS)
def test_wrong_platforms_are_rejected(tmp_path: Path, name: str) -> None:
    options, code, fragments = WRONG_PLATFORMS[name]
    done = package_in(Path(), "--out", str(tmp_path / "out"), *options)
    assert done.returncode == code, done.stdout + done.stderr
    for fragment in fragments:
        assert fragment in done.stderr
    assert not (tmp_path / "out").exists()


def test_an_fmu_does_not_reveal_where_it_was_built(tmp_path: Path) -> None:
    """Packages from two folders are identical, and contain no path of the repository. `cargo fmu test --reproducible`
    also builds the library twice."""
    contents = []
    for name in ("a", "another folder"):
        folder = tmp_path / name / NAME
        shutil.copytree(REPOSITORY / "modelDescription" / NAME, folder)
        done = package_in(tmp_path / name, "--out", ".", NAME)
        assert done.returncode == 0, done.stderr
        contents.append((tmp_path / name / f"{NAME}.fmu").read_bytes())
    assert contents[0] == contents[1]
    with zipfile.ZipFile(tmp_path / "a" / f"{NAME}.fmu") as archive:
        for entry in archive.namelist():
            content = archive.read(entry)
            assert str(REPOSITORY).encode() not in content, entry
            assert str(tmp_path).encode() not in content, entry


HOST = """
#include <stdio.h>
extern const char *FourBar_fmi2GetVersion(void);
extern const char *SliderCrank_fmi2GetVersion(void);
int main(void) {
    printf("%s %s\\n", FourBar_fmi2GetVersion(), SliderCrank_fmi2GetVersion());
    return 0;
}
"""


@pytest.mark.skipif(shutil.which("x86_64-linux-gnu-gcc") is None, reason="needs GCC for x86_64")
def test_a_host_links_two_fmus(tmp_path: Path) -> None:
    target = "x86_64-unknown-linux-gnu"
    models = ["FourBar", "SliderCrank"]
    paths = [str(REPOSITORY / "modelDescription" / model) for model in models]
    done = package_in(Path(), *paths, "--static", target, "--out", str(tmp_path), "--fmi", "2")
    assert done.returncode == 0, done.stderr
    needed = ""
    for model in models:
        fmu = tmp_path / f"{model}.fmu"
        assert validate_fmu(str(fmu)) == []
        with zipfile.ZipFile(fmu) as archive:
            (tmp_path / f"{model}.a").write_bytes(archive.read(f"binaries/linux64/gnu/{model}.a"))
            page = archive.read("documentation/staticLinking.txt").decode()
        needed = page.split("link in addition:")[1].splitlines()[0]
    (tmp_path / "host.c").write_text(HOST, encoding="utf-8")
    archives = [f"{model}.a" for model in models]
    subprocess.run(["cc", "host.c", *archives, *needed.split(), "-o", "host"], cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "host"], capture_output=True, text=True, check=True).stdout == "2.0 2.0\n"
