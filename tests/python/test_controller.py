"""Controllers in Python: recorded, replayed and audited as others; failures with their tick; files in the proof."""

import json
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

import rehearse
from controllers import hold, scenario
from conftest import root

ARM = root / "tools/new_project/models/arm.urdf"


def command(*words, status=0):
    ended = subprocess.run([rehearse.command(), *map(str, words)], capture_output=True, text=True)
    assert ended.returncode == status, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


def test_it_is_recorded_and_repeats_its_commands_without_physics():
    hold("print('tick', tick, end='!\\n') if tick == 3 else None")
    run = rehearse.record(scenario(ARM), "hold.mcap")
    assert run.failure is None and run.ticks == 200
    trace = rehearse.Trace("hold.mcap")
    u = trace["Arm/Hold/output/SHOULDER/u"]
    assert len(u) == 200 and np.ptp(u) > 0.1
    assert [(event["tick"], event["text"]) for event in trace.events] == [(3, "tick 3!")]
    assert rehearse.replay("hold.mcap").equal


def test_two_recordings_have_the_same_bytes():
    hold("self.target = -0.7 + 1e-3 * (hash('a') % 7) + 1e-2 * 'xyz'.index(next(iter({'x', 'y', 'z'})))")
    rehearse.record(scenario(ARM), "a.mcap")
    rehearse.record(scenario(ARM), "b.mcap")
    assert Path("a.mcap").read_bytes() == Path("b.mcap").read_bytes()


def test_an_exception_is_a_failure_with_its_tick_its_line_and_its_traceback():
    hold("assert tick != 50, 'the battery is empty'")
    run = rehearse.record(scenario(ARM), "hold.mcap")
    assert run.status == 3
    assert "AssertionError: the battery is empty (hold.py:14 in control) in control() at tick 50" in run.failure.message
    trace = rehearse.Trace("hold.mcap")
    assert trace.ticks == 51
    said = "\n".join(event["text"] for event in trace.events)
    assert "Traceback (most recent call last):" in said and "assert tick != 50" in said


def test_a_refusal_says_why():
    hold("pass")
    text = Path("hold.py").read_text().replace('io.joint("SHOULDER")', 'io.joint("ELBOW")')
    Path("hold.py").write_text(text)
    said = command("record", scenario(ARM), status=3)
    assert "the robot has no joint 'ELBOW'; it has SHOULDER" in said and "hold.py:7 in initialize" in said


def test_a_hang_leaves_all_its_ticks():
    hold("while tick == 50: pass")
    begin = time.monotonic()
    run = rehearse.record(scenario(ARM), "hold.mcap", call_limit=1.0)
    assert run.status == 3 and time.monotonic() - begin < 30.0
    assert "tick 50" in run.failure.message
    assert rehearse.Trace("hold.mcap").ticks == 51


def test_endless_allocation_leaves_all_its_ticks():
    hold("self.kept = []\n        while tick == 50: self.kept.append(b'x' * (1 << 24))")
    with pytest.raises(rehearse.Error, match="'Arm/Hold' took more than 1500 MB of memory in control.. at tick 50"):
        rehearse.record(scenario(ARM), "hold.mcap", memory_limit=1500, call_limit=60.0)
    assert rehearse.Trace("hold.mcap").ticks == 51


@pytest.mark.parametrize("text, line, message", [
    ("import rehearse\nclass Hold(rehearse.Controller):\n    x = (\n", 3, "SyntaxError: '(' was never closed"),
    ("import rehearse\n\nimport no_such_module\n", 3, "ModuleNotFoundError: No module named 'no_such_module'"),
    ("import rehearse\nclass Held(rehearse.Controller): pass\n", 0, "it has no class 'Hold'; it has Held"),
    ("class Hold: pass\n", 0, "'Hold' is no class that inherits rehearse.Controller"),
])
def test_a_file_that_is_no_controller_is_an_error_with_its_place(text, line, message):
    Path("hold.py").write_text(text)
    with pytest.raises(rehearse.Error) as raised:
        rehearse.record(scenario(ARM))
    assert message in raised.value.message
    if line:
        assert raised.value.file.endswith("hold.py") and raised.value.line == line


@pytest.mark.parametrize("library, message", [
    ("hold.py", "names no class"), ("other.py:Hold", "'other.py:Hold' not found")])
