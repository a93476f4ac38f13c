"""A controller without physics: a test sets its inputs, makes a tick, and reads its commands."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Sequence, Union

from . import _bench


class ControllerBench:
    """A controller and a robot whose inputs are set by hand.

    library: a controller's name or path, as in a scenario (also "hold.py:Hold"). model: a URDF or .body file. time_step
    [s]. options: the controller's. joints: displacements at the beginning [rad or m]. position: of the root link [m].

    A value that isn't set stays. Nothing moves by itself: commands move nothing. The controller sees what it reads in
    initialize(), which runs in the constructor. Raises rehearse.Error if the controller can't be loaded, refuses, raises or
    hangs; rehearse.UnknownName for a joint, link, device or variable that isn't there.

    It runs in this process, which isn't pinned, and whose first bench prints which guards are off. The last bits of sin, exp
    and so on may depend on the processor. rehearse.record() runs a controller with all guards.
    """

    def __init__(self, library: Union[str, "os.PathLike[str]"], model: Union[str, "os.PathLike[str]"], *,
                 time_step: float = 0.001, options: str = "", joints: Mapping[str, float] = {},
                 position: Sequence[float] = (0.0, 0.0, 0.0), joystick: bool = True) -> None:
        self._bench = _bench.Bench(os.fspath(library), os.fspath(model), time_step, options, dict(joints), position, joystick)

    def __getitem__(self, joint: str) -> Any:
        """A joint: set q, dq [rad and s, or m], ddq and u before a tick; read u, q_target and dq_target after it."""
        return self._bench.joint(joint)

    def link(self, name: str) -> Any:
        """A link in the world: position [m], rotation (x y z w), velocity, ...; commanded force [N] and torque [N·m]."""
        return self._bench.link(name)

    def device(self, name: str) -> Any:
        """A sensor: ``values`` are its reading, as force [N] and torque [N·m]; empty: no measurement."""
        return self._bench.device(name)

    def set_axis(self, name: str, value: float) -> None:
        """An axis of the joystick, -1 to 1, up and left negative."""
        self._bench.set_axis(name, value)

    def set_button(self, name: str, pressed: bool) -> None:
        """A button of the joystick."""
        self._bench.set_button(name, pressed)

    def update_links(self) -> None:
        """Computes the poses of all links from the root link and the joints' q, at rest."""
        self._bench.update_links()

    def tick(self, count: int = 1) -> bool:
        """Calls control() and advances the time by a step, `count` times. Returns the last result of control()."""
        result = True
        for _ in range(count):
            result = self._bench.tick()
        return result

    @property
    def time(self) -> float:
        """The time in the next tick [s]."""
        return self._bench.time

    @property
    def ticks(self) -> int:
        """The number of ticks so far."""
        return self._bench.ticks

    def variable(self, name: str) -> float:
        """The last value that the controller set by io.variable() or rehearse_variable()."""
        return self._bench.variable(name)

    @property
    def messages(self) -> List[str]:
        """What the controller wrote, and remarks about it."""
        return self._bench.messages
