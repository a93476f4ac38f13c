"""The commands. Their help is what stands in their docstrings."""

import json
from typing import Optional

import gdb

from . import lockstep, place, stack, tables, threads, travel, writes

# The controller that the user selected: NAME or BODY/NAME; empty: the first that is called in a tick.
_chosen = ""


def _number(text: str, otherwise: Optional[int], lowest: int) -> int:
    if not text and otherwise is not None:
        return otherwise
    if not text.isdecimal() or int(text) < lowest:
        raise gdb.GdbError(f"'{text}' is not a whole number from {lowest} on")
    return int(text)


def _one_word(argument: str) -> str:
    words = argument.split()
    if len(words) > 1:
        raise gdb.GdbError(f"'{words[1]}' is one argument too many")
    return words[0] if words else ""


def _here() -> place.Place:
    now = place.here()
    if now is None or now.run == 0:
        raise gdb.GdbError("no run has begun: rehearse-tick N starts the program and stops at tick N")
    return now


def _looked_at(now: place.Place) -> str:
    """The controller that is being called, or the one chosen before."""
    return now.controller if now.function == "control" else _chosen


def _before_its_control(now: place.Place) -> bool:
    """No control() has been called in the run."""
    return now.tick == 0 and now.function not in ("", "control")


def _travel(tick: int, controller: str) -> None:
    now = place.here()
    if now is None or now.run == 0:
        travel.go(travel.Target(0, tick, controller), again=False)
        return
    is_ahead = tick > now.tick or (tick == now.tick and _before_its_control(now))
    travel.go(travel.Target(now.run, tick, controller), again=not is_ahead)


class Prefix(gdb.Command):
    """Looking at a controller in Rehearse: at a tick, at what it reads, at what it commands.

    rehearse-tick [N]       where the process is; with N: to the beginning of control() at tick N
    rehearse-next-tick [N]  to the next tick, or N ticks on
    rehearse-back [N]       to the tick before, or N ticks back, by beginning again
    rehearse-inputs         what the controller sees
    rehearse-commands       what it has commanded so far
    rehearse-write NUMBER   to the line that changes a command or a variable
    rehearse-stack          its call stack with source lines, as JSON
    rehearse-threads        its threads: which one has the turn, and what the others wait for

    Bodies, links, devices, value trees, and Eigen's vectors and matrices are printed as what they mean; `print /r`
    shows them raw."""

    def __init__(self) -> None:
        super().__init__("rehearse", gdb.COMMAND_USER, gdb.COMPLETE_NONE, prefix=True)

    def invoke(self, argument: str, from_tty: bool) -> None:
        gdb.execute("help rehearse")