def test_a_name_that_cannot_be_used_says_why(library, message):
    hold()
    with pytest.raises(rehearse.Error, match=message):
        rehearse.record(scenario(ARM, library))


def test_modules_beside_the_file_are_part_of_what_was_recorded():
    Path("gains.py").write_text("stiffness = 1.0\n")
    hold("import gains; self.target = -0.7 * gains.stiffness")
    rehearse.record(scenario(ARM), "hold.mcap")
    before = rehearse.Trace("hold.mcap").metadata["rehearse"]["controller.Arm/Hold"]
    Path("unused.py").write_text("another = 1\n")
    rehearse.record("hold.yaml", "again.mcap")
    assert rehearse.Trace("again.mcap").metadata["rehearse"]["controller.Arm/Hold"] == before
    Path("gains.py").write_text("stiffness = 1.1\n")
    rehearse.record("hold.yaml", "other.mcap")
    assert rehearse.Trace("other.mcap").metadata["rehearse"]["controller.Arm/Hold"] != before
    changed = rehearse.replay("hold.mcap")
    assert changed.status == 1


def test_the_environment_and_the_threads_of_numpy_are_pinned(monkeypatch):
    monkeypatch.setenv("PYTHONHASHSEED", "7")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    monkeypatch.setenv("PYTHONPATH", str(Path.cwd() / "elsewhere"))
    Path("elsewhere").mkdir()
    Path("elsewhere/intruder.py").write_text("")
    hold("import sys, os, threading; print(sys.flags.hash_randomization, [p for p in sys.path if 'elsewhere' in p], "
         "len(os.listdir('/proc/self/task'))) if tick == 0 else None")
    rehearse.record(scenario(ARM, duration=0.01), "hold.mcap")
    said = [event["text"] for event in rehearse.Trace("hold.mcap").events]
    assert any(text.startswith(("0 []", "1 []")) for text in said), said
    hold("print(hash('a')) if tick == 0 else None")
    rehearse.record("hold.yaml", "a.mcap")
    monkeypatch.setenv("PYTHONHASHSEED", "8")
    rehearse.record("hold.yaml", "b.mcap")
    assert Path("a.mcap").read_bytes() == Path("b.mcap").read_bytes()


def test_arrays_of_a_device_and_of_a_link_are_numpy(fixtures):
    Path("look.py").write_text('''import rehearse


class Look(rehearse.Controller):
    def initialize(self, io):
        self.io, self.link = io, io.links[0]
        self.link.read("pose")
        self.devices = io.devices
        for device in self.devices:
            device.read()

    def control(self):
        if self.io.time > 0.05 and not hasattr(self, "told"):
            self.told = True
            print(self.link.pose.shape, sorted({(d.type, d.numbers.dtype.name) for d in self.devices}))
            print([d.image.shape for d in self.devices if d.type == "Camera" and d.image is not None])
''')
    text = (fixtures / "scenarios/room.yaml").read_text()
    text = text.replace("../models", str(fixtures / "models")).replace("library: ScoutController", "library: look.py:Look")
    text = text[:text.index("\nexpect:")] if "\nexpect:" in text else text
    Path("room.yaml").write_text("\n".join(line for line in text.splitlines() if not line.startswith("golden:")))
    run = rehearse.record("room.yaml", "room.mcap", duration=0.2)
    assert run.failure is None, run.failure
    said = [event["text"] for event in rehearse.Trace("room.mcap").events]
    assert any(text.startswith("(7,) [('") and "float64" in text for text in said), said


def test_it_is_audited():
    hold()
    rehearse.record(scenario(ARM, duration=0.05), "hold.mcap")
    said = command("audit", "hold.mcap")
    assert "Arm/Hold gave the same 50 commands, bit for bit" in said
    hold("import time; self.target = (time.time_ns() % 1000) * 1e-3")
    rehearse.record(scenario(ARM, duration=0.05), "clock.mcap")
    said = command("audit", "clock.mcap", status=1)
    assert "Arm/Hold" in said and "clock" in said


def test_texts_are_utf_8_whatever_the_locale(monkeypatch):
    monkeypatch.setenv("LC_ALL", "C")
    Path("unit.txt").write_text("µm", encoding="utf-8")
    hold("print(open('unit.txt').read()) if tick == 0 else None")
    rehearse.record(scenario(ARM, duration=0.01), "hold.mcap")
    assert [event["text"] for event in rehearse.Trace("hold.mcap").events] == ["µm"]
