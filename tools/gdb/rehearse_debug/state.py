"""The numbers that a controller's object holds, by name: members, elements of containers, objects behind its pointers.

They are read as bytes of a layout that is made once, and anew when a pointer or the size of a container changes.
Inputs and commands aren't part of it: objects of cnoid are left out.
"""

import json
import struct
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

import gdb

from . import values
from .values import Unreadable

FREED = 0xA5  # the byte in memory that was freed (MALLOC_PERTURB_); memory that is allocated has it, or its complement
MOST_NUMBERS = 20_000
_DEEPEST = 12  # members of members, and objects behind pointers
_GAP = 64  # [bytes] between two numbers that are read at once
_FOREIGN = ("cnoid::", "rehearse::", "std::", "__gnu_cxx::", "Eigen::")
_FLOATS = {4: "<f", 8: "<d"}
_POINTERS = (gdb.TYPE_CODE_PTR, gdb.TYPE_CODE_REF, gdb.TYPE_CODE_RVALUE_REF)
_WHOLE = (gdb.TYPE_CODE_INT, gdb.TYPE_CODE_CHAR, gdb.TYPE_CODE_BOOL, gdb.TYPE_CODE_ENUM)

Decode = Callable[[bytes], str]


class Number(NamedTuple):
    name: str
    address: int
    size: int
    decode: Decode


def _decoder_of(kind: gdb.Type) -> Optional[Decode]:
    """For the bytes of a number; None: the type is no number."""
    decode = _plain_decoder_of(kind)
    if decode is None or kind.sizeof < 4:
        return decode
    never_set = [bytes([fill]) * kind.sizeof for fill in (FREED, FREED ^ 0xFF)]
    return lambda read: "never set" if read in never_set else decode(read)


def _plain_decoder_of(kind: gdb.Type) -> Optional[Decode]:
    if kind.code == gdb.TYPE_CODE_FLT:
        form = _FLOATS.get(kind.sizeof)
        return (lambda read: values.shortest(struct.unpack(form, read)[0], kind.sizeof)) if form else bytes.hex
    if kind.code == gdb.TYPE_CODE_BOOL:
        return lambda read: "true" if any(read) else "false"
    if kind.code == gdb.TYPE_CODE_ENUM:
        names = {field.enumval: field.name for field in kind.fields()}
        return lambda read: _name_in(names, int.from_bytes(read, "little", signed=True))
    if kind.code in _WHOLE:
        signed = kind.is_signed
        return lambda read: str(int.from_bytes(read, "little", signed=signed))
    return None


def _name_in(names: Dict[int, str], number: int) -> str:
    return names.get(number, str(number))


def is_foreign(name: str) -> bool:
    """True for the names of types and functions of libraries."""
    return name.startswith(_FOREIGN)


