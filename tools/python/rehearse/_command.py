"""The command's verbs, each in a process of its own.

A run must not depend on the process that asks for it: the command pins its arithmetic and guards its controllers. So
these functions start ``rehearse``, and their results are the JSON objects that it prints.
"""

from __future__ import annotations

import html
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Union

from ._errors import Diagnostic, Error, NoSuchFile

PathLike = Union[str, "os.PathLike[str]"]


class Result:
    """An object that the command printed with ``--json``: its members are attributes.

    ``status`` is the exit status of the command: 0 is a success, 1 a difference, 3 a failed controller, 4 undecided.
    """

    def __init__(self, members: Mapping[str, Any], status: int = 0) -> None:
        self.json = dict(members)
        self.status = status

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "json":
            raise AttributeError(name)
        try:
            return _as_attributes(self.json[name])
        except KeyError:
            raise AttributeError(f"the result has no '{name}'; it has {', '.join(self.json)}") from None

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self.json]

    def __getitem__(self, name: str) -> Any:
        return _as_attributes(self.json[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.json)

    def __bool__(self) -> bool:
        """True if the command succeeded."""
        return self.status == 0

    def __repr__(self) -> str:
        said = self.json.get("verdict")
        return f"<Result: {said}>" if said else f"<Result with {', '.join(self.json)}>"


    def _repr_html_(self) -> str:
        """The verdict, the state of each level, the margin of each expectation and a link to the report."""
        said = self.json.get("verdict")
        if not said:
            return html.escape(repr(self))
        parts = [f'<p><b style="color: {"green" if self else "#b00020"}">{html.escape(str(said))}</b></p>']
        levels = self.json.get("levels")
        if isinstance(levels, dict):
            parts.append("<p>" + "; ".join(f"{html.escape(name)}: {html.escape(str(state))}" for name, state in levels.items()) + "</p>")
        for expectation in self.json.get("expectations") or []:
            mark = "&#10003;" if expectation.get("holds") else "&#10007;"
            parts.append(f"<div>{mark} {html.escape(str(expectation.get('text', '')))}</div>")
        if self.json.get("report"):
            address = Path(self.json["report"]).resolve().as_uri()
            parts.append(f'<p><a href="{html.escape(address)}">report</a></p>')
        return "".join(parts)


def _as_attributes(value: Any) -> Any:
    if isinstance(value, dict):
        return Result(value)
    if isinstance(value, list):
        return [_as_attributes(item) for item in value]
    return value


def command() -> str:
    """The path of the command: that of this installation or build, else the first in PATH."""
    inside = Path(__file__).resolve().parents[4] / "bin" / "rehearse"
    found = str(inside) if inside.is_file() else shutil.which("rehearse")
    if not found:
        raise Error.saying("the command rehearse isn't installed", "install the package rehearse")
    return found


def _words(options: Mapping[str, Any]) -> List[str]:
    words: List[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if isinstance(value, bool):
            words += [option] if value else []
        elif isinstance(value, (list, tuple)):
            for item in value:
                words += [option, str(item)]
        elif value is not None:
            words += [option, os.fspath(value) if isinstance(value, os.PathLike) else str(value)]
    return words


def _run(verb: str, *files: PathLike, controllers: Optional[Mapping[str, PathLike]] = None, **options: Any) -> Result:
    """Runs a verb with --json. Raises Error with the command's diagnostics if it printed no result."""
    for file in files:
        # a word without a folder and an ending may be a scenario's name
        is_path = os.path.dirname(os.fspath(file)) or Path(file).suffix in (".yaml", ".mcap", ".urdf", ".jsonl")
        if is_path and not os.path.exists(file):
            raise NoSuchFile.named(os.fspath(file))
    words = [command(), verb, "--json", *_words(options)]
    for name, library in (controllers or {}).items():
        words += ["--controller", f"{name}={os.fspath(library)}"]
    ended = subprocess.run([*words, "--", *map(os.fspath, files)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           text=True, errors="replace", check=False)
    try:
        members: Dict[str, Any] = json.loads(ended.stdout)
    except ValueError:
        said = ended.stderr.strip().removeprefix("error: ")
        raise Error.saying(said or f"rehearse {verb} ended with status {ended.returncode}") from None
    errors = members.get("errors")
    if errors and len(members) <= 2:  # nothing but the form's version beside them
        raise Error(Diagnostic(**error) for error in errors)
    return Result(members, ended.returncode)


def check(scenario: PathLike, *, golden: Optional[PathLike] = None, level: Optional[List[str]] = None,
          simulate: bool = False, controllers: Optional[Mapping[str, PathLike]] = None,
          call_limit: Optional[float] = None, memory_limit: Optional[float] = None) -> Result:
    """Runs a scenario and compares it with its golden, as ``rehearse check``.

    The result has ``verdict`` (a sentence), ``equal``, ``within``, ``levels.controller``, ``.plant`` and ``.closed``,
    ``first`` (the first difference, or None) and ``expectations`` (each with ``text``, ``holds`` and ``margin``). It is
    true if all is within tolerance and all expectations hold. Raises Error if nothing can be compared.

    controllers: another library for a controller, by NAME or BODY/NAME. level: of "controller", "plant", "closed".
    call_limit: of a controller's call [s]. memory_limit: of the process with the controllers [MB].
    """
    return _run("check", scenario, golden=golden, level=level, simulate=simulate, controllers=controllers,
                call_limit=call_limit, memory_limit=memory_limit)


def _yaml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def record(scenario: PathLike, output: Optional[PathLike] = None, *,
           set: Optional[Mapping[str, Union[float, str]]] = None, seed: Optional[int] = None,
           duration: Optional[float] = None, frames: bool = True,
           controllers: Optional[Mapping[str, PathLike]] = None, call_limit: Optional[float] = None,
           memory_limit: Optional[float] = None) -> Result:
    """Runs a scenario in simulation and writes its recording, as ``rehearse record``.

    The result has ``trace`` (the path), ``ticks``, ``duration`` [s], ``expectations`` and ``failure`` (of a controller,
    or None). output: default SCENARIO.mcap in the working directory. frames: False: pictures aren't recorded.

    set: other values in the scenario by their paths, as {"bodies[SR1].links[WAIST].mass": 8.2}, in the unit that the
    scenario has there. Paths are those of ``vary:``; a value that the scenario can't have raises Error with its path.
    """
    values = [f"{path}={_yaml(value)}" for path, value in (set or {}).items()]
    return _run("record", scenario, output=output, seed=seed, duration=duration, no_frames=not frames,
                controllers=controllers, call_limit=call_limit, memory_limit=memory_limit, **{"with": values})


def replay(trace: PathLike, output: Optional[PathLike] = None, *,
           controllers: Optional[Mapping[str, PathLike]] = None, set: Optional[List[str]] = None,
           call_limit: Optional[float] = None, memory_limit: Optional[float] = None) -> Result:
    """Feeds recorded inputs to the controllers, without physics, and compares commands, as ``rehearse replay``.

    set: changes of inputs, as "Walker/KNEE/q+=0.05@3.2s..3.4s". output: the recording with the present commands.
    """
    return _run("replay", trace, output=output, controllers=controllers, set=set, call_limit=call_limit,
                memory_limit=memory_limit)


def diff(expected: PathLike, actual: PathLike, *, tolerances: Optional[PathLike] = None,
         align: Optional[str] = None) -> Result:
    """Compares two recordings or logs, as ``rehearse diff``. The result has ``verdict``, ``first`` and ``channels``."""
    return _run("diff", expected, actual, tolerances=tolerances, align=align)


def sweep(scenario: PathLike, output: Optional[PathLike] = None, *, cases: Optional[int] = None,
          seed: Optional[int] = None, golden: bool = False, jobs: Optional[int] = None,
          controllers: Optional[Mapping[str, PathLike]] = None) -> Result:
    """Runs many variations of a scenario with ``vary:``, as ``rehearse sweep``. output: the folder of the campaign."""
    return _run("sweep", scenario, output=output, cases=cases, seed=seed, golden=golden, jobs=jobs,
                controllers=controllers)


def audit(trace: PathLike, *, realtime: bool = False, valgrind: bool = False,
          controllers: Optional[Mapping[str, PathLike]] = None) -> Result:
    """Finds what a controller depends on beside its inputs, as ``rehearse audit``. trace: a recording, or a scenario."""
    return _run("audit", trace, realtime=realtime, valgrind=valgrind, controllers=controllers)


def history(file: PathLike, *, html: Optional[PathLike] = None) -> Result:
    """Shows how near to their bounds the checks of a history came, as ``rehearse history``. html: a page to write."""
    return _run("history", file, html=html)


def inspect(model: PathLike, *, strict: bool = False) -> Result:
    """Loads a robot model and reports its contents and findings, as ``rehearse inspect``."""
    return _run("inspect", model, strict=strict)


def report(trace: PathLike, golden: Optional[PathLike] = None, output: Optional[PathLike] = None) -> Result:
    """Writes the page of a run, its golden beside it, as ``rehearse report``. output: default TRACE.html here."""
    return _run("report", trace, *([golden] if golden is not None else []), output=output)
