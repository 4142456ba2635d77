"""The system package of gear and hydraulic actuator: valid by FMPy's schema of SSP 1.0, consistent with the FMUs, and
sufficient to run the pair."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from conftest import FMU_FOLDER, Instance
from fmpy import extract, read_model_description
from fmpy.ssp.ssd import read_ssd
from lxml import etree

SSP = FMU_FOLDER / "LandingGearRetractionWithHydraulics.ssp"
FMUS = {"gear": "LandingGearRetraction.fmu", "hydraulics": "HydraulicActuator.fmu"}
ELEMENT = (
    "reduced_mass",
    "reduced_mass_derivative",
    "holding_force",
    "holding_force_derivative",
    "lower_limit",
    "upper_limit",
)
TOLD = [f"actuator.{name}" for name in ("length", "speed", "acceleration", *ELEMENT)]
"""Outputs of the gear that the hydraulics uses."""
NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}

Connection = tuple[str, str, str, str]


@pytest.fixture(scope="module", autouse=True)
def package() -> Path:
    """The packed system."""
    assert SSP.is_file(), f"{SSP} is missing; run `cargo fmu package --ssp`"
    return SSP


@pytest.fixture(scope="module")
def document() -> etree._Element:
    """The system description."""
    with zipfile.ZipFile(SSP) as archive:
        return etree.fromstring(archive.read("SystemStructure.ssd"))


def connections() -> list[Connection]:
    """The connections as FMPy reads them after its schema check: element and connector at the start and at the end."""
    found = read_ssd(str(SSP), validate=True).system.connections
    return [(c.startElement, c.startConnector, c.endElement, c.endConnector) for c in found]


def test_the_connections_are_those_of_the_pair() -> None:
    motion = [("gear", name, "hydraulics", name) for name in TOLD]
    force = ("hydraulics", "preview.force_mean", "gear", "actuator.force")
    assert sorted(connections()) == sorted([*motion, force])


def test_the_package_contains_the_packed_fmus() -> None:
    system = read_ssd(str(SSP)).system
    assert {element.name: element.source for element in system.elements} == {
        name: f"resources/{file}" for name, file in FMUS.items()
    }
    with zipfile.ZipFile(SSP) as archive:
        for file in FMUS.values():
            assert archive.read(f"resources/{file}") == (FMU_FOLDER / file).read_bytes(), file


def test_connectors_are_those_of_the_fmus(document: etree._Element) -> None:
    units = {unit.get("name") for unit in document.iterfind("ssd:Units/ssc:Unit", NAMESPACES)}
    for component in document.iterfind(".//ssd:Component", NAMESPACES):
        description = read_model_description(str(FMU_FOLDER / FMUS[component.get("name")]))
        variables = {variable.name: variable for variable in description.modelVariables}
        for connector in component.iterfind("ssd:Connectors/ssd:Connector", NAMESPACES):
            variable, kind = variables[connector.get("name")], connector[0]
            assert connector.get("kind") == variable.causality, variable.name
            assert etree.QName(kind).localname == variable.type, variable.name
            assert kind.get("unit") == variable.unit, variable.name
            assert kind.get("unit") is None or kind.get("unit") in units, variable.name


def test_parameter_sets_define_the_units_they_use(document: etree._Element) -> None:
    """SSP 1.0.1, section 6: a unit that a set of values uses is defined in the set."""
    named = 0
    for values in document.iterfind(".//ssv:ParameterSet", NAMESPACES):
        units = {unit.get("name") for unit in values.iterfind("ssv:Units/ssc:Unit", NAMESPACES)}
        used = {kind.get("unit") for kind in values.iterfind("ssv:Parameters/ssv:Parameter/*", NAMESPACES)} - {None}
        assert units == used
        named += len(used)
    assert named > 0


def test_a_host_finds_no_algebraic_loop() -> None:
    """By the dependencies that the FMUs declare, an order exists in which every input is known before an output needs
    it."""
    needs: dict[tuple[str, str], set[tuple[str, str]]] = {}
    for name, file in FMUS.items():
        for unknown in read_model_description(str(FMU_FOLDER / file)).outputs:
            needs[name, unknown.variable.name] = {(name, known.name) for known in unknown.dependencies}
    for source, output, sink, given in connections():
        needs[sink, given] = {(source, output)}
    order = list(TopologicalSorter(needs).static_order())
    assert order.index(("gear", "actuator.holding_force")) < order.index(("gear", "actuator.force"))


@pytest.fixture
def pair(document: etree._Element, tmp_path: Path) -> Iterator[dict[str, Instance]]:
    """Both FMUs of the package, with the values of the package."""
    root = Path(extract(str(SSP), str(tmp_path / "ssp")))
    instances = {}
    for component in document.iterfind(".//ssd:Component", NAMESPACES):
        name = component.get("name")
        instance = Instance(Path(extract(str(root / component.get("source")), str(tmp_path / name))))
        instances[name] = instance
        for parameter in component.iterfind(".//ssv:Parameter", NAMESPACES):
            text = parameter[0].get("value")
            is_real = etree.QName(parameter[0]).localname == "Real"
            instance.set(parameter.get("name"), float(text) if is_real else text == "true")
    yield instances
    for instance in instances.values():
        instance.slave.freeInstance()


def test_a_master_with_only_the_package_retracts_the_gear(pair: dict[str, Instance]) -> None:
    inner = connections()

    def exchange(start: str) -> None:
        for source, output, sink, given in inner:
            if source == start:
                pair[sink].set(given, pair[source].get(output)[0])

    for instance in pair.values():
        instance.slave.setupExperiment(startTime=0.0)
        instance.slave.enterInitializationMode()
    exchange("gear")
    exchange("hydraulics")
    for instance in pair.values():
        instance.slave.exitInitializationMode()
    for i in range(1000):
        exchange("gear")
        exchange("hydraulics")
        for instance in pair.values():
            instance.slave.doStep(i * 1e-3, 1e-3)
    assert pair["gear"].get("crank.angle") == pytest.approx([0.253250298772210], abs=1e-5)
    assert not pair["hydraulics"].messages
