"""The place of the process, read from the variables of harness/src/core/host/debug_hook.h.

They are read as bytes, so that no debug information of Rehearse is needed.
"""

import struct
from typing import List, NamedTuple, Optional

import gdb

_LAYOUT = struct.Struct("<qqdQQQQQ")
_THREAD = struct.Struct("<qqqQQ")


class Place(NamedTuple):
    """DebugPlace, with its texts read. An address is 0 if there is no object."""

    run: int
    tick: int
    time: float
    controller: str  # "SR1/SR1Minimum"; empty: no controller is being called
    function: str
    object: int
    io: int
    body: int

    def __str__(self) -> str:
        where = f"tick {self.tick} ({self.time:g} s)"
        if self.run > 1:
            where += f" of the process's run {self.run}"
        if not self.controller:
            return where + ", between the calls of controllers"
        function = self.function if " " in self.function else self.function + "()"
        return where + f", in {function} of {self.controller}"


def is_running() -> bool:
    """True if a process exists."""
    return gdb.selected_inferior().pid != 0


def _address_of(variable: str) -> Optional[int]:
    try:
        return int(gdb.parse_and_eval(f"(unsigned long)&{variable}"))
    except gdb.error:
        return None  # the library isn't loaded yet


def _text_at(address: int) -> str:
    if not address:
        return ""
    memory = gdb.selected_inferior()
    text = b""
    while len(text) < 256 and not text.endswith(b"\0"):
        text += bytes(memory.read_memory(address + len(text), 1))
    return text.rstrip(b"\0").decode(errors="replace")


def here() -> Optional[Place]:
    """The current place; None if there is no process, or if it hasn't loaded Rehearse yet."""
    address = _address_of("rehearse_now") if is_running() else None
    if address is None:
        return None
    try:
        run, tick, time, controller, function, *addresses = _LAYOUT.unpack(
            bytes(gdb.selected_inferior().read_memory(address, _LAYOUT.size))
        )
        return Place(run, tick, time, _text_at(controller), _text_at(function), *addresses)
    except gdb.error:
        return None


class Turn(NamedTuple):
    """DebugThread, with its texts read."""

    tid: int
    number: int  # 0: the thread of the calls
    has_turn: bool
    name: str  # "'planner'"
    waits_for: str


def _turn_of(tid: int, number: int, has_turn: int, name: int, waits_for: int) -> Turn:
    text = _text_at(name)
    shown = f"'{text}'" if text else f"thread {number}"
    return Turn(tid, number, has_turn != 0, shown if number else "the call itself", _text_at(waits_for))


def turns() -> List[Turn]:
    """The threads that take turns, that of the calls first; empty: none does."""
    address = _address_of("rehearse_threads") if is_running() else None
    if address is None:
        return []
    count = int(gdb.parse_and_eval("((long (*)()) rehearse_list_threads)()"))
    memory = bytes(gdb.selected_inferior().read_memory(address, count * _THREAD.size)) if count else b""
    return [_turn_of(*fields) for fields in _THREAD.iter_unpack(memory)]


def stop_from(run: int, tick: int) -> None:
    """Sets the run and tick from which on the hook is called. Does nothing without a process."""
    for variable, value in (("rehearse_stop_run", run), ("rehearse_stop_tick", tick)):
        address = _address_of(variable) if is_running() else None
        if address is not None:
            gdb.selected_inferior().write_memory(address, struct.pack("<q", value))
