"""The wheel from the source distribution (PEP 517): Cargo builds it with `cargo fmu dist`, as in the repository."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def build_wheel(
    wheel_directory: str, config_settings: dict[str, str] | None = None, metadata_directory: str | None = None
) -> str:
    """Build the wheel for this machine into the folder. Returns its name."""
    if shutil.which("cargo") is None:
        sys.exit(
            "linkage-fmu: this is the source distribution, which needs Rust 1.89 or later; install Rust from "
            "https://rustup.rs, or install a wheel for this system and this version of Python"
        )
    words = ["cargo", "run", "--release", "--locked", "--quiet", "--package", "fmu-cli", "--"]
    # The interpreter of pip creates the environment of maturin.
    environment = {**os.environ, "PYTHON": sys.executable}
    subprocess.run([*words, "dist", "--out", wheel_directory], cwd=ROOT, env=environment, check=True)
    [wheel] = Path(wheel_directory).glob("*.whl")
    return wheel.name
