"""Recordings of robot controllers as arrays, and the verbs of Rehearse as functions.

>>> import rehearse
>>> trace = rehearse.Trace("walk.mcap")
>>> trace["SR1/RLEG_KNEE/q"].max(), trace.units["SR1/RLEG_KNEE/q"]
>>> rehearse.check("scenarios/walk.yaml").verdict
"""

from ._command import Result, check, command, diff, record, replay
from ._controller import Controller
from ._errors import Diagnostic, Error, UnknownName

__all__ = ["Controller", "ControllerBench", "Diagnostic", "Error", "Moment", "Pictures", "Result", "Trace", "UnknownName", "check", "command", "diff",
           "record", "replay"]

_compiled = {"ControllerBench": "_control_bench", "Moment": "_trace", "Pictures": "_trace", "Trace": "_trace"}


def __getattr__(name):
    # The compiled part and numpy are loaded when they are needed: a controller's process may need neither.
    if name not in _compiled:
        raise AttributeError(f"module 'rehearse' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(f"rehearse.{_compiled[name]}"), name)
