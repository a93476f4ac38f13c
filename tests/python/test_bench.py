"""rehearse.ControllerBench, driven by hand and by hypothesis."""

import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies

import rehearse
from controllers import hold
from conftest import root

ARM = root / "tools/new_project/models/arm.urdf"
SR1 = root / "fixtures/models/sr1.urdf"


def test_it_says_once_which_guards_are_off():
    hold()
    program = f"import rehearse; [rehearse.ControllerBench('hold.py:Hold', '{ARM}') for _ in range(2)]"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stderr
    assert said.count("guards are off") == 1 and "mathematics isn't pinned" in said


def test_a_controller_in_python_pulls_back_with_its_stiffness():
    hold()
    bench = rehearse.ControllerBench("hold.py:Hold", ARM)
    bench["SHOULDER"].q = 0.1
    assert bench.tick()
    assert bench["SHOULDER"].u == pytest.approx(-6.0, abs=1e-12)
    assert bench.ticks == 1 and bench.time == pytest.approx(0.001)


def test_a_controller_in_cpp_is_the_same_bench():
    bench = rehearse.ControllerBench("SR1MinimumController", SR1)
    before = [bench[f"{side}LEG_KNEE"].u for side in "RL"]
    bench["RLEG_KNEE"].q = 0.05
    bench.tick()
    assert bench["RLEG_KNEE"].u < -1.0 and before == [0.0, 0.0]


def test_each_bench_has_its_own_controller():
    hold()
    one, other = (rehearse.ControllerBench("hold.py:Hold", ARM) for _ in range(2))
    one["SHOULDER"].q = 0.1
    one.tick()
    other.tick()
    assert other["SHOULDER"].u == 0.0


def test_an_exception_is_an_error_with_its_line():
    hold("raise RuntimeError('no power')")
    bench = rehearse.ControllerBench("hold.py:Hold", ARM)
    with pytest.raises(rehearse.Error, match=r"RuntimeError: no power \(hold.py:14 in control\)"):
        bench.tick()


def test_names_that_are_not_there_are_named():
    hold()
    bench = rehearse.ControllerBench("hold.py:Hold", ARM)
    with pytest.raises(rehearse.UnknownName, match="SHOULDER"):
        bench["ELBOW"]
    with pytest.raises(rehearse.Error, match="not found"):
        rehearse.ControllerBench("gone.py:Hold", ARM)


def test_variables_and_messages_can_be_read():
    hold("self.io.variable('phase', 0.5); print('hello')")
    bench = rehearse.ControllerBench("hold.py:Hold", ARM)
    bench.tick()
    assert bench.variable("phase") == 0.5
    with pytest.raises(rehearse.UnknownName):
        bench.variable("age")


@settings(deadline=None, max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(q=strategies.floats(-3.0, 3.0), dq=strategies.floats(-20.0, 20.0))
def test_the_command_opposes_the_motion(q, dq):
    """Whatever the arm does, the power of the damping is not positive."""
    bench = held()
    bench["SHOULDER"].q, bench["SHOULDER"].dq = q, 0.0
    bench.tick()
    stiffness = bench["SHOULDER"].u
    bench["SHOULDER"].q, bench["SHOULDER"].dq = q, dq
    bench.tick()
    assert (bench["SHOULDER"].u - stiffness) * dq <= 0.0


_held = []


def held():
    if not _held:
        hold(file="hold_for_hypothesis.py")
        _held.append(rehearse.ControllerBench(str(Path.cwd() / "hold_for_hypothesis.py:Hold"), ARM))
    return _held[0]
