"""The call stack of the controller that is being called, with the source lines around, for a report."""

import json
import os
from typing import Any, Dict, List, Optional

import gdb

LINES_AROUND = 8
_BEGINNINGS = {"__libc_start_call_main", "start_thread", "clone", "clone3"}  # of a process or a thread


def is_of_the_host(frame: gdb.Frame) -> bool:
    library = os.path.basename(gdb.solib_name(frame.pc()) or "")
    return library == "" or library.startswith("librehearse")


def _source(file: str, line: int) -> Dict[str, Any]:
    """The lines around `line`; empty if the file can't be read."""
    try:
        with open(file, encoding="utf-8", errors="replace") as stream:
            lines = stream.read().splitlines()
    except OSError:
        return {"begin": 0, "source": []}
    begin = max(1, line - LINES_AROUND)
    return {"begin": begin, "source": lines[begin - 1 : line + LINES_AROUND]}


def _of_frame(frame: gdb.Frame, has_executed: bool) -> Dict[str, Any]:
    """`has_executed`: the line is that of the instruction before."""
    place = gdb.find_pc_line(frame.pc() - 1) if has_executed else frame.find_sal()
    return described(frame.name() or "", place.symtab.fullname() if place.symtab else "", place.line)


def described(function: str, file: str, line: int) -> Dict[str, Any]:
    """A place with the lines around, as a member of JSON."""
    return {"function": function, "file": file, "line": line, **_source(file, line)}


def _newest_of_controller() -> Optional[gdb.Frame]:
    """The innermost frame of the controller, also while it calls the API; None: no code of a controller is called."""
    frame: Optional[gdb.Frame] = gdb.newest_frame()
    while frame is not None and is_of_the_host(frame):
        frame = frame.older()
    return None if frame is None or frame.name() in _BEGINNINGS or host_frame(frame) is None else frame


def frames(has_written: bool = False) -> List[Dict[str, Any]]:
    """The frames of the controller, innermost first, without those of Rehearse below and above them. `has_written`: the
    newest frame is behind the instruction that a watchpoint has stopped."""
    found: List[Dict[str, Any]] = []
    frame = _newest_of_controller()
    while frame is not None and not is_of_the_host(frame):
        found.append(_of_frame(frame, has_written and frame == gdb.newest_frame()))
        frame = frame.older()
    return found


def host_frame(begin: Optional[gdb.Frame] = None) -> Optional[gdb.Frame]:
    """The frame of Rehearse that has called the controller, from this one on, or else from its innermost one."""
    frame = begin if begin is not None else _newest_of_controller()
    while frame is not None and not is_of_the_host(frame):
        frame = frame.older()
    return frame


def enter_functions() -> None:
    """Goes from the host's control() of a controller in C or Rust into the function of its library, a few lines on."""
    place = gdb.newest_frame().find_sal()
    if not place.symtab or os.path.basename(place.symtab.filename) != "c_controller.cpp":
        return  # it isn't there, and stays where it is
    for _ in range(64):  # also through functions that are inlined there
        gdb.execute("step", to_string=True)
        if frames():
            return


def as_json(of: List[Dict[str, Any]], reason: str = "") -> str:
    """`reason`: why there are none."""
    return json.dumps({"frames": of, "reason": reason})
