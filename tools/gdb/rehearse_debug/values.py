"""Reads C++ objects of the inferior: strings, vectors, Eigen's types.

What isn't there raises gdb.error, and what can't be such an object Unreadable.
"""

from typing import Iterator, List, Optional

import gdb

LONGEST_TEXT = 200
SHOWN = 100  # numbers, or rows; the rest is only counted
_MOST_ELEMENTS = 1_000_000
_REFERENCES = (gdb.TYPE_CODE_REF, gdb.TYPE_CODE_RVALUE_REF)


class Unreadable(Exception):
    """The memory isn't there, or holds nothing that could be such an object: it may not be initialised."""


def plain(value: gdb.Value) -> gdb.Value:
    """What a reference refers to."""
    return value.referenced_value() if value.type.code in _REFERENCES else value


def type_name(type_: gdb.Type) -> str:
    """Without typedefs, const and volatile; empty for what has none."""
    return type_.strip_typedefs().unqualified().name or ""


def text(value: gdb.Value) -> str:
    """Of a std::string."""
    length = int(value["_M_string_length"])
    if not 0 <= length <= _MOST_ELEMENTS:
        raise Unreadable("a text of impossible length")
    start = int(value["_M_dataplus"]["_M_p"])
    read = bytes(gdb.selected_inferior().read_memory(start, min(length, LONGEST_TEXT))) if length else b""
    return read.decode(errors="replace") + ("..." if length > LONGEST_TEXT else "")


def elements(vector: gdb.Value) -> Iterator[gdb.Value]:
    """Of a std::vector that isn't one of bool."""
    implementation = vector["_M_impl"]
    start, finish = implementation["_M_start"], implementation["_M_finish"]
    count = int(finish) - int(start)
    size = start.type.strip_typedefs().target().sizeof
    if count < 0 or count % size or count // size > _MOST_ELEMENTS:
        raise Unreadable("a list of impossible length")
    for i in range(count // size):
        yield (start + i).dereference()


def pointee(pointer: gdb.Value) -> Optional[gdb.Value]:
    """Of a cnoid::ref_ptr; None if it is null."""
    address = pointer["object_"]
    return address.dereference() if int(address) else None


def scalar(value: gdb.Value) -> str:
    """All digits of a number, and no more than it takes to read the same one."""
    kind = value.type.strip_typedefs()
    if kind.code != gdb.TYPE_CODE_FLT:
        return str(value)
    return shortest(float(value), kind.sizeof)


def shortest(number: float, size: int) -> str:
    """The digits of a floating-point number of that size in bytes."""
    if size < 8:  # enough digits for a float
        return f"{number:.9g}"
    text_of_double = repr(number)
    return text_of_double[:-2] if text_of_double.endswith(".0") else text_of_double


def in_brackets(texts: List[str], count: Optional[int] = None) -> str:
    """As [1, 2, 3]. `count`: of all that there are, if the texts are only the first of them."""
    more = (len(texts) if count is None else count) - min(len(texts), SHOWN)
    return "[" + ", ".join(texts[:SHOWN] + ([f"... {more} more"] if more > 0 else [])) + "]"


class EigenMatrix:
    """An Eigen::Matrix or Eigen::Array: its size, and where its numbers are."""

    def __init__(self, value: gdb.Value) -> None:
        kind = value.type.strip_typedefs().unqualified()
        storage = value["m_storage"]
        self.rows = self._extent(kind, 1, storage, "m_rows")
        self.columns = self._extent(kind, 2, storage, "m_cols")
        self.by_rows = bool(int(kind.template_argument(3)) & 1)
        data = storage["m_data"]
        is_elsewhere = data.type.strip_typedefs().code == gdb.TYPE_CODE_PTR
        self.numbers = data if is_elsewhere else data["array"]
        if is_elsewhere and self.rows * self.columns > 0 and not int(data):
            raise Unreadable("a matrix without memory")

    @staticmethod
    def _extent(kind: gdb.Type, argument: int, storage: gdb.Value, member: str) -> int:
        fixed = int(kind.template_argument(argument))
        extent = fixed if fixed >= 0 else int(storage[member])
        if not 0 <= extent <= _MOST_ELEMENTS:
            raise Unreadable("a matrix of impossible size")
        return extent

    def row(self, index: int) -> List[str]:
        """The numbers of a row, as far as they are shown."""
        shown = range(min(self.columns, SHOWN + 1))
        if self.by_rows:
            return [scalar(self.numbers[index * self.columns + column]) for column in shown]
        return [scalar(self.numbers[index + column * self.rows]) for column in shown]

    def flat(self) -> List[str]:
        """All numbers of a vector."""
        return [scalar(self.numbers[i]) for i in range(self.rows * self.columns)]

    def __str__(self) -> str:
        if self.rows == 1 or self.columns == 1:
            count = self.rows * self.columns
            return in_brackets([scalar(self.numbers[i]) for i in range(min(count, SHOWN))], count)
        rows = [in_brackets(self.row(i), self.columns) for i in range(min(self.rows, SHOWN))]
        return in_brackets(rows, self.rows)


def derives_from(kind: gdb.Type, base: str) -> bool:
    """Whether it is that class, or has it among its bases."""
    kind = kind.strip_typedefs().unqualified()
    if kind.name == base:
        return True
    if kind.code != gdb.TYPE_CODE_STRUCT:
        return False
    return any(field.is_base_class and derives_from(field.type, base) for field in kind.fields())


def as_it_is(value: gdb.Value) -> gdb.Value:
    """The object as the class that it really is of, as far as its virtual table tells."""
    try:
        return value.cast(value.dynamic_type)
    except gdb.error:
        return value
