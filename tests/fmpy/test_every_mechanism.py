"""Every FMU of this repository through FMPy: it validates, it runs by default, and every output is finite; with
friction every output is finite or does not exist for a reason."""

import math
from pathlib import Path

import numpy as np
import pytest
from conftest import FMU_FOLDER
from fmpy import read_model_description, simulate_fmu
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
    pairs = [("energy.drift", "energy.kinetic"), ("energy.balance", "energy.supplied")]
    drift, size = next(pair for pair in pairs if pair[0] in names)
    assert np.max(np.abs(result[drift])) < DRIFT * np.max(result[size])


@pytest.mark.parametrize("fmu", FMUS, ids=[fmu.stem for fmu in FMUS])
def test_default_experiment_with_friction(fmu: Path) -> None:
    """FMPy records every output in each step. A force of a drive may not exist where friction locks the mechanism."""
    names = {variable.name for variable in read_model_description(str(fmu)).modelVariables}
    if "friction.enabled" not in names:
        pytest.skip("no friction")
    result = simulate_fmu(str(fmu), start_values={"friction.enabled": True})
    locked = [name for name in result.dtype.names if name.endswith(".self_locking")]
    assert locked
    for name in result.dtype.names:
        told = np.isfinite(result[name])
        drive, _, term = name.rpartition(".")
        if term.startswith(("required_force", "breakaway_")):
            told |= result[f"{drive}.self_locking"].astype(bool)
        assert np.all(told), name
