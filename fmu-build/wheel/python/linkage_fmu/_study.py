"""Studies: many runs of a mechanism, and the best design."""

from __future__ import annotations

import csv
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _engine
from ._definition import as_json
from ._errors import InputError, file, require, wrong
from ._mechanism import Mechanism

if TYPE_CHECKING:
    import pandas

#: Form of a study: the path of a study file, or a dict with its keys.
Study = str | os.PathLike[str] | Mapping[str, Any]
#: Called with the number of completed runs and the number of all runs.
Progress = Callable[[int, int], object]


class _Bar:
    """Progress of a study: tqdm if it is installed, else a line of text."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._shown = 0.0
        try:
            self._tqdm: Any = import_module("tqdm.auto").tqdm
        except ImportError:
            self._tqdm = None

    def __call__(self, done: int, all_runs: int) -> None:
        if self._tqdm is None:
            if done == all_runs or time.monotonic() - self._shown > 0.5:
                self._shown = time.monotonic()
                print(f"\r{done} of {all_runs} runs", end="", file=sys.stderr, flush=True)
            return
        if self._bar is None:
            self._bar = self._tqdm(total=all_runs, unit="run")
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._shown:
            print(file=sys.stderr)


def _stated(study: Study, mechanism: Mechanism | None, folder: Path) -> Path:
    """The file of a study. A study that is given as a dict is written into the folder."""
    if isinstance(study, Mapping):
        base, stated = Path.cwd(), dict(study)
    else:
        path = Path(file("study", study))
        if mechanism is None:
            return path
        base = path.resolve().parent
        try:
            stated = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"study = {str(path)!r}: the file cannot be read: {error}") from None
        if not isinstance(stated, dict):
            raise InputError(f"study = {str(path)!r}: the file must contain an object {{ }}")
    if mechanism is not None:
        if not isinstance(mechanism, Mechanism):
            wrong("mechanism", mechanism, "a Mechanism; open it with Mechanism(...)")
        stated["mechanism"] = str(mechanism.save(folder / mechanism._kind))
    elif isinstance(stated.get("mechanism"), Mechanism):
        stated["mechanism"] = str(stated["mechanism"].save(folder / stated["mechanism"]._kind))
    elif isinstance(stated.get("mechanism"), str | os.PathLike):
        stated["mechanism"] = str(base / stated["mechanism"])
    if isinstance(stated.get("points"), str):
        stated["points"] = str(base / stated["points"])
    scenario = stated.get("scenario")
    if isinstance(scenario, Mapping) and isinstance(scenario.get("input_file"), str):
        stated["scenario"] = {**scenario, "input_file": str(base / scenario["input_file"])}
    path = folder / "study.json"
    path.write_text(as_json("study", stated), encoding="utf-8")
    return path


def _made(
    task: Callable[..., str],
    study: Study,
    mechanism: Mechanism | None,
    out: str | os.PathLike[str] | None,
    how: tuple[int | None, bool | Progress],
    read: Callable[[Path, str], Any],
) -> Any:  # noqa: ANN401
    threads, progress = how
    if not (isinstance(progress, bool) or callable(progress)):
        wrong("progress", progress, "True, False or a function")
    # Without pandas, the results of all runs would be lost.
    require("pandas")
    bar = _Bar() if progress is True else None
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        results = folder / "results" if out is None else Path(file("out", out))
        path = _stated(study, mechanism, folder)
        watch = bar if bar is not None else progress if callable(progress) else None
        try:
            log = task(str(path), str(results), threads, watch)
        except InputError as error:
            if path.parent != folder:
                raise
            # The user did not write this file.
            raise type(error)(str(error).replace(str(path), "study")) from None
        finally:
            if bar is not None:
                bar.close()
        return read(results, log)


def _table(path: Path, log: str) -> pandas.DataFrame:
    require("pandas")
    import pandas

    with path.open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    columns = zip(*rows, strict=True) if rows else [()] * len(names)
    # Python reads all digits, so that each number is bit-identical to the computed one.
    frame = pandas.DataFrame({name: _column(cells) for name, cells in zip(names, columns, strict=True)})
    frame.attrs["log"] = log
    return frame


def _column(cells: Sequence[str]) -> list[Any]:
    """Cells as Booleans, integers, numbers or texts: the first type that fits all cells."""
    if all(cell in ("true", "false") for cell in cells):
        return [cell == "true" for cell in cells]
    for kind in (int, float):
        try:
            return [kind(cell or "nan") for cell in cells]
        except ValueError:
            continue
    return list(cells)


def sweep(
    study: Study,
    mechanism: Mechanism | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | Progress = False,
) -> pandas.DataFrame:
    """Simulate all runs of a study. Return a data frame with one row for each run of the study. The row of a failed run
    states the reason for the failure.

    Args:
        study: path of a study file, or a dict with the keys of a study. Paths in a study are relative to the folder of
            the study file or, for a dict, to the current folder.
        mechanism: mechanism that `sweep` simulates instead of the mechanism in the key `mechanism` of the study.
        out: folder into which `sweep` writes the results (files runs.parquet and runs.csv).
        threads: number of threads of `sweep`. By default, one thread runs on each processor core.
        progress: If `progress` is True, `sweep` shows a progress bar. If `progress` is a function, `sweep` calls the
            function with two numbers: finished runs and all runs.

    Raises:
        InputError: the study contains an error. The text of the exception describes the error.
        MechanismError: the definition of the mechanism contains errors.
    """
    frame: pandas.DataFrame = _made(
        _engine.sweep, study, mechanism, out, (threads, progress), lambda folder, log: _table(folder / "runs.csv", log)
    )
    return frame


@dataclass(frozen=True)
class Optimum:
    """The best design of a study."""

    #: Mechanism with the best values of the factors.
    mechanism: Mechanism
    #: Best values of the factors, in SI units.
    factors: dict[str, float]
    #: Responses of the best design.
    responses: dict[str, float]
    #: Responses of the original mechanism.
    present: dict[str, float]
    #: Largest excess of a response of the best design over the limit of the response, divided by the limit. If the
    #: best design satisfies all limits, `violation` is 0.
    violation: float
    #: Reason for the end of the search.
    ended: str
    #: All designs that the search for the best design has simulated, in the order of the simulations.
    evaluations: pandas.DataFrame
    #: Drawing of the original mechanism and of the best design, as SVG text. The attribute `picture` is empty for a
    #: hydraulic model.
    picture: str

    def _repr_svg_(self) -> str | None:
        return self.picture or None


def optimise(
    study: Study,
    mechanism: Mechanism | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | Progress = False,
) -> Optimum:
    """Search for the best design of a study. The search of `optimise` needs the Python package SciPy, which the
    installation with the extra `studies` includes. Without SciPy, `optimise` creates a separate Python environment with
    SciPy.

    The arguments of `optimise` have the same meaning as the arguments of `sweep`.

    Raises:
        InputError: the study contains an error, or the objective has no value in any run.
    """

    def read(folder: Path, log: str) -> Optimum:
        stated: dict[str, Any] = json.loads((folder / "optimum.json").read_text(encoding="utf-8"))
        best = stated["best"]
        kinds = ("mechanism.json", "hydraulics.json", "network.json")
        definition = next(path for path in (folder / kind for kind in kinds) if path.is_file())
        picture = folder / "designs.svg"
        return Optimum(
            mechanism=Mechanism(definition.read_text(encoding="utf-8")),
            factors=best["factors"],
            responses=best["responses"],
            present=stated["present"]["responses"],
            violation=best["violation"],
            ended=stated["ended"],
            evaluations=_table(folder / "evaluations.csv", log),
            picture=picture.read_text(encoding="utf-8") if picture.is_file() else "",
        )

    found: Optimum = _made(_engine.optimise, study, mechanism, out, (threads, progress), read)
    return found
