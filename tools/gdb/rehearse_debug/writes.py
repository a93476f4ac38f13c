"""Runs on, within one call of a controller, to the lines that change one of its commands."""

from typing import Any, Dict, List

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


def _run_on(now: place.Place, element: str, stops: bool) -> List[Dict[str, Any]]:
    """The frames of the change at which it stopped, or of the last one in this call; empty: there is no change."""
    address = int(tables.command(now, element).address)
    host = stack.host_frame()
    if host is None:
        raise gdb.GdbError(f"{now}: no controller is being called")
    end = gdb.Breakpoint(f"*{host.pc():#x}", internal=True)
    end.silent = True
    write = _Write(address, stops)
    try:
        told = gdb.execute("continue", to_string=True)
    finally:
        write.delete()
        end.delete()
    if not place.is_running() or (not write.last and gdb.newest_frame().pc() != host.pc()):
        gdb.write(told)  # the program ended, or crashed
    return write.last


def to_next(now: place.Place, element: str) -> None:
    """Stops behind the instruction that changes the command next, or at the end of the call."""
    frames = _run_on(now, element, stops=True)
    if frames:
        gdb.write("{} is written in {function}, {file}:{line}\n".format(element, **frames[0]))
        gdb.execute("frame")
    elif place.is_running():
        gdb.write(f"{element} doesn't change in the rest of this call\n")


def last(now: place.Place, element: str) -> List[Dict[str, Any]]:
    """The frames of the last change in this call; those of the present place if there is none, or none can be found."""
    here = stack.frames()
    try:
        return _run_on(now, element, stops=False) or here
    except gdb.GdbError:
        return here
