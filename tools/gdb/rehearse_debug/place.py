"""The place of the process, read from the variables of harness/src/core/host/debug_hook.h.

They are read as bytes, so that no debug information of Rehearse is needed.
"""

import struct
from typing import NamedTuple, Optional

import gdb

_LAYOUT = struct.Struct("<qqdQQQQQ")


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


def stop_from(run: int, tick: int) -> None:
    """Sets the run and tick from which on the hook is called. Does nothing without a process."""
    for variable, value in (("rehearse_stop_run", run), ("rehearse_stop_tick", tick)):
        address = _address_of(variable) if is_running() else None
        if address is not None:
            gdb.selected_inferior().write_memory(address, struct.pack("<q", value))
