"""The threads of controllers that take turns."""

import os
from typing import Dict, Optional

import gdb

from . import place, stack, travel


def _line_of(thread: Optional[gdb.InferiorThread]) -> str:
    """The innermost line of the thread in the code of a controller; empty: it has none."""
    if thread is None:
        return ""
    thread.switch()
    frame: Optional[gdb.Frame] = gdb.newest_frame()
    while frame is not None:
        found = frame.find_sal()
        if found.symtab and not stack.is_of_the_host(frame) and not travel.is_of_a_library(found.symtab):
            return f"{os.path.basename(found.symtab.filename)}:{found.line}"
        frame = frame.older()
    return ""


def table() -> str:
    """A line for each thread, that of the calls first; the selected thread and frame stay."""
    selected, frame = gdb.selected_thread(), gdb.selected_frame()
    turns = place.turns()
    if not turns:
        return "no thread of a controller takes turns here\n"
    by_number: Dict[int, gdb.InferiorThread] = {thread.ptid[1]: thread for thread in gdb.selected_inferior().threads()}
    lines = []
    try:
        for turn in turns:
            thread = by_number.get(turn.tid)
            number = f"{thread.num}" if thread else "-"
            does = "has the turn" if turn.has_turn else f"waits for {turn.waits_for}"
            line = _line_of(thread)
            where = f" at {line}" if line else ""
            lines.append(f"{'*' if turn.has_turn else ' '} {number:>2} {turn.name}{where} {does}\n")
    finally:
        selected.switch()
        frame.select()
    return "".join(lines)
