"""Two libraries of a controller side by side, with the same recorded inputs: the first number and line that differ.

The program replays the recording twice, with one library each. The numbers in the controllers' objects are compared
before each control(). The tick that makes the first difference is then executed line by line, with both.
"""

import difflib
import json
import shlex
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import gdb

from . import lines, place, stack, state, travel
from .lines import Line, Walk

AtTick = Callable[[place.Place], bool]

_KEPT = 4  # lines
_BEFORE = 20  # numbers that are listed if they differ before the run


class Request(NamedTuple):
    """`old` and `new`: the arguments of the program for each library."""

    old: List[str]
    new: List[str]
    controller: str  # BODY/NAME
    until: int  # the first tick whose commands differ, or behind the last one
    differs: bool  # `until` is a tick whose commands differ

    @staticmethod
    def read(file: str) -> "Request":
        with open(file, encoding="utf-8") as stream:
            return Request(**json.load(stream))


class _EachTick(gdb.Breakpoint):
    """Calls `at_tick` before each control() of the controller; it stops the program where that returns true."""

    def __init__(self, controller: str, at_tick: AtTick) -> None:
        super().__init__(travel.HOOK, internal=True)
        self.silent = True
        self._controller = controller
        self._at_tick = at_tick
        self.failure: Optional[Exception] = None

    def stop(self) -> bool:
        now = place.here()
        if now is None:
            return False
        place.stop_from(0, 0)
        if now.controller != self._controller:
            return False
        try:
            return bool(self._at_tick(now))
        except Exception as problem:  # gdb would print it and go on
            self.failure = problem
            return True


def _replay(arguments: List[str], controller: str, at_tick: AtTick) -> None:
    _set(arguments)
    each = travel.quietly(lambda: _EachTick(controller, at_tick))
    try:
        gdb.execute("run", to_string=True)
    finally:
        each.delete()
        _end()
    if each.failure is not None:
        raise each.failure


def _set(arguments: List[str]) -> None:
    """The arguments of the next start. Memory that a controller never sets has the same bytes with both libraries."""
    gdb.execute("set args " + shlex.join(arguments) + " >/dev/null 2>&1")
    gdb.execute(f"set environment MALLOC_PERTURB_ {state.FREED}")
    gdb.execute("set environment GLIBC_TUNABLES glibc.malloc.tcache_count=0")  # its memory would keep old bytes


def _end() -> None:
    if place.is_running():
        gdb.execute("kill", to_string=True)


class _States:
    """The numbers of the old controller before each tick, which those of the new one are compared with."""

    def __init__(self, request: Request) -> None:
        self._request = request
        self._old: List[Dict[str, Optional[str]]] = []  # changes before each tick
        self._of_new: Optional[state.State] = None
        self._both: Tuple[Dict[str, str], Dict[str, str]] = ({}, {})
        self.before_run: Dict[str, Tuple[str, str]] = {}
        self.only_old: List[str] = []
        self.only_new: List[str] = []
        self.numbers = 0  # of those that are compared
        self.ticks = 0  # before which they were equal
        self.different: Dict[str, Tuple[str, str]] = {}
        self.is_complete = True

    def find(self) -> Optional[int]:
        """The first tick that makes a difference in the numbers; None: there is none."""
        of_old: Optional[state.State] = None

        def store(now: place.Place) -> bool:
            nonlocal of_old
            of_old = of_old or lines.numbers_of(now)
            self._old.append(of_old.changes())
            self.is_complete = self.is_complete and of_old.layout.is_complete
            return now.tick >= self._request.until

        _replay(self._request.old, self._request.controller, store)
        _replay(self._request.new, self._request.controller, self._compare)
        return self.ticks - 1 if self.different else None

    def _compare(self, now: place.Place) -> bool:
        if now.tick >= len(self._old):
            return True
        self._of_new = self._of_new or lines.numbers_of(now)
        old, new = self._both
        changed = [self._old[now.tick], self._of_new.changes()]
        for texts, changes in zip((old, new), changed):
            _apply(texts, changes)
        names = [name for name in {**changed[0], **changed[1]} if name in old and name in new]
        different = {name: (old[name], new[name]) for name in names if old[name] != new[name]}
        if now.tick == 0:
            self.before_run = different
            self.only_old = [name for name in old if name not in new]
            self.only_new = [name for name in new if name not in old]
            self.numbers = sum(1 for name in new if name in old and not name.startswith("command "))
        else:
            self.different = {name: texts for name, texts in different.items() if name not in self.before_run}
        if not self.different:
            self.ticks += 1
        return bool(self.different) or now.tick >= self._request.until


def _apply(texts: Dict[str, str], changes: Dict[str, Optional[str]]) -> None:
    for name, text in changes.items():
        if text is None:
            texts.pop(name, None)
        else:
            texts[name] = text


