"""A tap: what a robot's loop reads and commands, recorded from inside the loop."""

from __future__ import annotations

import os
import time
from types import TracebackType
from typing import Any, Optional, Sequence, Type, Union

from . import _loop
from ._errors import Error

_QUANTITIES = {"q": 1, "dq": 2, "u": 4}
_RECORDERS = {None: 0, "all": 1, "black box": 2}


class _Tick:
    """Ends a tick at the end of its block."""

    def __init__(self, loop: Any) -> None:
        self._loop = loop

    def __enter__(self) -> None:
        pass

    def __exit__(self, *failed: Any) -> None:
        self._loop.end()


class Tap:
    """Records a robot's loop, tick by tick, into a ring in shared memory. ``rehearse tap NAME`` makes a recording of it.

    model: the robot's URDF or .body file, which the recording contains; None: none. controller: its name in the recording;
    empty: that of the tap. time_step: of the loop [s]. seconds: of a black box. megabytes: of the ring. replace: a ring that
    an ended process left over is kept aside. spawn: starts a recorder that writes into ``output``: "all", or "black box", which
    keeps the last seconds; None: none.

    Series are stated before the first tick, with the model's names. A tap is used by one thread. Raises rehearse.Error if the
    tap can't be opened, or a series is wrong. In a tick a wrong type raises TypeError; other wrong calls return False, and the
    recorder counts them.
    """

    def __init__(self, name: str, *, model: Union[None, str, "os.PathLike[str]"] = None, controller: str = "",
                 time_step: float = 0.001, seconds: float = 60.0, megabytes: int = 64, replace: bool = False,
                 spawn: Optional[str] = None, output: Union[None, str, "os.PathLike[str]"] = None) -> None:
        if spawn not in _RECORDERS:
            raise Error.saying(f"spawn is {spawn!r}", "expected None, 'all' or 'black box'")
        self._loop = self._told(_loop.Loop, name, os.fspath(model or ""), controller, time_step, seconds, megabytes,
                                replace, _RECORDERS[spawn], os.fspath(output or ""))
        self._tick = _Tick(self._loop)

    @staticmethod
    def _told(function: Any, *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except RuntimeError as failed:
            raise Error.saying(str(failed)) from None

    def _quantities(self, words: str) -> int:
        unknown = [word for word in words.split() if word not in _QUANTITIES]
        if unknown or not words.split():
            raise Error.saying(f"the quantities are {words!r}", "expected words of 'q dq u'")
        return sum({_QUANTITIES[word] for word in words.split()})

    def joints(self, body: str, names: Sequence[str], quantities: str) -> int:
        """What the loop reads of these joints: "q" [rad or m], "dq", "u" [N·m or N]. Returns the series' number.

        The numbers of a tick are all q, then all dq, then all u, in the order of ``names``.
        """
        return self._told(self._loop.joints, body, list(names), self._quantities(quantities), False)

    def commands(self, body: str, names: Sequence[str], quantities: str) -> int:
        """What the loop commands to these joints, in the order of joints()."""
        return self._told(self._loop.joints, body, list(names), self._quantities(quantities), True)

    def imu(self, body: str, device: str) -> int:
        """An IMU: angular velocity x, y, z [rad/s], then linear acceleration [m/s²]."""
        return self._told(self._loop.imu, body, device)

    def device(self, body: str, device: str, count: int) -> int:
        """Another device of the model, with so many numbers."""
        return self._told(self._loop.device, body, device, count)

    def parameter(self, key: str, value: object) -> None:
        """A parameter of the run, as a gain or a file's hash: metadata of the recording."""
        self._told(self._loop.parameter, key, str(value))

    def tick(self, now: Optional[int] = None) -> _Tick:
        """Begins a tick, which ends with its block. now: the loop's clock [ns]; None: time.monotonic_ns()."""
        self._loop.begin(time.monotonic_ns() if now is None else now)
        return self._tick

    def write(self, series: int, numbers: Any) -> bool:
        """The numbers of a series in this tick: a contiguous float64 array, which is read in place. False: too many or few."""
        return self._loop.write(series, numbers)

    def absent(self, series: int) -> bool:
        """States that an input has no new numbers in this tick."""
        return self._loop.absent(series)

    def variable(self, name: str, value: float) -> bool:
        """A variable of the controller in this tick."""
        return self._loop.variable(name, value)

    def text(self, line: str) -> bool:
        """A line of text in this tick."""
        return self._loop.text(line)

    def image(self, camera: str, picture: str) -> bool:
        """The name under which the loop stores a camera's picture of this tick."""
        return self._loop.image(camera, picture)

    def mark(self, reason: str) -> None:
        """Asks a black box to keep its last seconds."""
        self._loop.mark(reason)

    @property
    def dropped(self) -> int:
        """The number of ticks that are in no recording."""
        return self._loop.dropped()

    def close(self) -> None:
        """Ends the tap. A later call does nothing."""
        self._loop.close()

    def __enter__(self) -> "Tap":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 traceback: Optional[TracebackType]) -> None:
        """An exception is a mark: a black box keeps the seconds before it."""
        if kind is not None:
            self.mark(f"{kind.__name__}: {error}")
        self.close()
