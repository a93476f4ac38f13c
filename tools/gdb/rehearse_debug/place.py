"""Where the process is, read from the variables of harness/src/host/debug_hook.h.

They are read as bytes, so that it works without debug information of Rehearse as well.
"""

import struct
from typing import NamedTuple, Optional

import gdb

_LAYOUT = struct.Struct("<qqdQQQQQ")


class Place(NamedTuple):
    """DebugPlace, with its texts read. Addresses are 0 where there is nothing."""

    run: int
    tick: int
    time: float
    controller: str  # "SR1/SR1Minimum"; empty: none is being called
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
    """Whether there is a process to look at."""
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
    """None if there is no process, or one that hasn't loaded Rehearse yet."""
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
    """From there on the hook is called. Without a process it does nothing."""
    for variable, value in (("rehearse_stop_run", run), ("rehearse_stop_tick", tick)):
        address = _address_of(variable) if is_running() else None
        if address is not None:
            gdb.selected_inferior().write_memory(address, struct.pack("<q", value))
