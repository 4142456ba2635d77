"""Every mechanism of this repository through FMPy: it validates, it runs by default, and every output is finite."""

import math
from pathlib import Path

import numpy as np
import pytest
from conftest import FMU_FOLDER
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu

FMUS = sorted(FMU_FOLDER.glob("*.fmu"))
#: Part of the largest kinetic energy; the default tolerance is 1e-9, and some hundred steps add up.
DRIFT = 1e-8


def test_there_are_mechanisms() -> None:
    assert len(FMUS) >= 8


@pytest.mark.parametrize("fmu", FMUS, ids=[fmu.stem for fmu in FMUS])
def test_default_experiment(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    result = simulate_fmu(str(fmu))
    names = result.dtype.names
    assert len(names) > 10
    assert [name for name in names if not all(math.isfinite(value) for value in result[name])] == []
    assert np.max(np.abs(result["energy.drift"])) < DRIFT * np.max(result["energy.kinetic"])
