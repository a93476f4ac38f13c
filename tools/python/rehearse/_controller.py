"""Controllers in Python: their base class, and how their files are loaded. It needs neither numpy nor the compiled part."""

from __future__ import annotations

import ast
import importlib
import importlib.machinery
import os
import sys
import traceback
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple

if TYPE_CHECKING:
    from ._io import IO


class Controller:
    """A controller, named in a scenario as ``library: hold.py:Hold``.

    One object is made for each run, without arguments. It runs in the recorder's process as a controller in C++ does:
    it is recorded, replayed and audited alike. An exception is the controller's failure, with its tick.
    """

    def initialize(self, io: "IO") -> Optional[bool]:
        """States what is read and commanded: ``io.joint("KNEE").read("q")``. False keeps it out of the run."""
        raise NotImplementedError

    def start(self) -> Optional[bool]:
        """Called after initialize() of every controller. False keeps it out of the run."""

    def control(self) -> Optional[bool]:
        """Called once a step. False: nothing is left to do; it is called again nevertheless."""
        raise NotImplementedError

    def stop(self) -> None:
        """Called after the last step."""


class Refused(ImportError):
    """The file isn't a controller."""


class _Recorded:
    """Standard output as messages of the controller that is called, a line each."""

    encoding, errors, closed = "utf-8", "replace", False

    def __init__(self) -> None:
        self._line = ""

    def write(self, text: str) -> int:
        self._line += text
        whole, newline, self._line = self._line.rpartition("\n")
        if newline:
            _write(whole + "\n")
        return len(text)

    def flush(self) -> None:
        """A line that isn't complete waits for its end."""

    def isatty(self) -> bool:
        return False


def _write(text: str) -> None:
    sys.modules["rehearse._io"].write(text)


def print_to_recordings() -> None:
    """In a process that runs controllers: what they print is recorded."""
    global _is_host
    _is_host = True
    sys.stdout = sys.stderr = _Recorded()  # type: ignore[assignment]


class _FreshSource(importlib.machinery.SourceFileLoader):
    """Compiles the source itself: a cached one with the same time and size may be of other text."""

    def get_code(self, fullname: str) -> Any:
        path = self.get_filename(fullname)
        return compile(self.get_data(path), path, "exec", dont_inherit=True)


def _finder(folder: str) -> importlib.machinery.FileFinder:
    return importlib.machinery.FileFinder(
        folder, (importlib.machinery.ExtensionFileLoader, importlib.machinery.EXTENSION_SUFFIXES),
        (_FreshSource, importlib.machinery.SOURCE_SUFFIXES))


_folders: List[str] = []  # of the loaded controllers
_loaded = 0
_imported_here: Dict[str, None] = {}  # modules of controllers
_is_host = False  # this process only runs controllers: all modules in their folders are theirs


def _is_inside(path: Optional[str], folder: str) -> bool:
    return bool(path) and os.path.commonpath([folder, os.path.abspath(path)]) == folder  # type: ignore[type-var]


def load(file: str, name: str) -> type:
    """The class `name` of a file. Modules beside it can be imported; they are executed anew if none is in use.

    Of modules with the same name in the folders of two controllers, each controller has its own, unless it imports them
    only while it runs.
    """
    global _loaded
    file = os.path.normpath(file)
    folder, stem = os.path.dirname(file), os.path.splitext(os.path.basename(file))[0]
    if not stem.isidentifier():
        raise Refused(f"'{stem}' is no name of a module")
    if _loaded == 0:
        _forget()
    _load_numpy()
    _forget_modules([known for known in _folders if known != folder])
    if folder not in _folders:
        _folders.append(folder)
        sys.path_hooks.insert(0, _hook)
    else:
        sys.path.remove(folder)
    sys.path.insert(0, folder)
    sys.path_importer_cache[folder] = _finder(folder)
    known = sys.modules.get(stem)
    if known is not None and getattr(known, "__file__", None) != file:
        raise Refused(f"there is another module '{stem}': {getattr(known, '__file__', 'of Python')}")
    before = set(sys.modules)
    module = importlib.import_module(stem)
    _imported_here.update(dict.fromkeys(set(sys.modules) - before))
    if getattr(module, "__file__", None) != file:
        raise Refused(f"there is another module '{stem}': {getattr(module, '__file__', 'of Python')}")
    found = getattr(module, name, None)
    if found is None:
        classes = [key for key, value in vars(module).items() if isinstance(value, type) and
                   issubclass(value, Controller) and value is not Controller]
        raise Refused(f"it has no class '{name}'" + (f"; it has {', '.join(classes)}" if classes else ""))
    if not (isinstance(found, type) and issubclass(found, Controller)):
        raise Refused(f"'{name}' is no class that inherits rehearse.Controller")
    _loaded += 1
    return found


