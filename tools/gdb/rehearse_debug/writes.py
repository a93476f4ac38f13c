"""Runs on, within one call of a controller, to the lines that change one of its commands, or any other number."""

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import gdb

from . import lines, place, stack, tables

_TYPES = {1: "char", 2: "short", 4: "int", 8: "long"}  # by their size in bytes


class _Write(gdb.Breakpoint):
    """A watchpoint on a number. With `stops` false it only stores the frames of the last change."""

    def __init__(self, number: gdb.Value, stops: bool) -> None:
        watched = f"*({_TYPES[number.type.sizeof]}*){int(number.address):#x}"
        super().__init__(watched, gdb.BP_WATCHPOINT, gdb.WP_WRITE, internal=True)
        self.silent = True
        self.stops = stops
        self.last: List[Dict[str, Any]] = []

    def stop(self) -> bool:
        self.last = stack.frames(has_written=True)
        return self.stops


class _Trial(gdb.Breakpoint):
    """A watchpoint that stores that it was met."""

    def __init__(self) -> None:
        super().__init__("*(long*)&rehearse_watch_trial", gdb.BP_WATCHPOINT, gdb.WP_WRITE, internal=True)
        self.silent = True
        self.met = False

    def stop(self) -> bool:
        self.met = True
        return False


_reported: Optional[bool] = None


def _are_reported() -> bool:
    """False on a virtual machine that accepts watchpoints of the processor and never reports them."""
    global _reported
    if _reported is not None:
        return _reported
    trial = _Trial()
    try:
        gdb.execute("call (void)rehearse_try_watch()", to_string=True)
    except gdb.error:
        trial.met = True  # a version of Rehearse without the function: nothing is known
    _reported = trial.met
    trial.delete()
    return _reported


class _Run(NamedTuple):
    frames: List[Dict[str, Any]]  # of the change at which it stopped, or of the last one in the call; empty: none
    returned: bool  # it stopped where the call returned


def _number(now: place.Place, element: str) -> gdb.Value:
    """A command as JOINT/QUANTITY, or the number that an expression of C++ names here."""
    try:
        return tables.command(now, element)
    except gdb.GdbError:
        try:
            value = gdb.parse_and_eval(element)
        except gdb.error as problem:
            raise gdb.GdbError(
                f"'{element}' is no command of a joint (JOINT/u, /q or /dq; see rehearse-commands), and no expression: "
                f"{problem}"
            ) from problem
    value = value.referenced_value() if value.type.code == gdb.TYPE_CODE_REF else value
    if value.address is None or value.type.sizeof not in _TYPES:
        raise gdb.GdbError(f"'{element}' is no number in memory; name a member of it")
    return value


def _run_on(now: place.Place, element: str, stops: bool) -> _Run:
    number = _number(now, element)
    if not stack.frames():
        stack.enter_functions()
    host = stack.host_frame()
    if host is None or not stack.frames():
        raise gdb.GdbError("gdb isn't in code of a controller here; rehearse-next-tick goes to the next control()")
    if not _are_reported():
        return _by_lines(number, stops)
    end = gdb.Breakpoint(f"*{host.pc():#x}", internal=True)
    end.silent = True
    write = _Write(number, stops)
    try:
        gdb.execute("continue")
        return _Run(write.last, place.is_running() and gdb.newest_frame().pc() == host.pc())
    finally:
        write.delete()
        end.delete()


def _by_lines(number: gdb.Value, stops: bool) -> _Run:
    """Without watchpoints: the frames of the line after which the number is another."""
    memory, address, size = gdb.selected_inferior(), int(number.address), number.type.sizeof
    held, executed, found = bytes(memory.read_memory(address, size)), stack.frames(), []
    steps = lines.Steps()
    for _ in steps.frames():
        now = bytes(memory.read_memory(address, size))
        if now != held:
            held, found = now, executed
            if stops:
                return _Run(found, False)
        executed = stack.frames()
    if steps.hit is not None:
        temporary = "Temporary breakpoint" if steps.hit.temporary else "Breakpoint"
        gdb.write(f"hit {temporary} {steps.hit.number}, ")
        gdb.execute("frame")
    elif steps.has_returned and bytes(memory.read_memory(address, size)) != held:
        found = executed
    return _Run(found if not stops or steps.has_returned else [], steps.has_returned)


def to_next(now: place.Place, element: str) -> None:
    """Stops behind the instruction or line that changes the number next, or at the end of the call."""
    try:
        run = _run_on(now, element, stops=True)
    except gdb.error as problem:
        raise gdb.GdbError(f"{element} can't be watched: {problem}") from problem
    if run.frames:
        gdb.write("{} is written in {function}, {file}:{line}\n".format(element, **run.frames[0]))
        gdb.execute("frame")
    elif run.returned:
        gdb.write(f"{element} doesn't change in the rest of this call\n")


def last(now: place.Place, element: str) -> Tuple[List[Dict[str, Any]], str]:
    """The frames of the last change in this call; if there are none, the reason."""
    try:
        frames = _run_on(now, element, stops=False).frames
    except (gdb.error, gdb.GdbError) as problem:
        return [], str(problem)
    return frames, "" if frames else f"no line of control() changes {element} in that tick"
