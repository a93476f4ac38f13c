"""Rehearse's extension of gdb: the place of a run, moves to a tick, a controller's inputs and commands.

place      reads the place of the process (harness/src/core/host/debug_hook.h)
travel     runs to a tick, forwards or by starting again
values     reads C++ objects: strings, vectors, Eigen's types
printers   pretty printers of Eigen's and cnoid's types
tables     inputs and commands of the controller that is being called
stack      the call stack, for reports
threads    the threads of controllers, by turns
state      the numbers that a controller's object holds
lines      the lines that a call of control() executes
lockstep   two libraries of a controller side by side
commands   the commands
"""

from . import commands, printers


def register() -> None:
    """Makes the commands and the printers known to gdb; a second time it changes nothing."""
    commands.register()
    printers.register()
