"""rehearse.Tap: a loop in Python, its recording, and the replay of a controller in Python with the same step."""

import os
import subprocess
import time
from pathlib import Path

import numpy
import pytest

import rehearse

MODEL = """<robot name="Arm"><link name="BASE"/>
<link name="UPPER"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="SHOULDER" type="revolute"><parent link="BASE"/><child link="UPPER"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="100" velocity="10"/></joint></robot>"""
STEP = """import math
import rehearse


class Step:
    def __init__(self):
        self.integral = 0.0

    def __call__(self, q, dq):
        self.integral += 1e-3 * q
        return -GAIN * q - 2.0 * dq - self.integral + 0.1 * math.sin(q)


class Hold(rehearse.Controller):
    def initialize(self, io):
        self.joint = io.joint("SHOULDER")
        self.joint.read("q", "dq")
        self.joint.command("u")
        self.step = Step()

    def control(self):
        self.joint.u = self.step(self.joint.q, self.joint.dq)
"""


@pytest.fixture
def name():
    """A name that no other test uses; its ring is removed."""
    name = f"python-{os.getpid()}"
    ring = Path(f"/dev/shm/rehearse-tap-{os.geteuid()}-{name}")
    ring.unlink(missing_ok=True)
    yield name
    ring.unlink(missing_ok=True)


def recover(name, file="flight.mcap"):
    return subprocess.run([rehearse.command(), "tap", name, "--recover", "-o", file], check=True, capture_output=True, text=True)


def step_of(gain):
    text = STEP.replace("GAIN", str(gain))
    Path("hold.py").write_text(text)
    scope = {}
    exec(text, scope)
    return scope["Step"]()


def test_a_loop_replays_bit_for_bit(name):
    Path("arm.urdf").write_text(MODEL)
    step = step_of(40.0)
    numbers, effort = numpy.zeros(2), numpy.zeros(1)
    with rehearse.Tap(name, model="arm.urdf", controller="Hold", megabytes=1) as tap:
        q_dq, u = tap.joints("Arm", ["SHOULDER"], "q dq"), tap.commands("Arm", ["SHOULDER"], "u")
        tap.parameter("gain", 40.0)
        for i in range(500):
            with tap.tick(1_000_000 * i):
                numbers[:] = 0.3 * numpy.cos(1e-2 * i), 0.1 * numpy.sin(1e-2 * i)
                assert tap.write(q_dq, numbers)
                effort[0] = step(*numbers)
                assert tap.write(u, effort)
                assert tap.variable("integral", step.integral)
        assert tap.dropped == 0
    recover(name)
    trace = rehearse.Trace("flight.mcap")
    assert len(trace["Arm/SHOULDER/q"]) == 500
    assert trace["Arm/Hold/output/SHOULDER/u"][-1] == effort[0]
    equal = rehearse.replay("flight.mcap", controllers={"Hold": "hold.py:Hold"})
    assert equal.equal, equal.verdict
    step_of(40.4)
    changed = rehearse.replay("flight.mcap", controllers={"Hold": "hold.py:Hold"})
    assert not changed.equal and changed.first.tick == 0


def test_arrays_are_read_in_place(name):
    with rehearse.Tap(name, megabytes=1) as tap:
        q = tap.joints("Arm", ["SHOULDER", "ELBOW"], "q")
        with tap.tick():
            assert not tap.write(q, numpy.zeros(3))
            for wrong in ([0.0, 1.0], numpy.zeros(2, dtype=numpy.float32), numpy.zeros((2, 2))[:, 0]):
                with pytest.raises(TypeError):
                    tap.write(q, wrong)
            assert tap.write(q, numpy.array([1.0, 2.0]))
            assert tap.text("a line") and tap.image("Camera", "1.png") and not tap.text("")
    assert "2 calls of the loop broke a rule" in recover(name).stdout


def test_mistakes_are_told(name):
    with pytest.raises(rehearse.Error, match="letters, digits"):
        rehearse.Tap("a/b")
    with pytest.raises(rehearse.Error, match="spawn is 'some'"):
        rehearse.Tap(name, spawn="some")
    with rehearse.Tap(name, megabytes=1) as tap:
        with pytest.raises(rehearse.Error, match="quantities are 'q v'"):
            tap.joints("Arm", ["SHOULDER"], "q v")
        with pytest.raises(rehearse.Error, match="already"):
            rehearse.Tap(name)


def test_an_exception_is_a_mark(name):
    with pytest.raises(ZeroDivisionError):
        with rehearse.Tap(name, megabytes=1) as tap:
            u = tap.commands("Arm", ["SHOULDER"], "u")
            with tap.tick():
                tap.write(u, numpy.array([1.0 / 0]))
    recover(name)
    shown = subprocess.run([rehearse.command(), "cat", "flight.mcap", "--topics", "/events"], check=True, capture_output=True, text=True)
    assert "mark: ZeroDivisionError: " in shown.stdout


def test_a_tick_is_short(name):
    numbers = numpy.zeros(24)
    with rehearse.Tap(name, megabytes=1) as tap:
        q_dq = tap.joints("Arm", [f"J{i}" for i in range(12)], "q dq")
        begin = time.perf_counter()
        for _ in range(10_000):
            with tap.tick(0):
                tap.write(q_dq, numbers)
        assert (time.perf_counter() - begin) / 10_000 < 100e-6
