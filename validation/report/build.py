"""All sections, from the packed FMUs."""

from __future__ import annotations

from pathlib import Path

from . import ck16_jib, ck16_slider_crank, design, hf08_friction, hf08_inverse, hf08_loads, hf08_motion
from .fmu import Fmu
from .gear import Travel, retract
from .page import Section

GEAR, SLIDER_CRANK, JIB = "LandingGearRetraction", "SliderCrank", "Jib"
"""Names of the FMUs."""


def sections(folder: Path) -> list[Section]:
    """Everything but the drawings; `folder` holds the FMUs."""
    with Fmu(folder / f"{GEAR}.fmu") as gear:
        travel = Travel.of(gear)
        found = [
            hf08_loads.section(gear, travel),
            hf08_motion.section(gear, travel),
            hf08_friction.section(gear, travel, retract(gear, travel, {})),
            hf08_inverse.section(gear, travel),
        ]
    with Fmu(folder / f"{SLIDER_CRANK}.fmu") as slider_crank:
        found.append(ck16_slider_crank.section(slider_crank))
    with Fmu(folder / f"{JIB}.fmu") as jib:
        found.append(ck16_jib.section(jib))
    with Fmu(folder / f"{GEAR}.fmu") as gear:
        found.append(design.section(gear, travel))
    return found
