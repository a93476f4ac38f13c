"""Recordings as arrays."""

from __future__ import annotations

import html
import operator
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np

from . import _rehearse
from ._errors import Error, NoSuchFile, UnknownName

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

_nanosecond = 1e-9  # [s]


def _optional(module: str, use: str) -> Any:
    """A module that only this use needs."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise Error.saying(f"{use} needs {package}, which isn't installed", f"apt install python3-{package}, or pip install {package}") from None


def _curve(values: np.ndarray, width: int = 120, height: int = 18) -> str:
    """A small plot of finite numbers, as SVG; empty if there are fewer than two."""
    numbers = np.asarray(values, dtype=np.float64)
    numbers = numbers[np.isfinite(numbers)]
    if len(numbers) < 2:
        return ""
    shown = numbers[np.linspace(0, len(numbers) - 1, min(len(numbers), width)).astype(int)]
    least, most = shown.min(), shown.max()
    heights = (most - shown) / (most - least) * (height - 2) + 1 if most > least else np.full(len(shown), height / 2)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(np.linspace(0, width, len(shown)), heights))
    return (f'<svg width="{width}" height="{height}" role="img" aria-label="from {least:.3g} to {most:.3g}">'
            f'<polyline points="{points}" fill="none" stroke="currentColor"/></svg>')


class _Lookup(Mapping):
    """Names, each with a value that is made when it is asked for."""

    def __init__(self, kind: str, names: List[str], value: Callable[[str], Any]) -> None:
        self._kind, self._names, self._value = kind, names, value

    def __getitem__(self, name: str) -> Any:
        if name not in self._names:
            known = ", ".join(self._names[:8]) or "none"
            raise UnknownName.saying(f"there is no {self._kind} '{name}'", f"there is: {known}")
        return self._value(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<{len(self._names)} of {self._kind}: {', '.join(self._names[:4])}{', ...' if len(self._names) > 4 else ''}>"


class Pictures(Sequence):
    """The pictures of a camera, each read from the file when it is asked for.

    A colour picture is an array of rows, columns and 3 bytes (RGB). A depth picture is an array of rows and columns,
    distances along the optical axis [m]. A slice, as ``[10:20]``, has a part of the pictures, and reads none yet.
    """

    def __init__(self, trace: _rehearse.Trace, topic: str, part: Optional[range] = None) -> None:
        self._trace, self.topic = trace, topic
        self._part = range(len(trace.channel_stamps(topic))) if part is None else part

    @property
    def time(self) -> np.ndarray:
        """Time of each picture [s]."""
        return self._trace.channel_stamps(self.topic)[list(self._part)] * _nanosecond

    def __len__(self) -> int:
        return len(self._part)

    def __getitem__(self, index: Union[int, slice]) -> Any:  # type: ignore[override]
        if isinstance(index, slice):
            return Pictures(self._trace, self.topic, self._part[index])
        try:
            number = operator.index(index)
        except TypeError:
            raise TypeError(f"the pictures of {self.topic} have numbers: expected an int or a slice, not {index!r}; "
                            "trace.images[CAMERA].time has their times") from None
        if not -len(self) <= number < len(self):
            raise IndexError(f"{self.topic} has {len(self)} pictures, no number {number}")
        return self._trace.picture(self.topic, self._part[number])


class Moment(Mapping):
    """A recording at one time: the last value of each series at or before it."""

    def __init__(self, trace: "Trace", stamp: int) -> None:
        self._trace, self._stamp = trace, stamp
        self.time: float = stamp * _nanosecond
        """[s]"""

    @property
    def tick(self) -> int:
        """The number of the tick."""
        return int(self["tick"])

    def __getitem__(self, name: str) -> Union[float, int, bool]:
        stamps = self._trace._file.stamps(name)
        place = int(np.searchsorted(stamps, np.uint64(self._stamp), side="right")) - 1
        if place < 0:
            raise Error.saying(f"'{name}' has no value at or before {self.time} s",
                               f"its first is at {stamps[0] * _nanosecond} s" if len(stamps) else "it has none at all")
        return self._trace[name][place].item()

    def __iter__(self) -> Iterator[str]:
        return iter(self._trace)

    def __len__(self) -> int:
        return len(self._trace)

    def _side(self, side: str) -> _Lookup:
        found: Dict[str, List[str]] = {}
        for name in self._trace.keys():
            controller, part, element = name.partition(f"/{side}/")
            if part and controller.count("/") == 1:
                found.setdefault(controller, []).append(element)
        return _Lookup("controller", sorted(found), lambda controller: {
            element: self[f"{controller}/{side}/{element}"] for element in found[controller]})

    @property
    def inputs(self) -> _Lookup:
        """What each controller, as "SR1/Walk", read: numbers by name, as "RLEG_KNEE/q"."""
        return self._side("input")

    @property
    def outputs(self) -> _Lookup:
        """What each controller commanded, in the same form."""
        return self._side("output")

    def __repr__(self) -> str:
        return f"<{self._trace.file} at {self.time:g} s>"


class Trace(Mapping):
    """A recording, or any other log that ``rehearse info`` reads: MCAP, a ROS 2 bag, a ROS 1 bag.

    ``trace["SR1/RLEG_KNEE/q"]`` is the series of that name, one number a message, in the unit
    ``trace.units["SR1/RLEG_KNEE/q"]``. The array shares the memory of the recording and can't be written; ``.copy()``
    makes one that can. The whole file is read once, and its checksums are checked. Pictures stay in the file.

    topics: patterns, as ["/SR1/joints", "/SR1/*/wrench"]: only the channels of these topics are read, by a temporary copy.
    A pattern that no topic matches raises ``rehearse.Error``.

    tolerate: a damaged or incomplete file is read as far as possible, and ``damage`` states the rest; else it raises
    ``rehearse.Error``. A file that isn't there raises ``FileNotFoundError``.

    A name with ``*``, as ``trace["Arm/*/q"]``, stands for any text: a dict of the arrays of all series that match.
    ``with rehearse.Trace("walk.mcap") as trace:`` closes the file at its end; arrays that were read stay.
    """

    def __init__(self, file: Union[str, "os.PathLike[str]"], topics: Union[str, Sequence[str], None] = None,
                 tolerate: bool = False) -> None:
        self._name = os.fspath(file)
        if not os.path.exists(self._name):
            raise NoSuchFile.named(self._name)
        self._open: Optional[_rehearse.Trace]
        if topics is None:
            self._open = _rehearse.Trace(self._name, tolerate)
        else:
            self._open = self._part([topics] if isinstance(topics, str) else list(topics))
        self._names: List[str] = self._file.names

    @property
    def _file(self) -> _rehearse.Trace:
        if self._open is None:
            raise Error.saying("the trace is closed", "read it before close(), or in the with statement", self._name)
        return self._open

    def close(self) -> None:
        """Closes the file. Arrays that were read stay; everything else raises ``rehearse.Error`` from then on."""
        self._open = None

    def __enter__(self) -> "Trace":
        return self

    def __exit__(self, *ending: object) -> None:
        self.close()

    def _part(self, topics: List[str]) -> _rehearse.Trace:
        with tempfile.TemporaryDirectory(prefix="rehearse-") as folder:
            part = os.path.join(folder, os.path.basename(os.path.normpath(self._name)) + ".part.mcap")
            _rehearse.select(self._name, part, topics)
            return _rehearse.Trace(part, False)  # it keeps the file open

    @property
    def file(self) -> str:
        """The path, as it was given."""
        return self._name

    @property
    def duration(self) -> float:
        """From the first message to the last [s]."""
        return self._file.duration

    @property
    def ticks(self) -> int:
        """The number of recorded ticks; 0: the log is no recording of Rehearse."""
        return self._file.ticks

    @property
    def damage(self) -> List[str]:
        """What could not be read, a sentence each."""
        return self._file.damage

    def __getitem__(self, name: str) -> Any:
        """The numbers of a series: float64, or int64, uint64 or bool as the message has them. Of a name with ``*`` a dict."""
        if isinstance(name, str) and "*" in name:
            return {one: self._file.values(one) for one in self._matching(name)}
        return self._file.values(name)

    def _matching(self, *patterns: str) -> List[str]:
        """The series of these names, of which * stands for any text, in the order of the recording."""
        wanted = []
        for pattern in patterns:
            form = re.compile(".*".join(re.escape(part) for part in pattern.split("*")), re.DOTALL)
            found = [name for name in self._names if form.fullmatch(name)]
            if not found:
                known = ", ".join(self._names[:8]) or "none"
                raise UnknownName.saying(f"no series matches '{pattern}'", f"there is: {known}", self._name)
            wanted += found
        return [name for name in self._names if name in set(wanted)]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._file.has(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def time(self) -> np.ndarray:
        """Time of each tick [s]. A log without ticks has none: see ``times``."""
        if not self._file.has("tick"):
            raise Error.saying("it has no ticks", "trace.times(NAME) is the time of a series", self.file)
        return self.times("tick")

    def times(self, name: str) -> np.ndarray:
        """Time of each number of a series [s], float64."""
        return self._file.stamps(name) * _nanosecond

    def stamps(self, name: str) -> np.ndarray:
        """The same as recorded [ns], uint64."""
        return self._file.stamps(name)

    @property
    def units(self) -> _Lookup:
        """The unit of each series, as "rad"; empty: it states none."""
        return _Lookup("series", self._names, self._file.unit)

    def at(self, time: float) -> Moment:
        """The recording at that time [s]: at the last tick at or before it, where there are ticks."""
        stamp = round(time / _nanosecond)
        if self._file.has("tick"):
            stamps = self._file.stamps("tick")
            place = int(np.searchsorted(stamps, np.uint64(max(stamp, 0)), side="right")) - 1
            if stamp < 0 or place < 0 or time > stamps[-1] * _nanosecond + 0.5 * _nanosecond:
                raise Error.saying(f"it has no tick at {time} s",
                                   f"it lasts from {stamps[0] * _nanosecond:g} to {stamps[-1] * _nanosecond:g} s", self.file)
            stamp = int(stamps[place])
        return Moment(self, stamp)

    @property
    def images(self) -> _Lookup:
        """The pictures of each camera, as ``trace.images["SR1/Eye"][3]``; of a depth camera "SR1/Eye/depth"."""
        topics = {topic[1:-len("/image")] if topic.endswith("/image") else topic.lstrip("/"): topic
                  for topic in self._file.picture_topics}
        return _Lookup("camera", list(topics), lambda name: Pictures(self._file, topics[name]))

    @property
    def events(self) -> List[Dict[str, Any]]:
        """Messages of controllers and of the run: time [s], tick, severity, source and text."""
        return self._file.events

    @property
    def contacts(self) -> List[Dict[str, Any]]:
        """Contacts that begin or end: time [s], tick, link, other and begins."""
        return self._file.contacts

    @property
    def metadata(self) -> Dict[str, Dict[str, str]]:
        """The records of metadata, as ``trace.metadata["rehearse"]["scenario"]``."""
        return self._file.metadata

    @property
    def attachments(self) -> Dict[str, bytes]:
        """The attached files, as ``trace.attachments["scenario.yaml"]``."""
        return self._file.attachments

    @property
    def topics(self) -> Dict[str, str]:
        """The type of the messages of each topic."""
        return dict(self._file.topics)

    def to_pandas(self, *patterns: str) -> "pandas.DataFrame":
        """A table of series, by default of all: a row for each tick, the time [s] as its index.

        A series that isn't of every tick has its last value at or before each; before its first one NaN. A log without
        ticks has a row for each time of these series. ``attrs["units"]`` has the units.
        """
        pandas = _optional("pandas", "to_pandas()")
        names = self._matching(*(patterns or ("*",)))
        rows, columns = self._aligned(names)
        table = pandas.DataFrame(columns, index=pandas.Index(rows, name="time"))
        table.attrs["units"] = {name: self._file.unit(name) for name in names}
        return table

    def _aligned(self, names: List[str]) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
        """The times of rows [s], and a column of each series, as to_pandas() has them."""
        if self._file.has("tick"):
            rows = self._file.stamps("tick")
        else:
            rows = np.unique(np.concatenate([self._file.stamps(name) for name in names]))
        columns = {}
        for name in names:
            values, places = self._file.values(name), np.searchsorted(self._file.stamps(name), rows, side="right") - 1
            if len(values) == 0 or places.min(initial=0) < 0:
                column = np.full(len(rows), np.nan)
                column[places >= 0] = values[places[places >= 0]]
            else:
                column = values[places]
            columns[name] = column
        return rows * _nanosecond, columns

    def plot(self, *patterns: str, golden: Union["Trace", str, "os.PathLike[str]", None] = None, axes: Optional["Axes"] = None) -> "Axes":
        """Draws series over time with matplotlib, those of a golden dashed beside them. Returns the axes."""
        axes = _optional("matplotlib.pyplot", "plot()").subplots()[1] if axes is None else axes
        other = Trace(golden) if golden is not None and not isinstance(golden, Trace) else golden
        names = self._matching(*patterns)
        for name in names:
            line, = axes.plot(self.times(name), self._file.values(name), label=name)
            if other is not None and name in other:
                axes.plot(other.times(name), other[name], "--", color=line.get_color(), label=f"{name}, golden")
        units = {self._file.unit(name) for name in names}
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"[{units.pop()}]" if len(units) == 1 and "" not in units else "")
        axes.legend()
        return axes

    def __repr__(self) -> str:
        if self._open is None:
            return f"<Trace {self.file}: closed>"
        return f"<Trace {self.file}: {len(self)} series, {self.duration:g} s>"

    def _repr_html_(self) -> str:
        if self._open is None:
            return html.escape(repr(self))
        shown = [name for name in self._names if self._file.unit(name)][:12] or self._names[:12]
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(self._file.unit(name))}</td>"
                       f"<td>{_curve(self._file.values(name))}</td></tr>" for name in shown)
        more = f"<p>and {len(self) - len(shown)} more series</p>" if len(self) > len(shown) else ""
        return (f"<p><b>{html.escape(self.file)}</b>: {self.ticks} ticks, {self.duration:g} s</p>"
                f"<table><tr><th>series</th><th>unit</th><th></th></tr>{rows}</table>{more}")
