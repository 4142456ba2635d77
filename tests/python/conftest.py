"""The installed package, and mechanisms from it."""

from __future__ import annotations

import linkage_fmu as lf
import pytest


@pytest.fixture(scope="session")
def gear() -> lf.Mechanism:
    return lf.example("LandingGearRetraction")


@pytest.fixture
def simulation(gear: lf.Mechanism) -> lf.Simulation:
    simulation = gear.simulation()
    simulation.initialize()
    return simulation
