"""The lines that one call of control() executes in the controller's own sources, with the numbers after each."""

from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Set, Tuple

import gdb

from . import place, stack, tables, travel
from .state import Layout, State

MOST_LINES = 20_000
_MOST_LOCALS = 500  # numbers in the variables of a function
_TABLE = "vtable for "
_SKIPPED = "^(Eigen|std|__gnu_cxx|cnoid|rehearse|fmt|boost)::"


class Line(NamedTuple):
    """The place of the process: this line is about to be executed, or the rest of it."""

    function: str
    file: str
    line: int
    is_begun: bool  # a part of the line has been executed: a function that it calls has returned
    call: int  # number of the function's call in the tick
    locals: Dict[str, str]  # the variables of the function whose declarations have been executed
    is_set: Set[str]  # of these, those that are set
    changed: Dict[str, Optional[str]]  # members and commands that the line before has changed
    result: str  # the number that a function has just returned to this line; empty: none has

    @property
    def place(self) -> Tuple[str, int]:
        return self.file, self.line


def commands_of(now: place.Place) -> Dict[str, gdb.Value]:
    """The commands of the controller that is being called, by their names in recordings; empty without the debug
    information of Rehearse."""
    try:
        io = tables.Io(now)
        names = {(io.name_of(field), field.quantity) for field in io.fields("outputs_") if field.quantity.is_of_joint}
        return {
            f"{joint}/{tables.NAMES[quantity]}": tables.command(now, f"{joint}/{tables.NAMES[quantity]}")
            for joint, quantity in sorted(names)
        }
    except gdb.error:
        return {}


def object_of(now: place.Place) -> gdb.Value:
    """The controller as an object of its own class. Raises gdb.GdbError without debug information."""
    word = gdb.lookup_type("long").pointer()
    table = gdb.Value(now.object).cast(word).dereference()
    symbol = gdb.execute(f"info symbol {int(table):#x}", to_string=True)
    name = symbol.partition(" + ")[0].partition(" in section ")[0]
    without = gdb.GdbError(
        f"{now.controller} has no class in its debug information; it has to be C++, built with -g and not stripped"
    )
    if not name.startswith(_TABLE):
        raise without
    try:
        kind = gdb.lookup_type(name[len(_TABLE) :])
    except gdb.error as problem:
        raise without from problem
    # the table of a base class states its distance from the object's beginning (Itanium C++ ABI, 2.5.2)
    offset = int((table.cast(word) - 2).dereference())
    return gdb.Value(now.object + offset).cast(kind.pointer()).dereference()


def numbers_of(now: place.Place) -> State:
    """The numbers of the controller's object, and with it the commands, each as "command hinge/u"."""

    def add_all(layout: Layout) -> None:
        layout.add("", object_of(now))
        for name, value in commands_of(now).items():
            layout.add(f"command {name}", value)

    return State(add_all)


def _is_own(frame: gdb.Frame, library: str) -> bool:
    """True in a function of the controller's own sources."""
    symtab = frame.find_sal().symtab
    if symtab is None or frame.function() is None or gdb.solib_name(frame.pc()) != library:
        return False
    return not travel.is_of_a_library(symtab)


class _Locals(NamedTuple):
    """The numbers in the variables of a function, but for those which refer to known objects."""

    declared: Dict[str, str]
    always: Set[str]  # of these, those that are set, because they are arguments, or static
    early: Dict[str, str]  # of variables whose declaration hasn't been executed: what their memory had before


def _locals_of(frame: gdb.Frame, known: Layout, is_declared: Callable[[int], bool]) -> _Locals:
    """`is_declared`: whether the line of a variable's declaration has been executed."""
    # a pointer may be behind the end of an array
    declared, always, early = (Layout(_MOST_LOCALS, apart_from=known, follows_pointers=False) for _ in range(3))
    names: Set[str] = {"this"}
    try:
        block: Optional[gdb.Block] = frame.block()
    except RuntimeError:
        return _Locals({}, set(), {})
    while block is not None and not block.is_static and not block.is_global:
        for symbol in block:
            is_compilers = symbol.name.startswith("__")  # as the end of a range
            if symbol.name in names or is_compilers or not (symbol.is_argument or symbol.is_variable):
                continue
            names.add(symbol.name)
            is_set = symbol.is_argument or symbol.addr_class == gdb.SYMBOL_LOC_STATIC
            layout = always if is_set else declared if is_declared(symbol.line) else early
            try:
                layout.add(symbol.name, symbol.value(frame))
            except (gdb.error, ValueError):
                pass
        if block.function is not None:
            break
        block = block.superblock
    set_ = always.read()
    return _Locals({**declared.read(), **set_}, set(set_), early.read())