class Tick(gdb.Command):
    """rehearse-tick [N [CONTROLLER]]: where the process is, or to the beginning of control() at tick N.

    Without N: tick, simulated time, controller, and which of its functions is being called.
    With N it runs until control() is called at tick N, forwards if that is still to come (other breakpoints stop it on
    the way), else by starting the program again (other breakpoints don't). If no program runs it is started.
    CONTROLLER (NAME or BODY/NAME) is which one, if there are several; else it is the one at hand, or the first."""

    def __init__(self) -> None:
        super().__init__("rehearse-tick", gdb.COMMAND_RUNNING, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        global _chosen
        tick, _, controller = argument.strip().partition(" ")
        if not tick:
            gdb.write(f"{_here()}\n")
            return
        wanted = _number(tick, None, 0)
        now = place.here()
        _chosen = controller.strip() or (_looked_at(now) if now else _chosen)
        _travel(wanted, _chosen)


class NextTick(gdb.Command):
    """rehearse-next-tick [N]: to control() of the same controller in the next tick, or N ticks on.

    Other breakpoints stop it on the way."""

    def __init__(self) -> None:
        super().__init__("rehearse-next-tick", gdb.COMMAND_RUNNING, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        on = _number(_one_word(argument), 1, 1)
        now = _here()
        _travel(now.tick + on, _looked_at(now))


class Back(gdb.Command):
    """rehearse-back [N]: to control() of the same controller in the tick before, or N ticks back.

    0 is the beginning of this tick. A run is the same every time, so the program is started again and runs at full
    speed until there. Other breakpoints are kept, and don't stop it on the way. A recording that it writes is written
    anew."""

    def __init__(self) -> None:
        super().__init__("rehearse-back", gdb.COMMAND_RUNNING, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        back = _number(_one_word(argument), 1, 0)
        now = _here()
        if back > now.tick:
            raise gdb.GdbError(f"this is tick {now.tick}: there is nothing {back} ticks before it")
        travel.go(travel.Target(now.run, now.tick - back, _looked_at(now)), again=True)


class Inputs(gdb.Command):
    """rehearse-inputs: what the controller sees in this tick: what it has enabled as input, as its body holds it now.

    Numbers have all their digits. A star marks what is no longer what was handed to the controller in this tick."""

    def __init__(self) -> None:
        super().__init__("rehearse-inputs", gdb.COMMAND_DATA, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        _one_word(argument)
        gdb.write(tables.inputs(_here()))


class Commands(gdb.Command):
    """rehearse-commands: what the controller has commanded so far, in this tick, and in the one before.

    What its outputs hold now is what it would command if control() returned here. A star marks what has changed since
    the tick before."""

    def __init__(self) -> None:
        super().__init__("rehearse-commands", gdb.COMMAND_DATA, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        _one_word(argument)
        gdb.write(tables.commands(_here()))


class Write(gdb.Command):
    """rehearse-write NUMBER: on to the line of control() that changes a number next: a command as hinge/u, /q or /dq, or an
    expression of C++ as integral_ or legs_[2].phase.

    It stops behind that line, or where control() returns. Other breakpoints stop it on the way."""

    def __init__(self) -> None:
        super().__init__("rehearse-write", gdb.COMMAND_RUNNING, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        writes.to_next(_here(), argument.strip())


class Stack(gdb.Command):
    """rehearse-stack [JOINT/QUANTITY]: the call stack of the controller with its source lines, as a line of JSON.

    With a command: that of the line that changes it last in this call of control(), which is run to its end."""

    def __init__(self) -> None:
        super().__init__("rehearse-stack", gdb.COMMAND_STACK, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        element, now = _one_word(argument), _here()
        gdb.write((stack.as_json(*writes.last(now, element)) if element else stack.as_json(stack.frames())) + "\n")


class Threads(gdb.Command):
    """rehearse-threads: the threads of controllers, each with the line at which it is and what it waits for.

    A star marks the one that has the turn: all others stand still until it waits. N is gdb's number of the thread, for
    `thread N`."""

    def __init__(self) -> None:
        super().__init__("rehearse-threads", gdb.COMMAND_STATUS, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        _one_word(argument)
        _here()
        gdb.write(threads.table())


class Lockstep(gdb.Command):
    """rehearse-lockstep REQUEST RESULT: what `rehearse replay --beside` does; both are files of JSON."""

    def __init__(self) -> None:
        super().__init__("rehearse-lockstep", gdb.COMMAND_OBSCURE, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        request, result = argument.split()
        try:
            found = lockstep.compare(lockstep.Request.read(request))
        except (gdb.error, gdb.GdbError) as problem:
            found = {"failure": str(problem)}
        with open(result, "w", encoding="utf-8") as stream:
            json.dump(found, stream)


class Start(gdb.Command):
    """rehearse-start TICK [CONTROLLER]: what `rehearse replay --gdb` begins with."""

    def __init__(self) -> None:
        super().__init__("rehearse-start", gdb.COMMAND_OBSCURE, gdb.COMPLETE_NONE)

    def invoke(self, argument: str, from_tty: bool) -> None:
        try:
            gdb.execute(f"rehearse-tick {argument}")
        except gdb.error as problem:
            if place.is_running():
                raise
            raise gdb.GdbError(
                f"{problem}\nIf gdb may trace nothing here, a container needs --cap-add=SYS_PTRACE; see also "
                "/proc/sys/kernel/yama/ptrace_scope."
            ) from problem


def register() -> None:
    for command in (Prefix, Tick, NextTick, Back, Inputs, Commands, Write, Stack, Threads, Lockstep, Start):
        command()
    # the signal by which the watchdog (guarded_call.cpp) ends a call; it does so only without a debugger
    gdb.execute("handle SIGXCPU nostop noprint pass", to_string=True)
