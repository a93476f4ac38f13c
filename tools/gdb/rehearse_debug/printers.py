"""Pretty printers of Eigen's types and of cnoid's Body, Link, Device, ref_ptr and value trees.

A printer may read memory that isn't initialised, null pointers, and objects that the optimiser removed: then it reports
this.
"""

from typing import Any, Callable, Iterator, Optional, Tuple

import gdb
import gdb.xmethod

from . import values
from .values import Unreadable

Children = Iterator[Tuple[str, Any]]
_DEEPEST = 20  # nesting of value trees


class Printer:
    """Base class of the printers: none of them fails."""

    def __init__(self, value: gdb.Value) -> None:
        self.value = value

    def to_string(self) -> str:
        try:
            return self.summary()
        except (gdb.error, Unreadable, OverflowError, ValueError) as problem:
            return f"<{values.type_name(self.value.type)}: {problem}>"

    def summary(self) -> str:
        raise NotImplementedError


class PrinterWithParts(Printer):
    """A printer of an object whose parts are printed, too."""

    def children(self) -> Children:
        parts = self.parts()
        while True:
            try:
                part = next(parts)
            except StopIteration:
                return
            except (gdb.error, Unreadable, OverflowError, ValueError) as problem:
                yield "<unreadable>", str(problem)
                return
            yield part

    def parts(self) -> Children:
        raise NotImplementedError


class Matrix(Printer):
    def summary(self) -> str:
        return str(values.EigenMatrix(self.value))


def _first_row(value: gdb.Value) -> str:
    return values.in_brackets(values.EigenMatrix(value).flat())


class Quaternion(Printer):
    def summary(self) -> str:
        x, y, z, w = values.EigenMatrix(self.value["m_coeffs"]).flat()
        return f"(w {w}, x {x}, y {y}, z {z})"


class Transform(Printer):
    def summary(self) -> str:
        matrix = values.EigenMatrix(self.value["m_matrix"])
        size = matrix.columns - 1
        rows = [matrix.row(i) for i in range(size)]
        position = values.in_brackets([row[size] for row in rows])
        return f"p {position} R {values.in_brackets([values.in_brackets(row[:size]) for row in rows])}"


class AngleAxis(Printer):
    def summary(self) -> str:
        return f"({values.scalar(self.value['m_angle'])} about {_first_row(self.value['m_axis'])})"


class Translation(Printer):
    def summary(self) -> str:
        return _first_row(self.value["m_coeffs"])


class RefPtr(Printer):
    """A pointer is printed with a short form of its object; `print *pointer` prints more."""

    def summary(self) -> str:
        pointee = values.pointee(self.value)
        if pointee is None:
            return "null"
        address = f"({self.value['object_'].type.target().name}*) {int(self.value['object_']):#x}"
        printer = find(pointee)
        return f"{address} {printer.to_string()}" if printer else address


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


class Body(PrinterWithParts):
    """Name and size; then the root's position, and each joint."""

    def summary(self) -> str:
        links = sum(1 for _ in values.elements(self.value["linkTraverse_"]["links_"]))
        devices = sum(1 for _ in values.elements(self.value["devices_"]))
        name, model = values.text(self.value["name_"]), values.text(self.value["modelName_"])
        joints = int(self.value["numIdentifiedJoints_"])
        return (
            f'Body "{name}"' + (f" (model {model})" if model != name else "") + f": {_counted(links, 'link')}, "
            f"{_counted(joints, 'joint')}, {_counted(devices, 'device')}"
        )

    def parts(self) -> Children:
        root = values.pointee(self.value["rootLink_"])
        if root is not None:
            yield "root", Transform(root["T_"]).to_string()
        for i, element in enumerate(values.elements(self.value["joints_"])):
            if i == values.SHOWN:
                yield "...", "more joints"
                return
            link = values.pointee(element)
            if link is not None:
                yield Link.joint_name(link), Link.of_joint(link)


class Link(PrinterWithParts):
    """Name and joint; then the state of motion."""

    _JOINT_TYPES = ("revolute", "prismatic", "free", "fixed", "track")
    _STATES = ("q", "dq", "ddq", "u", "q_target", "dq_target")

    @staticmethod
    def joint_name(link: gdb.Value) -> str:
        return values.text(link["jointSpecificName_"]) or values.text(link["name_"])

    @staticmethod
    def of_joint(link: gdb.Value) -> str:
        return ", ".join(f"{state} {values.scalar(link[state + '_'])}" for state in ("q", "dq", "u"))

    def summary(self) -> str:
        kind = int(self.value["jointType_"])
        if not 0 <= kind < len(self._JOINT_TYPES):
            raise Unreadable("a link that isn't initialised")
        joint = int(self.value["jointId_"])
        name, own = values.text(self.value["name_"]), self.joint_name(self.value)
        called = f" {own}" if own != name else ""
        number = f"joint {joint}{called}, " if joint >= 0 else ""
        return f'Link "{name}" ({number}{self._JOINT_TYPES[kind]})'

    def parts(self) -> Children:
        if int(self.value["jointType_"]) in (0, 1):
            for state in self._STATES:
                yield state, values.scalar(self.value[state + "_"])
        yield "T", Transform(self.value["T_"]).to_string()
        for motion in ("v", "w", "F_ext"):
            yield motion, Matrix(self.value[motion + "_"]).to_string()
        points = sum(1 for _ in values.elements(self.value["contactPoints_"]))
        if points:
            yield "contactPoints", points