def _walk(arguments: List[str], controller: str, tick: int) -> Walk:
    _set(arguments)
    try:
        if not travel.reach(travel.Target(0, tick, controller)):
            raise gdb.GdbError(f"gdb reached no line of {controller} at tick {tick}")
        now = place.here()
        assert now is not None
        return Walk(now)
    finally:
        _end()


class _LineMap:
    """The lines of the new sources that correspond to those of the old ones."""

    def __init__(self, old: Walk, new: Walk) -> None:
        self._new_of: Dict[Tuple[str, int], Tuple[str, int]] = {}
        self._old_functions = {function for _, function in old.statements}
        self._new_functions = {function for _, function in new.statements}
        files_of_new = {function: file for file, function in new.statements}
        texts: Dict[Tuple[str, str], bool] = {}
        for (file, function), statements in old.statements.items():
            other = files_of_new.get(function)
            if other is None:
                continue
            if (file, other) not in texts:
                texts[file, other] = self._add_texts(file, other)
            if not texts[file, other]:
                self._add(file, statements, other, new.statements[other, function])
        executable = [{(file, line) for (file, _), of in walk.statements.items() for line in of} for walk in (old, new)]
        self._new_of = {a: b for a, b in self._new_of.items() if a in executable[0] and b in executable[1]}
        self._has_old = set(self._new_of.values())

    def _add_texts(self, file: str, other: str) -> bool:
        """By the text of both; false if there is only one, which has been changed between the two."""
        if file == other:
            return False
        try:
            texts = [open(name, encoding="utf-8", errors="replace").read().splitlines() for name in (file, other)]
        except OSError:
            return False
        self._add_pairs(file, other, range(1, len(texts[0]) + 1), range(1, len(texts[1]) + 1), texts)
        return True

    def _add(self, file: str, statements: List[int], other: str, others: List[int]) -> None:
        """By the distances between the lines with statements of a function."""
        if len(statements) == len(others):
            self._new_of.update(((file, line), (other, beside)) for line, beside in zip(statements, others))
            return
        distances = [[str(line - before) for before, line in zip([of[0]] + of, of)] for of in (statements, others)]
        self._add_pairs(file, other, statements, others, distances, are_distances=True)

    def _add_pairs(
        self, file: str, other: str, lines_of: Any, others: Any, texts: List[List[str]], are_distances: bool = False
    ) -> None:
        """A line that is added divides a distance in two, of which the second is that of the line behind it."""
        for kind, a, b, c, d in difflib.SequenceMatcher(None, texts[0], texts[1], autojunk=False).get_opcodes():
            if kind in ("equal", "replace"):
                count = min(b - a, d - c)
                first, beside = (b - count, d - count) if are_distances else (a, c)
                for i in range(count):
                    self._new_of[file, lines_of[first + i]] = (other, others[beside + i])

    def are_same(self, old: Line, new: Line) -> bool:
        return old.function == new.function and self._new_of.get(old.place) == new.place

    def is_only_old(self, old: Line) -> bool:
        return old.function not in self._new_functions or old.place not in self._new_of

    def is_only_new(self, new: Line) -> bool:
        return new.function not in self._old_functions or new.place not in self._has_old


class _Difference(NamedTuple):
    """`old` and `new`: the indices of the lines at which the difference is seen; the lines before them made it."""

    old: int
    new: int
    values: Dict[str, Tuple[str, str]]  # empty: the controllers go different ways from here


def _first_difference(old: Walk, new: Walk, known: Dict[str, Any]) -> Optional[_Difference]:
    mapped = _LineMap(old, new)
    numbers = (dict(old.first), dict(new.first))
    done, i, j, are_paired = [0, 0], 0, 0, True
    behind = (0, 0)  # the lines behind the last ones that are the same

    def differing(i: int, j: int, of_lines: bool) -> Dict[str, Tuple[str, str]]:
        """Among the numbers that changed since the last comparison, and the variables."""
        names: Dict[str, None] = {}
        for side, (walk, until) in enumerate(((old, i), (new, j))):
            for step in walk.lines[done[side] : until + 1]:
                _apply(numbers[side], step.changed)
                names.update(dict.fromkeys(step.changed))
            if until >= len(walk.lines):
                _apply(numbers[side], walk.last)
                names.update(dict.fromkeys(walk.last))
            done[side] = until + 1
        found = {}
        if of_lines:
            found = _different_variables(old, i, new, j)
        for name in names:
            pair = numbers[0].get(name), numbers[1].get(name)
            if name not in known and None not in pair and pair[0] != pair[1]:
                found[name] = pair
        return found

    while i < len(old.lines) and j < len(new.lines):
        if mapped.are_same(old.lines[i], new.lines[j]):
            found = differing(i, j, True)
            if found and _calls_more(old, behind[0], i) != _calls_more(new, behind[1], j):
                return _Difference(*behind, {})
            results = old.lines[i].result, new.lines[j].result  # of the functions in the lines before
            if "" not in results and results[0] != results[1] and _returned_to(old, i) == _returned_to(new, j):
                return _Difference(_behind_return(old, i), _behind_return(new, j), {"its result": results})
            if found:
                return _Difference(i, j, found)
            i, j, are_paired = i + 1, j + 1, True
            behind = (i, j)
            continue
        are_together, are_paired = are_paired, False
        if old.lines[i].is_begun or mapped.is_only_old(old.lines[i]):
            i += 1
        elif new.lines[j].is_begun or mapped.is_only_new(new.lines[j]):
            j += 1
        else:
            return _Difference(i, j, differing(i, j, False) if are_together else {})
    rest = [step for step in old.lines[i:] if not step.is_begun and not mapped.is_only_old(step)]
    rest += [step for step in new.lines[j:] if not step.is_begun and not mapped.is_only_new(step)]
    if rest:
        return _Difference(i, j, differing(i, j, False) if are_paired else {})
    found = differing(len(old.lines), len(new.lines), False)
    return _Difference(len(old.lines), len(new.lines), found) if found else None


