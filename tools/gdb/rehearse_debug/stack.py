"""The call stack of the controller that is being called, with the source lines around, for a report."""

import json
import os
from typing import Any, Dict, List, Optional

import gdb

LINES_AROUND = 8


def _is_of_the_host(frame: gdb.Frame) -> bool:
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


def _described(frame: gdb.Frame) -> Dict[str, Any]:
    place = frame.find_sal()
    file = place.symtab.fullname() if place.symtab else ""
    return {"function": frame.name() or "", "file": file, "line": place.line, **_source(file, place.line)}


def frames() -> List[Dict[str, Any]]:
    """The frames of the controller, innermost first, without those of Rehearse below them."""
    found: List[Dict[str, Any]] = []
    frame: Optional[gdb.Frame] = gdb.newest_frame()
    while frame is not None and not _is_of_the_host(frame):
        found.append(_described(frame))
        frame = frame.older()
    return found


def as_json() -> str:
    return json.dumps({"frames": frames()})
