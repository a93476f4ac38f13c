"""python_reference.py MODEL: prints the reference of the module `rehearse` as Markdown, from its docstrings.

The page is tools/site/pages/reference/python.md; the test Python.reference compares them. MODEL is a robot, for which a
controller is loaded: its view of the robot (rehearse._io) is made with the first one.
"""

import inspect
import re
import sys
import tempfile
import textwrap
from pathlib import Path

import rehearse
from rehearse import testing

HEAD = """# Python

This page has the classes and functions of the module `rehearse`, from their docstrings; [arrays](../howto/traces_in_python.md),
[controllers](../howto/controller_in_python.md) and [tests](../howto/pytest.md) have pages with examples.
"""
ROBOT = """import rehearse


class Nothing(rehearse.Controller):
    def initialize(self, io):
        pass

    def control(self):
        pass
"""


def io_module(model):
    """The module rehearse._io, which exists once a controller was loaded."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "nothing_of_reference.py").write_text(ROBOT)
        bench = rehearse.ControllerBench(f"{folder}/nothing_of_reference.py:Nothing", model)
        del bench
    return sys.modules["rehearse._io"]


def text_of(thing):
    """The docstring in lines of at most 120 characters, names in code as Markdown has them."""
    doc = inspect.getdoc(thing) or ""
    doc = re.sub(r"^\w+\(self: .*\n?\n?", "", doc).replace("``", "`").split("\n    ")[0]
    return [re.sub(r"\s+", " ", part).strip() for part in doc.split("\n\n") if part.strip()]


def wrapped(text, indent=""):
    return textwrap.fill(text, 120, initial_indent=indent and "- ", subsequent_indent=indent, break_long_words=False,
                         break_on_hyphens=False)


def shown_parameter(parameter):
    marks = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}
    default = "" if parameter.default is parameter.empty else f"={parameter.default!r}"
    return marks.get(parameter.kind, "") + parameter.name + default


def signature(name, thing):
    """The name with its parameters and their defaults, as a caller writes them."""
    try:
        parameters = list(inspect.signature(thing).parameters.values())
    except (TypeError, ValueError):  # a compiled function states them in its docstring
        found = re.match(r"\w+\(self: [\w.]+(?:, )?(.*?)\) ->", (thing.__doc__ or "").strip())
        return f"{name}({re.sub(r': [^,=]+ = ', '=', re.sub(r': [^,=]+(?=,|$)', '', found.group(1) if found else ''))})"
    shown = []
    for parameter in parameters:
        if parameter.name == "self":
            continue
        if parameter.kind == parameter.KEYWORD_ONLY and "*" not in shown and not any(one[0] == "*" for one in shown):
            shown.append("*")
        shown.append(shown_parameter(parameter))
    return f"{name}({', '.join(shown)})"


def members(cls):
    for name, member in sorted(vars(cls).items(), key=lambda item: item[0]):
        if name.startswith("_") and name != "__getitem__":
            continue
        parts = text_of(member)
        if not parts:
            continue
        shown = name
        if name == "__getitem__":
            shown = {"Trace": "trace[NAME]", "Moment": "moment[NAME]", "ControllerBench": "bench[JOINT]"}.get(cls.__name__, "result[NAME]")
        elif not isinstance(member, property):
            shown = signature(name, getattr(cls, name))
        yield wrapped(f"`{shown}`: {' '.join(parts)}", "  ")


def class_text(cls):
    lines = [f"## {cls.__name__}", ""]
    for part in text_of(cls):
        lines += [wrapped(part), ""]
    if cls.__init__ is not object.__init__ and not cls.__module__.startswith("rehearse._io") and \
            not issubclass(cls, (Exception, rehearse.Result, rehearse.Moment, rehearse.Pictures, testing.Golden)):
        try:
            lines += [f"`{signature(cls.__name__, cls)}`", ""]
        except (TypeError, ValueError):
            pass
    return "\n".join(lines + list(members(cls))).rstrip() + "\n"


def function_text(function):
    lines = [f"## {function.__name__}", "", f"`{signature(function.__name__, function)}`", ""]
    for part in text_of(function):
        lines += [wrapped(part), ""]
    return "\n".join(lines).rstrip() + "\n"


def main():
    own = io_module(sys.argv[1])
    parts = [HEAD]
    parts += [class_text(cls) for cls in (rehearse.Trace, rehearse.Moment, rehearse.Pictures)]
    parts += [function_text(one) for one in (rehearse.check, rehearse.record, rehearse.replay, rehearse.diff, rehearse.sweep,
                                             rehearse.audit, rehearse.history, rehearse.inspect, rehearse.report)]
    parts += [class_text(cls) for cls in (rehearse.Result, rehearse.Error, rehearse.UnknownName, rehearse.NoSuchFile, rehearse.Controller,
                                          own.IO, own.Joint, own.Link, own.Device, rehearse.ControllerBench,
                                          rehearse.Tap)]
    parts += [function_text(one) for one in (testing.assert_matches_golden, testing.assert_holds, testing.assert_replays)]
    print("\n".join(parts), end="")


main()