def _load_numpy() -> None:
    """Here, as its settings for the processor are pinned while a controller is loaded."""
    try:
        importlib.import_module("numpy")
    except ImportError:
        pass


def plain(error: BaseException) -> str:
    """The exception without its place."""
    if isinstance(error, Refused):
        return str(error)
    if isinstance(error, SyntaxError):
        return f"{type(error).__name__}: {error.msg}"
    return "".join(traceback.format_exception_only(type(error), error)).strip().splitlines()[-1]


def unload() -> None:
    """A class that load() returned isn't used any more."""
    global _loaded
    _loaded -= 1


def _hook(folder: str) -> importlib.machinery.FileFinder:
    if any(_is_inside(folder, known) for known in _folders):
        return _finder(folder)
    raise ImportError


def _forget() -> None:
    """The next load() executes the modules of controllers anew, so that a run doesn't depend on earlier ones."""
    _forget_modules(_folders)
    for folder in _folders:
        sys.path.remove(folder)
        sys.path_hooks.remove(_hook)
    for folder in list(sys.path_importer_cache):
        if any(_is_inside(folder, known) for known in _folders):
            del sys.path_importer_cache[folder]
    _folders.clear()


def _forget_modules(folders: List[str]) -> None:
    for name, module in list(sys.modules.items()):
        is_own = _is_host or name in _imported_here
        if is_own and any(_is_inside(getattr(module, "__file__", None), folder) for folder in folders):
            del sys.modules[name]


def files(file: str) -> List[str]:
    """The file, and those beside and below it that it imports, directly or not, in the order of their names."""
    found: Dict[str, None] = {}
    waiting = [os.path.abspath(file)]
    root = os.path.dirname(waiting[0])
    while waiting:
        path = waiting.pop()
        if path in found:
            continue
        found[path] = None
        try:
            with open(path, "rb") as source:
                tree = ast.parse(source.read(), path)
        except (OSError, SyntaxError, ValueError):
            continue
        waiting += [part for name in _imported(tree, path, root) for part in _parts(name, root)]
    return sorted(found)


def _imported(tree: ast.AST, path: str, root: str) -> List[str]:
    names: List[str] = []
    package = os.path.relpath(os.path.dirname(path), root).split(os.sep)
    package = [] if package == ["."] else package
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[:len(package) - node.level + 1] if node.level else []
            base = ".".join(above + ([node.module] if node.module else []))
            names += [base] if base else []
            names += [f"{base}.{alias.name}" if base else alias.name for alias in node.names]
    return names


def _parts(name: str, root: str) -> List[str]:
    """The files of a module below the folder, and of the packages that it is in."""
    found: List[str] = []
    place = root
    for part in name.split("."):
        place = os.path.join(place, part)
        found += [path for path in (place + ".py", os.path.join(place, "__init__.py")) if os.path.isfile(path)]
    return found


def place_of(error: BaseException) -> Tuple[str, int, str]:
    """The file, the line and the function where an exception was raised, in a controller's file if one is on the way."""
    if isinstance(error, SyntaxError) and error.filename:
        return error.filename, error.lineno or 0, ""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if any(_is_inside(frame.filename, folder) for folder in _folders)]
    if not own:
        return "", 0, ""
    return own[-1].filename, own[-1].lineno or 0, own[-1].name


def sentence(error: BaseException) -> str:
    """The exception as one sentence, with its place."""
    file, line, function = place_of(error)
    return plain(error) + (f" ({os.path.basename(file)}:{line}{' in ' + function if function else ''})" if file else "")


def told(error: BaseException) -> str:
    """The traceback."""
    text = "".join(traceback.TracebackException.from_exception(error).format())
    for folder in _folders:  # a recording doesn't depend on the folder
        text = text.replace(folder + os.sep, "")
    return text
