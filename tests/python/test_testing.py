"""rehearse.testing: the goldens of pytest are those of GoogleTest."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import rehearse
from controllers import hold, scenario
from conftest import root

ARM = root / "tools/new_project/models/arm.urdf"
EXPECTATIONS = """expect:
  - {channel: Arm/SHOULDER/q, below: 0, above: -90 deg}
"""
TESTS = """from rehearse.testing import assert_matches_golden, assert_replays


def test_sags_a_little(golden):
    trace = golden.record("hold.yaml")
    assert trace["Arm/SHOULDER/q"][0] < -0.78
    golden.assert_holds(trace)
    assert_matches_golden(trace)


def test_repeats_its_commands():
    assert_replays("Hold.SagsALittle")
"""


@pytest.fixture
def project():
    hold()
    scenario(ARM)
    with open("hold.yaml", "a") as file:
        file.write(EXPECTATIONS)
    Path("test_hold.py").write_text(TESTS)
    Path("conftest.py").write_text('pytest_plugins = ["rehearse.testing"]\n')
    Path("pytest.ini").write_text("[pytest]\n")
    return Path.cwd()


def run_pytest(status, mode=None, *words):
    environment = {**os.environ, **({"REHEARSE_GOLDEN": mode} if mode else {})}
    ended = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:hypothesispytest", *words],
                           capture_output=True, text=True, env=environment)
    assert ended.returncode == status, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


def weaken(project):
    file = project / "hold.py"
    file.write_text(file.read_text().replace("60.0 *", "59.0 *"))


def test_a_golden_is_made_and_met(project):
    assert "there is no golden" in run_pytest(1).lower() or not (project / "golden").exists()
    run_pytest(0, "new")
    assert (project / "golden/Hold.SagsALittle.mcap").is_file() and (project / "golden/Hold.SagsALittle.txt").is_file()
    assert "2 passed" in run_pytest(0)


# Each changes the process of a run, and what it commands depends on that.
RUN_STATE = {
    "a counter": "import builtins; builtins.ticks = getattr(builtins, 'ticks', 0) + 1; self.target = -0.78 - 1e-3 * builtins.ticks",
    "rand()": "import ctypes; self.target = -0.78 - 1e-12 * ctypes.CDLL(None).rand()",
}


@pytest.mark.parametrize("state", RUN_STATE.values(), ids=RUN_STATE)
def test_each_run_begins_in_a_process_that_has_run_no_controller(project, state, monkeypatch):
    hold(state)
    run_pytest(0, "new")
    assert "2 passed" in run_pytest(0)
    monkeypatch.setenv("REHEARSE_PROOF", "off")
    assert "2 passed" in run_pytest(0)


def test_a_change_is_blamed_on_the_controller(project):
    run_pytest(0, "new")
    weaken(project)
    said = run_pytest(1)
    assert "the controller changed: fed with the golden's inputs, SHOULDER/u" in said and "2 failed" in said
    assert "Traceback" not in said
    assert (project / "rehearse-pending/Hold.SagsALittle.mcap").is_file()
    run_pytest(0, "accept")
    assert "2 passed" in run_pytest(0)


def test_an_expectation_that_is_violated_fails(project):
    run_pytest(0, "new")
    text = Path("hold.yaml").read_text().replace("below: 0", "below: -80 deg")
    Path("hold.yaml").write_text(text)
    said = run_pytest(1)
    assert "Arm/SHOULDER/q" in said and "hold.yaml" in said


def test_tolerances_of_a_test(project):
    run_pytest(0, "new")
    weaken(project)
    tests = Path("test_hold.py").read_text()
    loose = tests.replace("assert_matches_golden(trace)", "assert_matches_golden(trace, near={'*': 10.0})")
    Path("test_hold.py").write_text(loose)
    assert "1 failed, 1 passed" in run_pytest(1)  # the replay compares bits
    Path("test_hold.py").write_text(tests.replace("assert_matches_golden(trace)", "assert_matches_golden(trace, exact=True)"))
    assert "2 failed" in run_pytest(1)
    Path("test_hold.py").write_text(tests.replace("assert_matches_golden(trace)", "assert_matches_golden(trace, near={'Leg/*': 1.0})"))
    assert 'the run has no such series' in run_pytest(1)


def test_a_controller_that_raises_fails_its_test_with_the_sentence(project):
    hold("assert tick < 5, 'stop here'")
    said = run_pytest(1)
    assert "AssertionError: stop here (hold.py:14 in control) in control() at tick 5" in said


def test_a_process_that_ends_is_no_riddle(project):
    hold("import os; tick < 5 or os._exit(7)")
    said = run_pytest(1)
    assert "Hold" in said and "tick 5" in said


def test_names_are_those_of_googletest(project):
    Path("test_names.py").write_text("""import pytest
from rehearse.testing import name_of

def test_one(golden): assert golden.name == "Names.One"
@pytest.mark.golden("Other.Name")
def test_two(golden): assert golden.name == "Other.Name"
@pytest.mark.parametrize("depth", ["0.1 m", "2"])
def test_three(golden, depth): assert golden.name in ("Names.Three-0-1-m", "Names.Three-2")
class TestWalker:
    def test_StopsBeforeTheEdge(self, golden): assert golden.name == "Walker.StopsBeforeTheEdge"
""")
    assert "5 passed" in run_pytest(0, None, "test_names.py")
