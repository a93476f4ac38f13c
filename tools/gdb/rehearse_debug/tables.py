"""Inputs and commands of the controller that is being called, as tables.

Inputs and commands are the quantities that the harness copies: the tables of its ControllerIo
(harness/src/core/host/io_layout.h). The numbers are those in the controller's body.
"""

import enum
from typing import List, NamedTuple

import gdb

from . import place, printers, values


class Quantity(enum.IntEnum):
    """As in io_layout.h."""

    Q = 0
    DQ = 1
    DDQ = 2
    U = 3
    POSE = 4
    TWIST = 5
    ACCELERATION = 6
    WRENCH = 7

    @property
    def is_of_joint(self) -> bool:
        return self <= Quantity.U


# The members of cnoid::Link, as input and as command.
_READ = {Quantity.Q: "q", Quantity.DQ: "dq", Quantity.DDQ: "ddq", Quantity.U: "u"}
NAMES = _READ  # of the quantities of joints, in recordings
_WRITTEN = {Quantity.Q: "q_target", Quantity.DQ: "dq_target", Quantity.DDQ: "ddq", Quantity.U: "u"}
_OF_LINK = {
    Quantity.TWIST: ("v", "w"),
    Quantity.ACCELERATION: ("dv", "dw"),
    Quantity.WRENCH: ("F_ext",),
}


class Field(NamedTuple):
    """IoField."""

    link: int
    quantity: Quantity
    offset: int


class Io:
    """A ControllerIo of the harness, with the body of its controller."""

    def __init__(self, now: place.Place) -> None:
        if not now.io or not now.body:
            raise gdb.GdbError(f"{now}: no controller is being called that has a body yet")
        try:
            self.io = gdb.Value(now.io).cast(gdb.lookup_type("rehearse::ControllerIo").pointer()).dereference()
            self.body = gdb.Value(now.body).cast(gdb.lookup_type("cnoid::Body").pointer()).dereference()
        except gdb.error as problem:
            raise gdb.GdbError("Rehearse has no debug information here: what is an input can't be told") from problem
        if not bool(self.io["frozen_"]):
            raise gdb.GdbError(f"{now}: inputs and outputs are known once all controllers have initialized")
        self.links = [values.pointee(link) for link in values.elements(self.body["linkTraverse_"]["links_"])]

    def fields(self, layout: str) -> List[Field]:
        return [
            Field(int(field["link"]), Quantity(int(field["quantity"])), int(field["offset"]))
            for field in values.elements(self.io[layout]["fields"])
        ]

    def numbers(self, member: str) -> List[str]:
        return [values.scalar(number) for number in values.elements(self.io[member])]

    def name_of(self, field: Field) -> str:
        link = self.links[field.link]
        assert link is not None
        return printers.Link.joint_name(link) if field.quantity.is_of_joint else values.text(link["name_"])

    def current(self, field: Field, members: "dict[Quantity, str]") -> List[str]:
        """The present numbers of a field in the body; of a pose only the position."""
        link = self.links[field.link]
        assert link is not None
        if field.quantity.is_of_joint:
            return [values.scalar(link[members[field.quantity] + "_"])]
        if field.quantity == Quantity.POSE:
            pose = values.EigenMatrix(link["T_"]["m_matrix"])
            return [pose.row(i)[3] for i in range(3)]
        vectors = [values.EigenMatrix(link[member + "_"]).flat() for member in _OF_LINK[field.quantity]]
        return [number for vector in vectors for number in vector]


def command(now: place.Place, element: str) -> gdb.Value:
    """The number in the body by which a joint is commanded: JOINT/QUANTITY, as recordings call it. Raises gdb.error
    without debug information."""
    joint, _, quantity = element.rpartition("/")
    members = {_READ[known]: member for known, member in _WRITTEN.items()}
    body = gdb.Value(now.body).cast(gdb.lookup_type("cnoid::Body").pointer()).dereference()
    for link in map(values.pointee, values.elements(body["linkTraverse_"]["links_"])):
        if link is not None and printers.Link.joint_name(link) == joint and quantity in members:
            return link[members[quantity] + "_"]
    raise gdb.GdbError(f"'{element}' is no command of a joint (JOINT/u, /q or /dq; see rehearse-commands)")


