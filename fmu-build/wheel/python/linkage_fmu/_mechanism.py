"""Mechanisms and their functions."""

from __future__ import annotations

import html
import json
import os
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _FOLDER, _engine
from ._definition import Source, is_text, read
from ._errors import InputError, LinkageWarning, MechanismError, SimulationError, file, wrong
from ._report import Fact, Report, report

if TYPE_CHECKING:
    from ._kinematics import Kinematics
    from ._linear import LinearModel
    from ._page import Page
    from ._result import Columns, Result

#: A start value: a number in SI units, a truth value, a text with a unit such as "45 deg", or the name of an item.
StartValue = float | bool | str


@dataclass(frozen=True)
class Variable:
    """A variable of a mechanism."""

    #: Name of the variable, such as `crank.angle`.
    name: str
    #: Type of the variable: `Real`, `Boolean` or `Enumeration`.
    kind: str
    #: Causality of the variable: `input`, `output`, `parameter`, `calculatedParameter`, `local` or `independent`.
    causality: str
    #: Variability of the variable: `fixed`, `tunable`, `discrete` or `continuous`. The variability states when the
    #: value of the variable can change.
    variability: str
    #: Unit of the variable. The unit of the variable is `1` for a number without a unit, and empty for a Boolean or an
    #: Enumeration.
    unit: str
    #: Start value of an input or a parameter.
    start: StartValue | None
    #: Names of the items, if the variable is an Enumeration.
    items: tuple[str, ...]
    #: Description in one line of text.
    description: str


def examples() -> list[str]:
    """Return the names of the example mechanisms in the package."""
    folder = Path(_FOLDER or ".") / "modelDescription"
    return sorted(entry.name for entry in folder.iterdir() if (entry / "resources").is_dir())


def example(name: str) -> Mechanism:
    """Open an example mechanism of the package, such as `LandingGearRetraction` or `FourBar`.

    Raises:
        InputError: the package has no example with the given name. The text of the exception lists the names of all
            example mechanisms.
    """
    if not isinstance(name, str):
        wrong("name", name, "the name of an example")
    if name not in examples():
        raise InputError(f"there is no example {name!r}; the examples are {', '.join(examples())}")
    return Mechanism(Path(_FOLDER or ".") / "modelDescription" / name)


