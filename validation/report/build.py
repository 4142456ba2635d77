"""All sections, from the packed FMUs."""

from __future__ import annotations

from pathlib import Path

from . import (
    ck16_bodies,
    ck16_jib,
    ck16_slider_crank,
    design,
    hf08_appendix,
    hf08_elements,
    hf08_extension,
    hf08_friction,
    hf08_fuselage,
    hf08_inverse,
    hf08_loads,
    hf08_motion,
)
from .fmu import Fmu
from .gear import Travel, retract
from .page import Section

GEAR, SLIDER_CRANK, JIB = "LandingGearRetraction", "SliderCrank", "Jib"
EXTENSION, FAMILY = "LandingGearExtension", "FourBarFamily"
"""Names of the FMUs. The last two have the key `by_body`."""


def sections(folder: Path) -> list[Section]:
    """Everything but the drawings; `folder` holds the FMUs."""

    def fmu(name: str) -> Fmu:
        return Fmu(folder / f"{name}.fmu")

    with fmu(GEAR) as gear, fmu(EXTENSION) as extension, fmu(FAMILY) as family:
        travel = Travel.of(gear)
        plain = retract(gear, travel, {})
        found = [
            hf08_loads.section(gear, travel),
            hf08_motion.section(gear, travel),
            hf08_elements.section(gear, travel),
            hf08_appendix.section(gear, extension, travel, plain.duration),
            hf08_friction.section(gear, travel, plain),
            hf08_inverse.section(gear, travel),
            hf08_extension.section(gear, travel),
            hf08_fuselage.section(gear, travel),
        ]
        bodies = ck16_bodies.section(gear, extension, family, travel)
    with fmu(SLIDER_CRANK) as slider_crank:
        found.append(ck16_slider_crank.section(slider_crank))
    with fmu(JIB) as jib:
        found.append(ck16_jib.section(jib))
    found.append(bodies)
    with fmu(GEAR) as gear:
        found.append(design.section(gear, travel))
    return found