class Layout:
    """Where the numbers of some values are. A value that is in no memory, as in a register, is read at once."""

    def __init__(
        self, most: int = MOST_NUMBERS, apart_from: Optional["Layout"] = None, follows_pointers: bool = True
    ) -> None:
        self.numbers: List[Number] = []
        self.fixed: Dict[str, str] = {}
        self.is_complete = True
        self._most = most
        self._follows_pointers = follows_pointers
        self._guards: List[Tuple[int, bytes]] = []  # changed bytes mean another layout
        self._seen = set(apart_from._seen) if apart_from else set()

    def add(self, name: str, value: gdb.Value, depth: int = 0) -> None:
        """The numbers in a value. Memory that can't be read has none."""
        try:
            self._add(name, value, depth)
        except (gdb.error, Unreadable, OverflowError, ValueError, TypeError):
            pass

    def _add(self, name: str, value: gdb.Value, depth: int) -> None:
        if len(self.numbers) >= self._most or depth > _DEEPEST:
            self.is_complete = False
            return
        kind = value.type.strip_typedefs().unqualified()
        decode = _decoder_of(kind)
        if decode is not None:
            self._add_number(name, value, kind, decode)
        elif kind.code in _POINTERS:
            self._add_pointee(name, value, kind, depth)
        elif kind.code == gdb.TYPE_CODE_ARRAY:
            begin, end = kind.range()
            for i in range(begin, min(end + 1, begin + self._most)):
                self.add(f"{name}[{i}]", value[i], depth + 1)
        elif kind.code in (gdb.TYPE_CODE_STRUCT, gdb.TYPE_CODE_UNION) and self._is_new(value, kind):
            self._add_object(name, value, kind, depth)

    def _add_number(self, name: str, value: gdb.Value, kind: gdb.Type, decode: Decode) -> None:
        if value.is_optimized_out:
            return
        if value.address is None:
            self.fixed[name] = values.scalar(value)
        else:
            self.numbers.append(Number(name, int(value.address), kind.sizeof, decode))

    def _is_new(self, value: gdb.Value, kind: gdb.Type) -> bool:
        """False for an object whose numbers are there already, under another name."""
        if value.address is None:
            return True
        key = (int(value.address), kind.name)
        if key in self._seen:
            return False
        self._seen.add(key)
        return True

    def _guard(self, address: int, size: int) -> None:
        self._guards.append((address, bytes(gdb.selected_inferior().read_memory(address, size))))

    def _add_pointee(self, name: str, value: gdb.Value, kind: gdb.Type, depth: int) -> None:
        target = kind.target().strip_typedefs().unqualified()
        if kind.code == gdb.TYPE_CODE_PTR:
            if not self._follows_pointers:
                return
            if target.code not in (gdb.TYPE_CODE_STRUCT, gdb.TYPE_CODE_UNION) or is_foreign(target.name or ""):
                return
            if value.address is not None:
                self._guard(int(value.address), kind.sizeof)
            if not int(value):
                self.fixed[name] = "null"
                return
            value = value.dereference()
        else:
            value = value.referenced_value()
        self.add(name, values.as_it_is(value), depth + 1)

    def _add_object(self, name: str, value: gdb.Value, kind: gdb.Type, depth: int) -> None:
        called = kind.name or ""
        if called.startswith(("Eigen::Matrix<", "Eigen::Array<")):
            self._add_matrix(name, value)
        elif called.startswith("std::") and gdb.default_visualizer(value) is not None:
            self._add_container(name, value, kind, depth)
        elif called.startswith(("cnoid::", "rehearse::", "__gnu_cxx::")):  # the last: iterators, also behind an end
            return
        else:
            self._add_members(name, value, kind, depth)

    def _add_members(self, name: str, value: gdb.Value, kind: gdb.Type, depth: int) -> None:
        for field in kind.fields():
            if not hasattr(field, "bitpos") or field.artificial or (field.name or "").startswith("_vptr"):
                continue  # a static member, or the pointer to virtual functions
            if field.is_base_class:
                self.add(name, value[field], depth + 1)
            elif field.bitsize:
                self._add_bits(_member(name, field.name), value, field)
            else:
                self.add(_member(name, field.name), value[field], depth + 1)

    def _add_bits(self, name: str, value: gdb.Value, field: gdb.Field) -> None:
        if value.address is None:
            return
        shift, mask = field.bitpos % 8, (1 << field.bitsize) - 1
        address, size = int(value.address) + field.bitpos // 8, (shift + field.bitsize + 7) // 8
        self.numbers.append(
            Number(name, address, size, lambda read: str((int.from_bytes(read, "little") >> shift) & mask))
        )

    def _add_matrix(self, name: str, value: gdb.Value) -> None:
        matrix = values.EigenMatrix(value)
        if matrix.numbers.type.strip_typedefs().code == gdb.TYPE_CODE_PTR and value.address is not None:
            self._guard(int(value.address), value.type.sizeof)
        count = matrix.rows * matrix.columns
        for i in range(min(count, self._most)):
            inner = matrix.columns if matrix.by_rows else max(matrix.rows, 1)
            row, column = divmod(i, inner) if matrix.by_rows else divmod(i, inner)[::-1]
            place = f"[{i}]" if 1 in (matrix.rows, matrix.columns) else f"({row},{column})"
            self.add(name + place, matrix.numbers[i])

    def _add_container(self, name: str, value: gdb.Value, kind: gdb.Type, depth: int) -> None:
        """By libstdc++'s printers: a string, a smart pointer, or elements."""
        if value.address is not None:
            self._guard(int(value.address), kind.sizeof)
        if kind.name.startswith("std::__cxx11::basic_string<char,"):
            self._add_text(name, value)
            return
        printer = gdb.default_visualizer(value)
        if not hasattr(printer, "children"):
            return
        is_map = printer.display_hint() == "map" if hasattr(printer, "display_hint") else False
        key = ""
        for i, (child, element) in enumerate(printer.children()):
            if i >= self._most or not isinstance(element, gdb.Value):
                return
            if is_map and i % 2 == 0:
                key = str(element)
            elif is_map:
                self.add(f"{name}[{key}]", element, depth + 1)
            else:
                self.add(name + (child if child.startswith("[") else ""), element, depth + 1)

    def _add_text(self, name: str, value: gdb.Value) -> None:
        size = min(int(value["_M_string_length"]), values.LONGEST_TEXT)
        if size <= 0:
            self.fixed[name] = '""'
            return
        start = int(value["_M_dataplus"]["_M_p"])
        self.numbers.append(Number(name, start, size, lambda read: json.dumps(read.decode(errors="replace"))))

    def is_valid(self) -> bool:
        memory = gdb.selected_inferior()
        try:
            return all(bytes(memory.read_memory(address, len(held))) == held for address, held in self._guards)
        except gdb.MemoryError:
            return False

    def chunks(self) -> List[Tuple[int, int, List[Number]]]:
        """Address, size and numbers of the memory that is read at once."""
        found: List[Tuple[int, int, List[Number]]] = []
        for number in sorted(self.numbers, key=lambda known: known.address):
            end = number.address + number.size
            if found and number.address <= found[-1][0] + found[-1][1] + _GAP:
                address, size, held = found[-1]
                held.append(number)
                found[-1] = (address, max(size, end - address), held)
            else:
                found.append((number.address, number.size, [number]))
        return found

    def read(self) -> Dict[str, str]:
        texts = dict(self.fixed)
        for address, size, numbers in self.chunks():
            try:
                held = bytes(gdb.selected_inferior().read_memory(address, size))
            except gdb.MemoryError:
                continue
            for number in numbers:
                at = number.address - address
                texts[number.name] = number.decode(held[at : at + number.size])
        return texts


