"""Recordings as arrays."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Callable, Dict, Iterator, List, Union

import numpy as np

from . import _rehearse
from ._errors import Error, UnknownName

_nanosecond = 1e-9  # [s]


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
    distances along the optical axis [m].
    """

    def __init__(self, trace: _rehearse.Trace, topic: str) -> None:
        self._trace, self.topic = trace, topic

    @property
    def time(self) -> np.ndarray:
        """Time of each picture [s]."""
        return self._trace.channel_stamps(self.topic) * _nanosecond

    def __len__(self) -> int:
        return len(self._trace.channel_stamps(self.topic))

    def __getitem__(self, index: int) -> np.ndarray:  # type: ignore[override]
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"{self.topic} has {count} pictures, no number {index}")
        return self._trace.picture(self.topic, index % count)


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
    ``rehearse.Error``.
    """

    def __init__(self, file: Union[str, "os.PathLike[str]"], topics: Union[str, Sequence[str], None] = None,
                 tolerate: bool = False) -> None:
        self._name = os.fspath(file)
        if topics is None:
            self._file = _rehearse.Trace(self._name, tolerate)
        else:
            self._file = self._part([topics] if isinstance(topics, str) else list(topics))
        self._names: List[str] = self._file.names

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

    def __getitem__(self, name: str) -> np.ndarray:
        """The numbers of a series: float64, or int64, uint64 or bool as the message has them."""
        return self._file.values(name)

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

    def __repr__(self) -> str:
        return f"<Trace {self.file}: {len(self)} series, {self.duration:g} s>"
