"""Runs a process to the beginning of control() at a tick: forwards, or by beginning again."""

from typing import Callable, List, NamedTuple, Optional

import gdb

from . import place

HOOK = "rehearse_at_tick"
# Slots of the virtual table of cnoid::SimpleController in the Itanium ABI: two destructors, configure, initialize, start.
_SLOT_OF_CONTROL = 5
_THUNKS = ("non-virtual thunk to ", "virtual thunk to ")


class Target(NamedTuple):
    """Where to stop."""

    run: int  # or in a later one
    tick: int
    controller: str  # NAME or BODY/NAME; empty: the first that is called in the tick

    def is_reached_by(self, now: place.Place) -> bool:
        if now.run < self.run or now.tick < self.tick:
            return False
        return not self.controller or self.controller in (now.controller, now.controller.partition("/")[2])


class Hook(gdb.Breakpoint):
    """The breakpoint before control(). Only one exists, and only while something is on its way to a tick."""

    def __init__(self, target: Target) -> None:
        super().__init__(HOOK, internal=True)  # pending, if the library comes later
        self.silent = True
        self.target = target
        self.reached = False

    def stop(self) -> bool:
        now = place.here()
        if now is None:
            return False
        # A process that has just begun calls the hook in its first tick, and is told here from where on it shall do so.
        place.stop_from(self.target.run, self.target.tick)
        self.reached = self.target.is_reached_by(now)
        return self.reached


def go(target: Target, again: bool) -> None:
    """Runs until there; `again`: from the beginning of the program, past the user's breakpoints. Says where it came to."""
    resting = _rest_breakpoints() if again else []
    hook = _quietly(lambda: Hook(target))  # gdb would say that it is pending
    try:
        told = _resume("run" if again or not place.is_running() else "continue", target)
        if hook.reached:
            hook.enabled = False
            told = _enter_control()
    finally:
        hook.delete()
        for breakpoint_ in resting:
            breakpoint_.enabled = True
    if hook.reached:
        _tell_arrival(target, told)
    else:
        _tell_another_end(target, told)


def _resume(how: str, target: Target) -> str:
    """Returns what gdb said of the stop; what the process prints appears at once."""
    if how == "continue":
        place.stop_from(target.run, target.tick)
    return gdb.execute(how, to_string=True)


_made: List[gdb.Breakpoint] = []
_make: Optional[Callable[[], gdb.Breakpoint]] = None


def _quietly(make: Callable[[], Hook]) -> Hook:
    """Makes a breakpoint while what gdb says goes nowhere, which it does only while a command is executed."""
    global _make
    _make = make
    gdb.execute(f"python import sys; sys.modules['{__name__}'].make_now()", to_string=True)
    return _made.pop()


def make_now() -> None:
    """For _quietly()."""
    assert _make is not None
    _made.append(_make())


def _rest_breakpoints() -> List[gdb.Breakpoint]:
    resting = [known for known in gdb.breakpoints() if known.number > 0 and known.enabled]
    for breakpoint_ in resting:
        breakpoint_.enabled = False
    return resting


def _enter_control() -> str:
    """From the hook into control(), to its first line. Returns what gdb said if it stopped elsewhere."""
    now = place.here()
    assert now is not None and now.object
    unsigned_long = gdb.lookup_type("unsigned long").pointer()
    table = int(gdb.Value(now.object).cast(unsigned_long).dereference())
    slot = int((gdb.Value(table).cast(unsigned_long) + _SLOT_OF_CONTROL).dereference())
    wanted = first_lines_of(slot)
    stops = [gdb.Breakpoint(f"*{address:#x}", internal=True) for address in wanted]
    for stop in stops:
        stop.silent = True
    try:
        told = gdb.execute("continue", to_string=True)
    finally:
        for stop in stops:
            stop.delete()
    return "" if place.is_running() and gdb.newest_frame().pc() in wanted else told


def first_lines_of(address: int) -> List[int]:
    """Where the function that begins there, or, of a thunk, that it leads to, has its first line behind the prologue: the
    first of these that is met. Without debug information: the address itself."""
    name = _function_at(address)
    is_thunk = _block_of(address) is None
    for location in _locations_of(name) if name else []:
        block = _block_of(location)
        if block is None or gdb.solib_name(location) != gdb.solib_name(address):
            continue
        if is_thunk or block.start == address:  # else it is another function of that name
            return [location] if _is_in_own_source(location, block) else _own_lines(block) or [location]
    return [address]


def _own_lines(block: gdb.Block) -> List[int]:
    """All lines of a function that are its own. One that is optimised may begin with others, inlined from a header."""
    lines = [line for line in block.function.symtab.linetable() or [] if block.start <= line.pc < block.end]
    own = {line.pc for line in lines if line.line > block.function.line and _is_in_own_source(line.pc, block)}
    return sorted(own)


def _block_of(address: int) -> Optional[gdb.Block]:
    """That of the function, not of what is inlined there."""
    block, outermost = gdb.block_for_pc(address), None
    while block is not None and not block.is_static and not block.is_global:
        if block.function is not None:
            outermost = block
        block = block.superblock
    return outermost


def _is_in_own_source(address: int, block: gdb.Block) -> bool:
    source = gdb.find_pc_line(address).symtab
    return source is not None and source.filename == block.function.symtab.filename


def _function_at(address: int) -> str:
    """As it can be asked for again, with its parameters."""
    block = _block_of(address)
    if block is not None and block.start == address:
        return block.function.print_name
    symbol = gdb.execute(f"info symbol {address:#x}", to_string=True).partition(" in section ")[0].strip()
    for thunk in _THUNKS:
        if symbol.startswith(thunk):
            return symbol[len(thunk) :]
    return ""


def _locations_of(function: str) -> List[int]:
    """Where gdb would stop in functions of that name."""
    probe = gdb.Breakpoint(function=function, internal=True)
    try:
        return [location.address for location in probe.locations]
    finally:
        probe.delete()


def _tell_arrival(target: Target, told: str) -> None:
    now = place.here()
    if told or now is None:
        gdb.write(told)
        return
    if now.run > target.run > 0:
        gdb.write(f"run {target.run} ended before tick {target.tick}; this is run {now.run} of the process\n")
    gdb.write(f"{now}\n")
    frame = gdb.newest_frame()
    if frame.find_sal().symtab is None:
        library = gdb.solib_name(frame.pc()) or "the program"
        gdb.write(f"{library} has no debug information (build it with -g): this is the address of control()\n")
    gdb.execute("frame")


def _tell_another_end(target: Target, told: str) -> None:
    gdb.write(told)
    now = place.here()
    if not place.is_running():
        whose = f" of {target.controller}" if target.controller else ""
        gdb.write(f"the program ended before control(){whose} at tick {target.tick}\n")
    elif now is not None:
        gdb.write(f"stopped on the way to tick {target.tick}: {now}\n")
