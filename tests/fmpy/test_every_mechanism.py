"""Every FMU of this repository through FMPy: it is valid, its default run works, and every output is finite. With
friction every output is finite or has a reason for having no value."""

from pathlib import Path

import numpy as np
import pytest
from conftest import BOTH_VERSIONS, FMUS
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

#: Allowed drift, relative to the largest kinetic energy. The default tolerance is 1e-9, and some hundred steps add up.
DRIFT = 1e-8


def test_there_are_mechanisms() -> None:
    assert len(FMUS) >= 8
    assert len(BOTH_VERSIONS) == 2 * len(FMUS)


@pytest.mark.parametrize("fmu", BOTH_VERSIONS, ids=[fmu.stem for fmu in BOTH_VERSIONS])
def test_default_experiment(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    result = simulate_fmu(str(fmu))
    names = result.dtype.names
    assert len(names) > 10
    assert [name for name in names if not np.all(np.isfinite(result[name]))] == []
    if "energy.drift" in names:
        assert np.max(np.abs(result["energy.drift"])) < DRIFT * np.max(result["energy.kinetic"])
    else:
        # A hydraulic actuator or system has no mass.
        energies = {name for name in names if name.startswith("energy.")} - {"energy.balance"}
        largest = max(np.max(np.abs(result[name])) for name in energies)
        assert np.max(np.abs(result["energy.balance"])) < DRIFT * largest


@pytest.mark.parametrize("fmu", BOTH_VERSIONS, ids=[fmu.stem for fmu in BOTH_VERSIONS])
def test_default_experiment_with_friction(fmu: Path) -> None:
    """FMPy records every output in each step. If friction locks the mechanism, a force of a drive may have no value."""
    names = {variable.name for variable in read_model_description(str(fmu)).modelVariables}
    if "friction.enabled" not in names:
        pytest.skip("no friction")
    result = simulate_fmu(str(fmu), start_values={"friction.enabled": True})
    locked = [name for name in result.dtype.names if name.endswith(".self_locking")]
    assert locked
    for name in result.dtype.names:
        defined = np.isfinite(result[name])
        drive, _, term = name.rpartition(".")
        if term.startswith(("required_force", "breakaway_")):
            defined |= result[f"{drive}.self_locking"].astype(bool)
        assert np.all(defined), name
