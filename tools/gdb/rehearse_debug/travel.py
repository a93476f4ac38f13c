"""Runs a process to the beginning of control() at a tick: forwards, or by beginning again."""

from typing import Callable, List, NamedTuple, Optional, Tuple

import gdb

from . import place

HOOK = "rehearse_at_tick"
# In the virtual table of cnoid::SimpleController (Itanium ABI), control comes after two destructors, configure,
# initialize and start.
_SLOT_OF_CONTROL = 5
FOLDERS_OF_LIBRARIES = ("/usr/include/", "/usr/lib/", "/eigen3/", "/include/cnoid/")
_THUNKS = ("non-virtual thunk to ", "virtual thunk to ")


def is_of_a_library(symtab: gdb.Symtab) -> bool:
    return any(folder in symtab.fullname() for folder in FOLDERS_OF_LIBRARIES)


class Target(NamedTuple):
    """The place where gdb stops."""

    run: int  # this run, or a later one
    tick: int
    controller: str  # NAME or BODY/NAME; empty: the first that is called in the tick

    def is_reached_by(self, now: place.Place) -> bool:
        if now.run < self.run or now.tick < self.tick:
            return False
        return not self.controller or self.controller in (now.controller, now.controller.partition("/")[2])


class Hook(gdb.Breakpoint):
    """The breakpoint before control(). At most one exists, and only during a move to a tick."""

    def __init__(self, target: Target) -> None:
        super().__init__(HOOK, internal=True)  # pending if the library is loaded later
        self.silent = True
        self.target = target
        self.reached = False

    def stop(self) -> bool:
        now = place.here()
        if now is None:
            return False
        # A process that has just started calls the hook in its first tick; here the hook learns at which tick to stop.
        place.stop_from(self.target.run, self.target.tick)
        self.reached = self.target.is_reached_by(now)
        return self.reached


def go(target: Target, again: bool) -> None:
    """Runs to the target and returns a message. `again`: from the program's start, without the user's breakpoints."""
    resting = _rest_breakpoints() if again else []
    try:
        reached, told = _run_to(target, "run" if again or not place.is_running() else "continue")
    finally:
        for breakpoint_ in resting:
            breakpoint_.enabled = True
    if reached:
        _tell_arrival(target, told)
    else:
        _tell_another_end(target, told)


def reach(target: Target) -> bool:
    """Starts the program and runs to the target, without a message; false if the program stops elsewhere or ends."""
    reached, told = _run_to(target, "run")
    return reached and not told


def _run_to(target: Target, how: str) -> Tuple[bool, str]:
    """Whether the tick was reached, and what gdb said if it stopped elsewhere then."""
    hook = quietly(lambda: Hook(target))  # hides gdb's message "pending"
    try:
        told = _resume(how, target)
        if hook.reached:
            hook.enabled = False
            told = _enter_control()
        return hook.reached, told
    finally:
        hook.delete()


def _resume(how: str, target: Target) -> str:
    """Returns what gdb said of the stop; what the process prints appears at once."""
    if how == "continue":
        place.stop_from(target.run, target.tick)
    return gdb.execute(how, to_string=True)


_made: List[gdb.Breakpoint] = []
_make: Optional[Callable[[], gdb.Breakpoint]] = None


def quietly(make: Callable[[], gdb.Breakpoint]) -> gdb.Breakpoint:
    """Makes a breakpoint while what gdb says goes nowhere, which it does only while a command is executed."""
    global _make
    _make = make
    gdb.execute(f"python import sys; sys.modules['{__name__}'].make_now()", to_string=True)
    return _made.pop()


def make_now() -> None:
    """For quietly()."""
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
    """Where the function that begins there (or that it leads to, if it is a thunk) has its first line behind the
    prologue: the first of these that is met. Without debug information: the address itself."""
    block = block_of(address)
    if block is not None:
        return _lines_of(block)
    for location in _behind_thunk(address):
        block = block_of(location)
        if block is not None and gdb.solib_name(location) == gdb.solib_name(address):
            return _lines_of(block)
    return [address]


def _lines_of(block: gdb.Block) -> List[int]:
    """All beginnings of lines in the function's own file, but for the one that has its head. A function that is
    optimised may begin with something that is inlined: to stop in a header of a library helps nobody."""
    function = block.function
    if _file_of(block.start) != function.symtab.filename and not _is_in_a_library(block.start):
        return [block.start]
    lines = [line for line in function.symtab.linetable() or [] if block.start <= line.pc < block.end]
    own = {line.pc for line in lines if line.line != function.line}
    own = {address for address in own if _file_of(address) == function.symtab.filename}
    behind_prologue = [line.pc for line in lines if line.pc > block.start]
    return sorted(own) or behind_prologue[:1] or [block.start]


def _file_of(address: int) -> str:
    source = gdb.find_pc_line(address).symtab
    return source.filename if source is not None else ""


def _is_in_a_library(address: int) -> bool:
    """What stands there is inlined from a header that isn't the user's."""
    return any(folder in _file_of(address) for folder in FOLDERS_OF_LIBRARIES)


def block_of(address: int) -> Optional[gdb.Block]:
    """That of the function, not of what is inlined there."""
    block, outermost = gdb.block_for_pc(address), None
    while block is not None and not block.is_static and not block.is_global:
        if block.function is not None:
            outermost = block
        block = block.superblock
    return outermost


def _behind_thunk(address: int) -> List[int]:
    """Where gdb would stop in functions of the name that the thunk there has; empty: it is none."""
    symbol = gdb.execute(f"info symbol {address:#x}", to_string=True).partition(" in section ")[0].strip()
    for thunk in _THUNKS:
        if symbol.startswith(thunk):
            probe = gdb.Breakpoint(function=symbol[len(thunk) :], internal=True)
            try:
                return [location.address for location in probe.locations]
            finally:
                probe.delete()
    return []


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
