"""Tests of controllers with pytest: the goldens, the reports and REHEARSE_GOLDEN of tests with GoogleTest.

    from rehearse.testing import assert_matches_golden, assert_replays

    def test_comes_back_after_a_push(golden):            # golden/Hold.ComesBackAfterAPush.mcap, in test_hold.py
        trace = golden.record("scenarios/hold.yaml")
        assert trace["Arm/SHOULDER/q"].min() < -0.83     # [rad]
        golden.assert_holds(trace)                       # what the scenario expects of every run
        assert_matches_golden(trace)

    def test_repeats_its_commands():
        assert_replays("Hold.ComesBackAfterAPush")

pytest loads it by itself where the package is installed; else by ``pytest_plugins = ["rehearse.testing"]`` in the
conftest.py of the project's folder. Scenarios are named relative to that folder, goldens are in ``golden``. Recordings,
reports and runs that differ are in ``rehearse-pending``, where the command looks for them; in ``build`` if CMake has made
it. The options rehearse_fixtures, rehearse_golden and rehearse_output of pytest.ini name others.

The golden of a test has the name that GoogleTest would give it: test_hold.py::test_comes_back is Hold.ComesBack.
``@pytest.mark.golden("Hold.Other")`` gives it another.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import pytest

from ._command import PathLike, command
from ._errors import Error

if TYPE_CHECKING:
    from ._trace import Trace

Tolerance = Union[float, Tuple[float, float]]


class _Judge:
    """The process that records and compares; it begins with the first question."""

    def __init__(self, folders: Mapping[str, Path], pending: Optional[Path]) -> None:
        self._environment = {**({"REHEARSE_PENDING": str(pending)} if pending else {}), **os.environ}
        self._folders = {name: str(folder) for name, folder in folders.items()}
        self._process: Optional[subprocess.Popen] = None

    def _begin(self) -> None:
        to_read, self._to = os.pipe()
        self._from, to_write = os.pipe()
        program = Path(command()).resolve().parents[1] / "libexec/rehearse/rehearse-judge"
        try:
            self._process = subprocess.Popen([str(program), str(to_read), str(to_write)], pass_fds=(to_read, to_write),
                                             env=self._environment)
        except OSError as failed:
            raise Error.saying(f"{program} can't be started: {failed.strerror}") from None
        finally:
            os.close(to_read)
            os.close(to_write)
        self._answers = os.fdopen(self._from, "r", encoding="utf-8")
        self.ask("folders", **self._folders)

    def ask(self, verb: str, **question: Any) -> Dict[str, Any]:
        if self._process is None:
            self._begin()
        try:
            os.write(self._to, (json.dumps({"verb": verb, **question}) + "\n").encode())
            line = self._answers.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            status = self.end()
            raise Error.saying(f"the process with the controllers ended with status {status}; its output says why")
        answer = json.loads(line)
        if "error" in answer:
            raise Error.saying(answer["error"].removeprefix("error: ").strip())
        return answer

    def end(self) -> int:
        if self._process is None:
            return 0
        process, self._process = self._process, None
        os.close(self._to)
        status = process.wait()
        self._answers.close()
        return status


_judge: Optional[_Judge] = None
_item: Optional[pytest.Item] = None


def _camel(text: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in text.split("_"))


def name_of(item: pytest.Item) -> str:
    """Suite.Test of a test, as GoogleTest would name it."""
    mark = item.get_closest_marker("golden")
    if mark and mark.args:
        return str(mark.args[0])
    cls = getattr(item, "cls", None)
    suite = cls.__name__.removeprefix("Test") if cls else _camel(Path(str(item.path)).stem.removeprefix("test_"))
    function, _, parameters = item.name.partition("[")
    test = _camel(function.removeprefix("test_"))
    if parameters:
        test += "-" + re.sub(r"[^A-Za-z0-9_]+", "-", parameters.rstrip("]")).strip("-")
    return f"{suite}.{test}"


def _asked(verb: str, **question: Any) -> Dict[str, Any]:
    if _judge is None or _item is None:
        raise Error.saying("no test of pytest runs", 'write pytest_plugins = ["rehearse.testing"] in conftest.py')
    return _judge.ask(verb, test=name_of(_item), **question)


def _passes(answer: Mapping[str, Any]) -> None:
    __tracebackhide__ = True
    if not answer["passed"]:
        pytest.fail(answer["message"], pytrace=False)


def record(scenario: PathLike) -> Trace:
    """Runs a scenario in simulation, and returns its recording: traces/Suite.Test.mcap in the output folder.

    If the run is proved to be the golden of this test, only its controllers run, and the recording is a copy of it.
    Raises Error if the run can't begin, or if a controller refuses, raises, crashes or hangs in it.
    """
    from ._trace import Trace  # not before: pytest imports this module wherever it is installed

    return Trace(_asked("record", scenario=os.fspath(scenario))["trace"])


def assert_matches_golden(trace: Trace, *, exact: bool = False, near: Mapping[str, Tolerance] = {},
                          until: Optional[float] = None, levels: Tuple[str, ...] = ("closed",)) -> None:
    """Fails unless the recording agrees with the golden of this test, and meets the scenario's expectations.

    exact: all bits are equal. near: for a pattern of series the allowed difference, in its unit, or (absolute, share of
    the largest magnitude). until: compared up to this time [s]. levels: of "controller", "plant" and "closed".
    REHEARSE_GOLDEN=new and =accept write the golden.
    """
    __tracebackhide__ = True
    rules: List[List[Any]] = [[pattern, *(allowed if isinstance(allowed, tuple) else (allowed, 0.0))]
                              for pattern, allowed in near.items()]
    _passes(_asked("golden", trace=trace.file, exact=exact, near=rules, until=until, levels=list(levels),
                   source=str(_item.path) if _item else ""))


def assert_holds(trace: Trace) -> None:
    """Fails unless the expectations of the recording's scenario are met. Needs no golden."""
    __tracebackhide__ = True
    _passes(_asked("holds", trace=trace.file))


def assert_replays(name: str) -> None:
    """Fails unless the controllers give the same commands for the inputs in golden/NAME.mcap, without physics."""
    __tracebackhide__ = True
    _passes(_asked("replays", name=name))


class Golden:
    """The golden of a test: the fixture ``golden``."""

    def __init__(self, name: str) -> None:
        self.name = name

    record = staticmethod(record)
    assert_matches = staticmethod(assert_matches_golden)
    assert_holds = staticmethod(assert_holds)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Golden:
    """Records scenarios for this test, and compares them with its golden."""
    return Golden(name_of(request.node))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addini("rehearse_fixtures", "the folder of scenarios and models", default=".")
    parser.addini("rehearse_golden", "the folder of goldens", default="golden")
    parser.addini("rehearse_output", "the folder of recordings, reports and runs that differ", default="")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "golden(name): the name of the golden of a test, Suite.Test")


def pytest_sessionstart(session: pytest.Session) -> None:
    global _judge
    root = session.config.rootpath
    is_built = (root / "build/CMakeCache.txt").is_file()  # the rule of the command
    folders = {name: root / session.config.getini(f"rehearse_{name}") for name in ("fixtures", "golden")}
    output = session.config.getini("rehearse_output") or ("build" if is_built else "rehearse-pending")
    folders["output"] = root / output
    _judge = _Judge({**folders, "controllers": folders["output"] / "lib/rehearse/controllers"},
                    pending=None if is_built else folders["output"])


def pytest_sessionfinish() -> None:
    global _judge
    if _judge:
        _judge.end()
    _judge = None


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    global _item
    _item = item
    yield
    _item = None