def _calls_more(walk: Walk, begin: int, end: int) -> bool:
    """True if a function, which the line before `begin` calls, has lines up to `end`."""
    caller = walk.lines[end].call
    return any(step.call > caller for step in walk.lines[begin:end])


def _returned_to(walk: Walk, index: int) -> str:
    """The function that has returned to that line."""
    return walk.lines[index - 1].function


def _behind_return(walk: Walk, index: int) -> int:
    """Behind the last line of the function that has returned to that line, but for its closing brace."""
    call = walk.lines[index - 1].call
    before = index - 1
    while before > 0 and walk.lines[before - 1].call > call:
        before -= 1
    is_brace = before > 0 and walk.lines[before - 1].call == call
    return before if is_brace else index


def _different_variables(old: Walk, i: int, new: Walk, j: int) -> Dict[str, Tuple[str, str]]:
    """A variable that isn't known to be set counts if it keeps its number in the next lines of its function: it was set
    to the number that its memory had before."""
    first, second = old.lines[i], new.lines[j]
    return {
        name: (text, second.locals[name])
        for name, text in first.locals.items()
        if second.locals.get(name, text) != text
        and (name in first.is_set or _keeps(old, i, name))
        and (name in second.is_set or _keeps(new, j, name))
        and (name in first.is_set or name in second.is_set)
    }


def _keeps(walk: Walk, index: int, name: str) -> bool:
    step = walk.lines[index]
    later = [line for line in walk.lines[index + 1 : index + 100] if line.call == step.call][:_KEPT]
    return len(later) == _KEPT and all(line.locals.get(name) == step.locals[name] for line in later)


def _first_different_write(old: Walk, new: Walk, known: Dict[str, Any]) -> Optional[_Difference]:
    """Of optimised code, whose lines have another order than the source, and whose variables may be anywhere: the first
    member or command that differs where control() ends, by the lines that wrote it last."""
    ends = [walk.last_texts() for walk in (old, new)]
    different = {
        name: (text, ends[1][name])
        for name, text in ends[0].items()
        if name not in known and ends[1].get(name, text) != text
    }
    if not different:
        return None
    writes = [walk.last_writes() for walk in (old, new)]
    first = min(different, key=lambda name: writes[1].get(name, len(new.lines)))
    values = {first: different[first], **different}
    return _Difference(writes[0].get(first, 0), writes[1].get(first, 0), values)


def _described(walk: Walk, index: int) -> Optional[Dict[str, Any]]:
    if not 0 <= index < len(walk.lines):
        return None
    step = walk.lines[index]
    return stack.described(step.function, step.file, step.line)


def _pairs(of: Dict[str, Tuple[str, str]]) -> List[Dict[str, str]]:
    return [{"name": name, "old": old, "new": new} for name, (old, new) in list(of.items())[:_BEFORE]]


def compare(request: Request) -> Dict[str, Any]:
    """The result for harness and user, as a JSON object."""
    states = _States(request)
    tick = states.find()
    result: Dict[str, Any] = {
        "before": _pairs(states.before_run),
        "only_old": states.only_old[:_BEFORE],
        "only_new": states.only_new[:_BEFORE],
        "numbers": states.numbers,
        "ticks": states.ticks,
        "is_complete": states.is_complete,
    }
    if tick is None and request.differs:
        tick = request.until
    if tick is None:
        return result
    old, new = (_walk(words, request.controller, tick) for words in (request.old, request.new))
    is_optimised = old.is_optimised or new.is_optimised
    find = _first_different_write if is_optimised else _first_difference
    found = find(old, new, states.before_run)
    result["tick"] = tick
    result["lines"] = len(new.lines)
    result["is_optimised"] = is_optimised
    result["after"] = _pairs(states.different)
    if found is not None:
        result["values"] = _pairs(found.values)
        result["old"], result["new"] = _described(old, found.old - 1), _described(new, found.new - 1)
        result["old_next"], result["new_next"] = _described(old, found.old), _described(new, found.new)
    elif not (old.is_complete and new.is_complete):
        result["too_long"] = lines.MOST_LINES
    return result
