"""Runs on, within one call of a controller, to the lines that change one of its commands."""

from typing import Any, Dict, List, NamedTuple, Optional

import gdb

from . import place, stack, tables


class _Write(gdb.Breakpoint):
    """A watchpoint on a command. With `stops` false it only stores the frames of the last change."""

    def __init__(self, address: int, stops: bool) -> None:
        super().__init__(f"*(double*){address:#x}", gdb.BP_WATCHPOINT, gdb.WP_WRITE, internal=True)
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


def _run_on(now: place.Place, element: str, stops: bool) -> _Run:
    address = int(tables.command(now, element).address)
    host = stack.host_frame()
    if host is None or not stack.frames():
        raise gdb.GdbError("gdb isn't in code of a controller here; rehearse-next-tick goes to the next control()")
    end = gdb.Breakpoint(f"*{host.pc():#x}", internal=True)
    end.silent = True
    write = _Write(address, stops)
    try:
        gdb.execute("continue")
        return _Run(write.last, place.is_running() and gdb.newest_frame().pc() == host.pc())
    finally:
        write.delete()
        end.delete()


def to_next(now: place.Place, element: str) -> None:
    """Stops behind the instruction that changes the command next, or at the end of the call."""
    reported = _are_reported()
    try:
        run = _run_on(now, element, stops=True)
    except gdb.error as problem:
        raise gdb.GdbError(f"{element} can't be watched: {problem}") from problem
    if run.frames:
        gdb.write("{} is written in {function}, {file}:{line}\n".format(element, **run.frames[0]))
        gdb.execute("frame")
    elif run.returned:
        if reported:
            gdb.write(f"{element} doesn't change in the rest of this call\n")
        else:
            gdb.write(f"unknown whether {element} changes in the rest of this call: this machine reports no watchpoints\n")


def last(now: place.Place, element: str) -> List[Dict[str, Any]]:
    """The frames of the last change in this call; those of the present place if there is none, or none can be found."""
    here = stack.frames()
    try:
        return _run_on(now, element, stops=False).frames or here
    except gdb.error:  # no debug information
        return here
