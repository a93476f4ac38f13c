import pytest
import rehearse
from rehearse.testing import assert_matches_golden, assert_replays

START = -0.785398  # [rad]


def test_comes_back_after_a_push(golden):
    trace = golden.record("scenarios/hold.yaml")
    assert trace["Arm/SHOULDER/q"].min() < START - 0.05  # it was pushed [rad]
    golden.assert_holds(trace)  # the scenario's expectations
    assert_matches_golden(trace)


def test_repeats_its_commands_without_physics():
    assert_replays("Hold.ComesBackAfterAPush")


def test_pulls_back_with_the_stiffness():
    bench = rehearse.ControllerBench("hold.py:Hold", "models/arm.urdf")
    bench["SHOULDER"].q = 0.1  # [rad]; it started at 0
    bench.tick()
    assert bench["SHOULDER"].u == pytest.approx(-6.0, abs=1e-12)  # [N·m]