class Mechanism:
    """A planar mechanism with one degree of freedom, or a hydraulic model. A definition (JSON) describes the mechanism
    or hydraulic model.

    Args:
        source: definition of the mechanism: path of a definition file, of a folder with a definition file, or of an
            FMU. The definition can also be a dict or a JSON text.

    Raises:
        MechanismError: the definition contains errors. The attribute `report` of the exception contains all findings.
        InputError: no definition exists at the path in `source`.
    """

    def __init__(self, source: Source) -> None:
        self._kind, self._shown, self._text = read(source)
        self._path = None if is_text(source) else Path(file("source", source))
        try:
            self._model = _engine.Model(self._kind, self._text)
        except InputError:
            raise MechanismError(report(self._kind, self._text, self._shown)) from None
        about = self._model.about()
        #: Name of the model.
        self.name: str = about[0]
        #: Description in one line of text.
        self.description: str = about[1]
        #: Stop time of the default experiment [s].
        self.stop_time: float = about[2]
        #: Communication step of the default experiment [s].
        self.step_size: float = about[3]
        #: List of warnings about the definition.
        self.warnings: list[str] = about[4]
        self._columns: dict[Any, Columns] = {}

    @property
    def variables(self) -> list[Variable]:
        """List of all variables: inputs, outputs and parameters."""
        return [Variable(**{**own, "items": tuple(own["items"])}) for own in self._model.variables()]

    def check(self) -> Report:
        """Check the definition of the mechanism. The returned report contains findings (errors and warnings) and
        computed facts about the mechanism, such as travel, dead centres, strokes and equilibria. The function `print`
        shows the report in the same form as the command `linkage-fmu check`."""
        return report(self._kind, self._text, self._shown)

    def equilibria(self) -> list[Fact]:
        """Return all stable and unstable static equilibria along the travel as a list of `Fact` objects. The loads in
        the equilibria are the loads at the start of a simulation.

        In each `Fact` object, the quantity `stable position` or `unstable position` is the value of the coordinate at
        the equilibrium [rad or m]. The attribute `of` of the `Fact` object is the name of the coordinate.
        """
        return self.check().about("Equilibria")

    def to_json(self) -> str:
        """Return the definition of the mechanism as the original JSON text."""
        return self._text

    def to_dict(self) -> dict[str, Any]:
        """Return the definition of the mechanism as a dict."""
        found: dict[str, Any] = json.loads(self._text)
        return found

    def simulate(
        self,
        start_time: float = 0.0,
        stop_time: float | None = None,
        output_interval: float | None = None,
        relative_tolerance: float | None = None,
        start_values: Mapping[str, StartValue] | None = None,
        input: Any = None,  # noqa: ANN401
        output: Iterable[str] | None = None,
        set_input_derivatives: bool = False,
    ) -> Result:
        """Simulate the mechanism from its start position. The arguments of `simulate` have the same names and meaning
        as the arguments of `fmpy.simulate_fmu`.

        Args:
            start_time: time at the start of the simulation [s].
            stop_time: time at the end of the simulation [s]. By default, the simulation ends at the stop time of the
                default experiment.
            output_interval: time between two rows of the result [s]. The default of `output_interval` is the step size
                of the default experiment. If the result would have more than 1001 rows, `simulate` doubles the default
                step size until the result has at most 1001 rows.
            relative_tolerance: relative tolerance of the integration. By default, `simulate` uses the tolerance of the
                definition.
            start_values: start values of inputs and parameters, by name. A start value is a number in SI units, a text
                with a unit such as "45 deg", a truth value, or an enumeration item.
            input: inputs over time: a structured array with the field `time`, a dict of columns, or a data frame with
                the column or the index `time`. If two rows of `input` have the same time, the inputs jump at
                the common time of the rows.
            output: names of the variables to record. By default, `simulate` records all outputs.
            set_input_derivatives: if True, the simulation also sets the time derivatives of the inputs in `input`.

        Returns:
            A structured numpy array with the field `time` and one field for each variable. Ctrl-C stops a running
            simulation.

        Raises:
            InputError: a name, value, unit or array shape in the arguments is wrong, or the result needs more than 2 GB
                of memory.
            SimulationError: the simulation stops before the stop time. The attribute `result` of the exception contains
                the rows of the result before the stop.
        """
        columns = self._recorded(output)
        given = None
        if input is not None:
            from ._result import signals

            given = signals(input)
        rows, lines, error, _ = self._model.run(
            columns.plan,
            start_time,
            stop_time,
            output_interval,
            relative_tolerance,
            start_values,
            given,
            set_input_derivatives,
        )
        result = columns.result(rows, (self, dict(start_values) if start_values else {}, input is not None))
        for line in lines:
            warnings.warn(line, LinkageWarning, stacklevel=2)
        if error is not None:
            failure = SimulationError(error)
            failure.result = result
            raise failure
        return result

    def simulate_many(
        self,
        start_values: Mapping[str, Any],
        stop_time: float | None = None,
        output: Iterable[str] | None = None,
        threads: int | None = None,
    ) -> Result:
        """Simulate the mechanism once for each set of start values, on several processor cores. Return the values of
        the outputs at the stop time of each simulation.

        Args:
            start_values: start values of inputs and parameters, by name. An array or a list contains one number in SI
                units for each run. Any other start value has the same form as in `simulate` and applies to all runs.
            stop_time: time at the end of each run [s]. With the stop time 0, the result contains the outputs at the
                start position. By default, each run ends at the stop time of the default experiment.
            output: names of the variables in the result. By default, the result contains all outputs.
            threads: number of runs at the same time. The default is the number of processor cores.

        Returns:
            A structured numpy array with one row for each run. The fields of the array are the outputs, and the start
            values that differ between the runs. The outputs of a run do not depend on the other runs, and agree with
            the result of `simulate` within the tolerance. If a run fails, all outputs of the run are NaN. If only one
            output of a run has no value, only the output without a value is NaN. A warning of the class
            `LinkageWarning` states the number of runs with NaN, and the reason for the first NaN.

        Raises:
            InputError: a name, value, unit or array shape in the arguments is wrong, or the result needs more than 2 GB
                of memory.
        """
        from ._many import simulate_many

        return simulate_many(self, start_values, stop_time, output, threads)

    def _recorded(self, output: Iterable[str] | None) -> Columns:
        """The columns of a run. The columns of a list that was given before are known."""
        from ._result import Columns

        key = tuple(output) if isinstance(output, list) else output
        try:
            return self._columns[key]
        except (KeyError, TypeError):
            columns = Columns(self._model.plan(output))
        if key is None or isinstance(key, tuple):
            self._columns[key] = columns
        return columns

    def simulation(self, start_values: Mapping[str, StartValue] | None = None) -> _engine.Simulation:
        """Return a simulation with the given start values. Your program advances the returned simulation step by step.
        Call the method `initialize` of the simulation before the first step.

        Raises:
            InputError: a name, value or unit in the start values is wrong.
        """
        return self._model.simulation(start_values)

    def kinematics(
        self,
        count: int = 100,
        outputs: Iterable[str] | None = None,
        start_values: Mapping[str, StartValue] | None = None,
    ) -> Kinematics:
        """Compute positions, influence coefficients and static quantities along the travel of the mechanism, without a
        simulation over time.

        For a mechanism without masses, the result of `kinematics` contains only positions and influence coefficients. A
        prescribed motion has no effect on the result of `kinematics`.

        Args:
            count: number of equal parts into which `kinematics` divides the travel. The result of `kinematics` has
                `count` + 1 positions.
            outputs: names of the outputs in the result. By default, the result of `kinematics` contains all
                coordinates, lengths, markers, reduced masses and holding forces.
            start_values: start values of inputs and parameters, in the same form as for `simulate`.

        Raises:
            InputError: a name in the argument `outputs` is not the name of an output.
            SimulationError: the travel of the mechanism cannot be computed, for example because of a hydraulic circuit.
        """
        from ._kinematics import kinematics

        return kinematics(self, count, outputs, start_values)

    def linearise(
        self,
        coordinate: str | None = None,
        inputs: Sequence[str] = (),
        outputs: Sequence[str] = (),
        held_by: str | None = None,
        start_values: Mapping[str, StartValue] | None = None,
    ) -> LinearModel:
        """Linearise the equations of motion at the start position, with the mechanism at rest: x' = A x + B u, y = C x
        + D u. The state x consists of one coordinate of the mechanism and the time derivative of the coordinate.

        Args:
            coordinate: name of the coordinate in the state x: an angle [rad] or a position [m]. By default, the state
                contains the coordinate in the key `start` of the definition.
            inputs: names of the inputs u of the linear model. By default, u contains all inputs on which the
                acceleration depends.
            outputs: names of the outputs y of the linear model. By default, y contains only the coordinate of the state
                x.
            held_by: name of the input that keeps the mechanism at rest: the force [N] or torque [N.m] of an actuator.
            start_values: start values of inputs and parameters, in the same form as for `simulate`.

        Raises:
            InputError: a name in the arguments is not the name of a variable.
            SimulationError: the mechanism cannot be linearised, because the mechanism has additional states, such as
                the pressures of a hydraulic circuit.
        """
        from ._linear import linearise

        return linearise(self, (coordinate, inputs, outputs, held_by), None, start_values)[0]

    def linearise_travel(
        self,
        count: int = 100,
        coordinate: str | None = None,
        inputs: Sequence[str] = (),
        outputs: Sequence[str] = (),
        held_by: str | None = None,
        start_values: Mapping[str, StartValue] | None = None,
    ) -> list[LinearModel]:
        """Linearise the equations of motion at `count` + 1 positions of the travel (at most 100001), with the mechanism
        at rest. All arguments except `count` have the same meaning as the arguments of `linearise`. Ctrl-C takes effect
        when the call of `linearise_travel` returns.
        """
        from ._linear import linearise

        return linearise(self, (coordinate, inputs, outputs, held_by), count, start_values)

    def view(
        self,
        stop_time: float | None = None,
        start_values: Mapping[str, StartValue] | None = None,
        height: int = 640,
    ) -> Page:
        """Return a web page that shows the mechanism in motion. A notebook displays the web page in the output of a
        cell. The method `Page.save` writes the web page to a file.

        Raises:
            InputError: a start value is wrong, or the model is a hydraulic model without a mechanism.
        """
        from ._page import Page

        if self._kind != "mechanism.json":
            raise InputError(f"{self.name} has no mechanism that can be drawn")
        return Page(self._model.page(self._shown, stop_time, start_values), height)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the definition of the mechanism to a file, and return the path of the file.

        Raises:
            OSError: the file cannot be written.
        """
        path = Path(file("path", path))
        path.write_text(self._text, encoding="utf-8")
        return path

    def package(
        self,
        path: str | os.PathLike[str] = ".",
        fmi: str | int = "both",
        platforms: Sequence[str] = (),
        animation: bool = True,
        results: bool = True,
    ) -> list[Path]:
        """Build FMUs of the mechanism, and write the FMUs into the folder `path`. The method returns a list of the
        paths of the FMUs. The first path in the list is the FMU of FMI 2.0.

        Args:
            path: folder for the FMUs. If the folder does not exist, `package` creates the folder.
            fmi: FMI version of the FMUs that `package` builds: 2, 3 or "both".
            platforms: platforms on which the FMU can run, such as "x86_64-windows". By default, the FMU runs on the
                platform of the present computer.
            animation: if True, the FMU contains an animation of the default experiment.
            results: if True, the FMU contains reference results of the default experiment.

        Raises:
            InputError: the Python package contains no compiled library for one of the platforms, or the folder `path`
                cannot be written.
        """
        if self._path is not None:
            return self._packed(self._path, (path, fmi, platforms, animation, results))
        with tempfile.TemporaryDirectory() as folder:
            source = self.save(Path(folder) / self._kind)
            return self._packed(source, (path, fmi, platforms, animation, results))

    @staticmethod
    def _packed(source: Path, how: tuple[Any, Any, Sequence[str], bool, bool]) -> list[Path]:
        path, fmi, platforms, animation, results = how
        if isinstance(platforms, str):
            platforms = [platforms]
        out = file("path", path)
        paths, _ = _engine.package(str(source), out, str(fmi), platforms, animation, results)
        return [Path(made) for made in paths]

    def __repr__(self) -> str:
        return f"<Mechanism {self.name}: {self.description}>" if self.description else f"<Mechanism {self.name}>"

    def _repr_html_(self) -> str:
        from ._html import Html, number, table

        kinds = [own.causality for own in self.variables]
        counts = [f"{kinds.count(kind)} {kind}s" for kind in ("input", "output", "parameter")]
        rows = [
            ("variables", ", ".join(counts)),
            ("experiment", f"{number(self.stop_time)} s in steps of {number(self.step_size)} s"),
            *(("warning", line) for line in self.warnings),
        ]
        try:
            # The drawing has the colours of a light page.
            picture = f"<div style='background:#fff;display:inline-block'>{self._model.picture()}</div>"
        except SimulationError as error:
            picture, rows = "", [*rows, ("drawing", str(error))]
        title = f"<b>{html.escape(self.name)}</b> {html.escape(self.description)}"
        return picture + table(Html(title), rows)

    def __getstate__(self) -> dict[str, Any]:
        return {"text": self._text, "path": self._path, "shown": self._shown}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["text"])  # type: ignore[misc]
        self._path, self._shown = state["path"], state["shown"]
