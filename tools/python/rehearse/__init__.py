"""Recordings of robot controllers as arrays, and the verbs of Rehearse as functions.

>>> import rehearse
>>> trace = rehearse.Trace("walk.mcap")
>>> trace["SR1/RLEG_KNEE/q"].max(), trace.units["SR1/RLEG_KNEE/q"]
>>> rehearse.check("scenarios/walk.yaml").verdict
"""

from ._command import Result, audit, check, command, diff, history, inspect, record, replay, report, sweep
from ._controller import Controller
from ._errors import Diagnostic, Error, NoSuchFile, UnknownName

__all__ = ["Controller", "ControllerBench", "Diagnostic", "Error", "Moment", "NoSuchFile", "Pictures", "Result", "Tap", "Trace", "UnknownName",
           "audit", "check", "command", "diff", "history", "inspect", "record", "replay", "report", "sweep"]

_compiled = {"ControllerBench": "_control_bench", "Moment": "_trace", "Pictures": "_trace", "Tap": "_tap", "Trace": "_trace"}


def __getattr__(name):
    # The compiled part and numpy are loaded when they are needed: a controller's process may need neither.
    if name == "__version__":
        from importlib.metadata import version

        return version("rehearse")
    if name not in _compiled:
        raise AttributeError(f"module 'rehearse' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(f"rehearse.{_compiled[name]}"), name)
