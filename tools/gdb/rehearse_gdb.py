"""Commands and printers for controllers that run in Rehearse: `source` this in gdb.

`rehearse replay TRACE --gdb` does this itself. In gdb with a test program, or with any program that runs controllers:

    (gdb) source share/rehearse/gdb/rehearse_gdb.py
    (gdb) rehearse-tick 120

`help rehearse` lists the commands. Python 3.9 and gdb 12 or later.
"""

import os
import sys

_folder = os.path.dirname(os.path.abspath(__file__))
_writes_bytecode = sys.dont_write_bytecode
sys.dont_write_bytecode = True  # this folder may belong to the system
sys.path.insert(0, _folder)
try:
    import rehearse_debug

    rehearse_debug.register()
finally:
    sys.path.remove(_folder)
    sys.dont_write_bytecode = _writes_bytecode