class Device(PrinterWithParts):
    """Class and name; then its state: all numbers, vectors and flags of its class, except limits."""

    def __init__(self, value: gdb.Value) -> None:
        super().__init__(values.as_it_is(value))

    def summary(self) -> str:
        kind = values.type_name(self.value.type).rpartition("::")[2]
        link = self.value["link_"]
        place = f' on link "{values.text(link.dereference()["name_"])}"' if int(link) else ""
        return f'{kind} "{values.text(self.value["name_"])}"{place}'

    def parts(self) -> Children:
        yield from self._members(self.value)

    def _members(self, value: gdb.Value) -> Children:
        for field in value.type.strip_typedefs().fields():
            if field.is_base_class:
                if field.type.name != "cnoid::Device" and values.derives_from(field.type, "cnoid::Device"):
                    yield from self._members(value.cast(field.type))
            elif hasattr(field, "bitpos") and not field.name.endswith("_max_"):  # not a static member
                yield from self._member(field.name.rstrip("_"), value[field])

    @staticmethod
    def _member(name: str, value: gdb.Value) -> Children:
        code = value.type.strip_typedefs().code
        if code in (gdb.TYPE_CODE_FLT, gdb.TYPE_CODE_INT, gdb.TYPE_CODE_BOOL, gdb.TYPE_CODE_ENUM):
            yield name, values.scalar(value)
        elif values.type_name(value.type).startswith("Eigen::"):
            printer = find(value)
            if printer:
                yield name, printer.to_string()


class Node(Printer):
    """A value tree, as YAML in one line."""

    def summary(self) -> str:
        return self._node(self.value, _DEEPEST)

    def _node(self, value: gdb.Value, depth: int) -> str:
        value = values.as_it_is(value)
        kind = int(value["type_"])
        if depth == 0:
            return "..."
        if kind == 1:
            return values.text(value.cast(gdb.lookup_type("cnoid::ScalarNode"))["value_"])
        if kind == 2:
            return self._mapping(value.cast(gdb.lookup_type("cnoid::Mapping")), depth - 1)
        if kind == 4:
            nodes = values.elements(value.cast(gdb.lookup_type("cnoid::Listing"))["values_"])
            return values.in_brackets([self._pointed(node, depth - 1) for node in nodes])
        return "(none)"

    def _mapping(self, value: gdb.Value, depth: int) -> str:
        printer = gdb.default_visualizer(value["values_"])  # libstdc++'s, since a map's layout is private
        if printer is None:
            return "{...}"
        pairs = [part for _, part in printer.children()]
        texts = [f"{values.text(key)}: {self._pointed(node, depth)}" for key, node in zip(pairs[::2], pairs[1::2])]
        return "{" + ", ".join(texts) + "}"

    def _pointed(self, pointer: gdb.Value, depth: int) -> str:
        node = values.pointee(pointer)
        return "null" if node is None else self._node(node, depth)


_BY_TEMPLATE: "dict[str, Callable[[gdb.Value], Printer]]" = {
    "Eigen::Matrix": Matrix,
    "Eigen::Array": Matrix,
    "Eigen::Quaternion": Quaternion,
    "Eigen::Transform": Transform,
    "Eigen::AngleAxis": AngleAxis,
    "Eigen::Translation": Translation,
    "cnoid::ref_ptr": RefPtr,
}
_BY_BASE: "dict[str, Callable[[gdb.Value], Printer]]" = {
    "cnoid::Body": Body,
    "cnoid::Link": Link,
    "cnoid::Device": Device,
    "cnoid::ValueNode": Node,
}


def find(value: gdb.Value) -> Optional[Printer]:
    """The printer of a value; None if gdb's own printer is sufficient."""
    kind = value.type
    if kind.code in (gdb.TYPE_CODE_REF, gdb.TYPE_CODE_RVALUE_REF):
        kind = kind.target()
    kind = kind.strip_typedefs().unqualified()
    if kind.code != gdb.TYPE_CODE_STRUCT or not kind.name:
        return None
    template, _, arguments = kind.name.partition("<")
    if arguments:
        printer = _BY_TEMPLATE.get(template)
    else:
        printer = next((known for base, known in _BY_BASE.items() if values.derives_from(kind, base)), None)
    return printer(values.plain(value)) if printer else None


class _Lookup:
    """Finds printers for gdb. `disable pretty-printer global rehearse` turns all of them off."""

    name = "rehearse"
    enabled = True

    def __call__(self, value: gdb.Value) -> Optional[Printer]:
        return find(value)


class _PointerMethod(gdb.xmethod.XMethod, gdb.xmethod.XMethodWorker):
    """A function of ref_ptr. Its code is always inlined, so gdb can't call it."""

    def __init__(self, name: str) -> None:
        gdb.xmethod.XMethod.__init__(self, name)

    def get_arg_types(self) -> None:
        return None

    def get_result_type(self, pointer: gdb.Value) -> gdb.Type:
        return self(pointer).type

    def __call__(self, pointer: gdb.Value) -> gdb.Value:
        address = pointer["object_"]
        return address.dereference() if self.name == "operator*" else address


class _PointerMethods(gdb.xmethod.XMethodMatcher):
    def __init__(self) -> None:
        super().__init__("cnoid::ref_ptr")
        self.methods = [_PointerMethod(name) for name in ("operator->", "operator*", "get")]

    def match(self, class_type: gdb.Type, method_name: str) -> Optional[_PointerMethod]:
        if not (values.type_name(class_type)).startswith("cnoid::ref_ptr<"):
            return None
        return next((method for method in self.methods if method.enabled and method.name == method_name), None)


def register() -> None:
    """Registers the printers before all others, and replaces those of an earlier `source`."""
    gdb.pretty_printers = [
        known for known in gdb.pretty_printers if getattr(known, "name", None) != _Lookup.name
    ]
    gdb.pretty_printers.insert(0, _Lookup())
    gdb.xmethod.register_xmethod_matcher(None, _PointerMethods(), replace=True)