def _result_type(frame: gdb.Frame) -> Optional[gdb.Type]:
    """The type that the frame's function returns, if it is a number in a register; else None."""
    function = frame.function()
    kind = function.type.target() if function is not None else None
    kind = kind.strip_typedefs() if kind is not None else None
    is_number = kind is not None and kind.code in _REGISTERS and kind.sizeof in (1, 4, 8)
    return kind if is_number else None


def _result(kind: gdb.Type) -> str:
    """Where a function of this type has just returned; empty: the registers of this processor aren't known."""
    try:
        if kind.code == gdb.TYPE_CODE_FLT:
            return repr(float(gdb.parse_and_eval("$xmm0.v2_double[0]" if kind.sizeof == 8 else "$xmm0.v4_float[0]")))
        # the bits above a byte are left over from other work, and gdb would take any of them for true
        return str(gdb.parse_and_eval("$al" if kind.sizeof == 1 else "$rax").cast(kind))
    except gdb.error:
        return ""


_REGISTERS = (gdb.TYPE_CODE_FLT, gdb.TYPE_CODE_INT, gdb.TYPE_CODE_BOOL, gdb.TYPE_CODE_ENUM, gdb.TYPE_CODE_CHAR)


class _Call:
    """A call of a function that has begun. A variable of it isn't set before its number changes: a constructor may leave
    its members as their memory was."""

    def __init__(self, number: int, function: str) -> None:
        self.number = number
        self.function = function
        self.line = 0  # the last that it executed
        self._left: Set[int] = set()  # lines that it has executed to their ends
        self.is_set: Set[str] = set()
        self._first: Dict[str, str] = {}

    def reach(self, line: int) -> None:
        if line != self.line:
            self._left.add(self.line)
        self.line = line

    def has_executed(self, line: int, statements: List[int]) -> bool:
        """Of a line without code, as "int count;": the call is behind it."""
        return line in self._left or (line not in statements and line < self.line)

    def update(self, texts: Dict[str, str], always: Set[str]) -> None:
        self.is_set |= always
        for name, text in texts.items():
            if self._first.setdefault(name, text) != text:
                self.is_set.add(name)


class _Calls:
    """The calls that have begun, from control() on."""

    def __init__(self) -> None:
        self._calls: List[_Call] = []
        self._number = 0

    def at(self, depth: int, function: str) -> _Call:
        del self._calls[depth + 1 :]
        if len(self._calls) > depth and self._calls[depth].function != function:
            del self._calls[depth:]
        while len(self._calls) <= depth:
            self._number += 1
            self._calls.append(_Call(self._number, function))
        return self._calls[depth]


def _depth_of(frame: gdb.Frame) -> int:
    depth, older = 0, frame.older()
    while older is not None and not stack.is_of_the_host(older):
        depth, older = depth + 1, older.older()
    return depth


class _Skips:
    """gdb steps over functions of libraries."""

    def __enter__(self) -> None:
        self._known = self._numbers()
        gdb.execute(f"skip -rfu {_SKIPPED}", to_string=True)

    def __exit__(self, *_: object) -> None:
        for number in sorted(self._numbers() - self._known):
            gdb.execute(f"skip delete {number}", to_string=True)

    @staticmethod
    def _numbers() -> Set[int]:
        rows = gdb.execute("info skip", to_string=True).splitlines()
        return {int(row.split()[0]) for row in rows if row[:1].isdigit()}