def _table(rows: List[List[str]]) -> str:
    """Columns as wide as their widest cell, the first left-aligned; positive numbers have a blank instead of a sign."""
    padded = [[cell if cell.startswith("-") or i == 0 else " " + cell for i, cell in enumerate(row)] for row in rows]
    widths = [max(len(row[i]) for row in padded if i < len(row)) for i in range(max(map(len, padded)))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in padded]
    return "".join(f"  {line}\n" for line in lines)


def inputs(now: place.Place) -> str:
    """Joints as a table, then links, contacts and devices."""
    io = Io(now)
    text = f"inputs of {now.controller}, tick {now.tick} ({now.time:g} s)\n"
    fields, given = io.fields("inputs_"), io.numbers("input_values_")
    columns = [quantity for quantity in _READ if any(field.quantity == quantity for field in fields)]
    by_joint: "dict[str, dict[Quantity, str]]" = {}
    others: List[List[str]] = []
    for field in fields:
        numbers = io.current(field, _READ)
        changed = numbers != given[field.offset : field.offset + len(numbers)]
        star = "*" if changed else ""
        if field.quantity.is_of_joint:
            by_joint.setdefault(io.name_of(field), {})[field.quantity] = numbers[0] + star
        else:
            others.append([io.name_of(field), _name_of(field.quantity), values.in_brackets(numbers) + star])
    if by_joint:
        rows = [["joint"] + [_READ[quantity] for quantity in columns]]
        rows += [[name] + [cells.get(quantity, "") for quantity in columns] for name, cells in by_joint.items()]
        text += _table(rows)
    others += _contacts(io) + _devices(io)
    if others:
        text += _table(others)
    if not by_joint and not others:
        text += "  none: it has enabled nothing\n"
    return text


def _name_of(quantity: Quantity) -> str:
    if quantity == Quantity.POSE:
        return "p"
    return ", ".join(_OF_LINK[quantity])


def _contacts(io: Io) -> List[List[str]]:
    rows = []
    for number in values.elements(io.io["contact_links_"]):
        link = io.links[int(number)]
        assert link is not None
        points = list(values.elements(link["contactPoints_"]))
        rows.append([values.text(link["name_"]), "contacts", str(len(points))])
    return rows


def _devices(io: Io) -> List[List[str]]:
    devices = list(values.elements(io.body["devices_"]))
    rows = []
    for number in values.elements(io.io["input_devices_"]):
        device = values.pointee(devices[int(number)])
        if device is None:
            continue
        printer = printers.Device(device)
        state = ", ".join(f"{name} {value}" for name, value in printer.children())
        kind = values.type_name(printer.value.type).rpartition("::")[2]
        rows.append([values.text(device["name_"]), kind, state])
    return rows


def commands(now: place.Place) -> str:
    """Each command now, and in the tick before."""
    io = Io(now)
    text = f"commands of {now.controller}, tick {now.tick} ({now.time:g} s), so far\n"
    before = io.numbers("output_values_")
    rows = [["", "", "now", f"tick {now.tick - 1}" if now.tick > 0 else ""]]
    for field in io.fields("outputs_"):
        numbers = io.current(field, _WRITTEN)
        earlier = before[field.offset : field.offset + len(numbers)] if now.tick > 0 else []
        star = "*" if earlier and earlier != numbers else ""
        what = _WRITTEN[field.quantity] if field.quantity.is_of_joint else _name_of(field.quantity)
        rows.append([io.name_of(field), what, _shown(numbers) + star, _shown(earlier)])
    if len(rows) == 1:
        return text + "  none: it has enabled no output\n"
    return text + _table(rows)


def _shown(numbers: List[str]) -> str:
    return numbers[0] if len(numbers) == 1 else values.in_brackets(numbers) if numbers else ""
