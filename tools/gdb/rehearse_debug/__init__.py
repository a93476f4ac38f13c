"""What gdb knows of Rehearse: where a run is, how to get to a tick, what a controller reads and writes.

place      reads where the process is (harness/src/host/debug_hook.h)
travel     runs to a tick, forwards or by beginning again
values     reads C++ objects: strings, vectors, Eigen's types
printers   pretty printers of Eigen's and cnoid's types
tables     inputs and commands of the controller that is being called
commands   the commands
"""

from . import commands, printers


def register() -> None:
    """Makes the commands and the printers known to gdb; a second time it changes nothing."""
    commands.register()
    printers.register()