class Steps:
    """Executes the rest of a call of control() in steps: a line of the controller's own sources, or the rest of one where
    a function has returned. Breakpoints of the user end it."""

    def __init__(self) -> None:
        host = stack.host_frame()
        if host is None or not stack.frames():
            raise gdb.GdbError("gdb isn't in code of a controller here; rehearse-next-tick goes to the next control()")
        self.has_returned = False  # the call has ended
        self.hit: Optional[gdb.Breakpoint] = None  # a breakpoint of the user
        self._library = gdb.solib_name(gdb.newest_frame().pc())
        self._thread = gdb.selected_thread().global_num
        self._returns: Dict[int, gdb.Breakpoint] = {}
        self._stop_at(host.pc())

    def frames(self) -> Iterator[gdb.Frame]:
        """The innermost frame before each step."""
        gdb.events.stop.connect(self._remember)
        try:
            with _Skips():
                while place.is_running() and self.hit is None:
                    frame = gdb.newest_frame()
                    if stack.is_of_the_host(frame):
                        if stack.frames():  # in a function of the API
                            gdb.execute("finish", to_string=True)
                            continue
                        self.has_returned = True
                        return
                    is_own = _is_own(frame, self._library)
                    if is_own:
                        if frame.older() is not None:
                            self._stop_at(frame.older().pc())
                        yield frame
                    gdb.execute("step" if is_own or not _has_own_caller(frame) else "finish", to_string=True)
        finally:
            gdb.events.stop.disconnect(self._remember)
            for stop in self._returns.values():
                stop.delete()

    def _remember(self, event: gdb.StopEvent) -> None:
        hit = event.breakpoints if isinstance(event, gdb.BreakpointEvent) else []
        self.hit = next((known for known in hit if known.number > 0), None)

    def _stop_at(self, address: int) -> None:
        if address not in self._returns:
            self._returns[address] = stop = gdb.Breakpoint(f"*{address:#x}", internal=True)
            stop.silent = True
            stop.thread = self._thread


class Walk:
    """One call of control(), from its beginning to its end, line by line."""

    def __init__(self, now: place.Place) -> None:
        self.lines: List[Line] = []
        self.statements: Dict[Tuple[str, str], List[int]] = {}  # the lines of each function, by file and function
        self.is_optimised = False
        self._calls = _Calls()
        self._result_type: Optional[gdb.Type] = None  # of the function of the last line
        self._numbers = numbers_of(now)
        self._numbers.changes()
        self.first = dict(self._numbers.texts)  # members and commands at the beginning
        steps = Steps()
        for frame in steps.frames():
            self._add(frame)
            if len(self.lines) >= MOST_LINES:
                break
        self.is_complete = steps.has_returned  # false: the call executes more lines than MOST_LINES, or it didn't end
        self.last = self._numbers.changes() if self.is_complete else {}  # by the last line

    def last_texts(self) -> Dict[str, str]:
        """The numbers where the call ended."""
        return self._numbers.texts

    def last_writes(self) -> Dict[str, int]:
        """The index behind the line that wrote a number last; those that weren't written have none."""
        written = [(name, i) for i, step in enumerate(self.lines) for name in step.changed]
        return dict(written + [(name, len(self.lines)) for name in self.last])

    def _add(self, frame: gdb.Frame) -> None:
        found = frame.find_sal()
        changed = self._numbers.changes()
        function, depth = frame.name() or "", _depth_of(frame)
        statements = self._statements_of(frame, found.symtab.fullname(), function)
        call = self._calls.at(depth, function)
        has_returned = bool(self.lines) and self.lines[-1].call > call.number
        is_begun = found.pc != frame.pc() or (has_returned and call.line == found.line)
        result = _result(self._result_type) if has_returned and self._result_type is not None else ""
        self._result_type = _result_type(frame)
        call.reach(found.line)
        variables = _locals_of(frame, self._numbers.layout, lambda line: call.has_executed(line, statements))
        call.update({**variables.early, **variables.declared}, variables.always)
        step = Line(
            function,
            found.symtab.fullname(),
            found.line,
            is_begun,
            call.number,
            variables.declared,
            set(call.is_set),
            changed,
            result,
        )
        self.is_optimised = self.is_optimised or _is_optimised(found.symtab)
        self.lines.append(step)

    def _statements_of(self, frame: gdb.Frame, file: str, function: str) -> List[int]:
        if (file, function) not in self.statements:
            self.statements[file, function] = _statements(frame)
        return self.statements[file, function]


def _is_optimised(symtab: gdb.Symtab) -> bool:
    """By the compiler's flags, which its debug information has."""
    levels = [word for word in (symtab.producer or "").split() if word.startswith("-O")]
    return bool(levels) and levels[-1] not in ("-O0", "-Og")


def _has_own_caller(frame: gdb.Frame) -> bool:
    older = frame.older()
    return older is not None and not stack.is_of_the_host(older)


def _statements(frame: gdb.Frame) -> List[int]:
    block = travel.block_of(frame.pc())
    if block is None:
        return [frame.find_sal().line]
    rows = frame.find_sal().symtab.linetable() or []
    return sorted({row.line for row in rows if block.start <= row.pc < block.end and row.line > 0})