def _member(of: str, name: Optional[str]) -> str:
    if name and name.startswith("_M_"):  # a member of libstdc++, as of std::array
        return of
    return f"{of}.{name}" if of and name else of or name or ""


class State:
    """The numbers of values that `make` adds to a layout, and their changes from one reading to the next."""

    def __init__(self, make: Callable[[Layout], None]) -> None:
        self._make = make
        self._layout: Optional[Layout] = None
        self._chunks: List[Tuple[int, int, List[Number]]] = []
        self._bytes: List[bytes] = []
        self.texts: Dict[str, str] = {}

    @property
    def layout(self) -> Layout:
        assert self._layout is not None
        return self._layout

    def changes(self) -> Dict[str, Optional[str]]:
        """The changed numbers since the last call; None: it is gone."""
        if self._layout is None or not self._layout.is_valid():
            return self._begin()
        found: Dict[str, Optional[str]] = {}
        memory = gdb.selected_inferior()
        for i, (address, size, numbers) in enumerate(self._chunks):
            held, before = bytes(memory.read_memory(address, size)), self._bytes[i]
            if held == before:
                continue
            self._bytes[i] = held
            for number in numbers:
                at = slice(number.address - address, number.address - address + number.size)
                if held[at] != before[at]:
                    found[number.name] = self.texts[number.name] = number.decode(held[at])
        return found

    def _begin(self) -> Dict[str, Optional[str]]:
        self._layout = Layout()
        self._make(self._layout)
        self._chunks = self._layout.chunks()
        memory = gdb.selected_inferior()
        self._bytes = [bytes(memory.read_memory(address, size)) for address, size, _ in self._chunks]
        before, self.texts = self.texts, self._layout.read()
        found: Dict[str, Optional[str]] = {name: None for name in before if name not in self.texts}
        found.update({name: text for name, text in self.texts.items() if before.get(name) != text})
        return found
