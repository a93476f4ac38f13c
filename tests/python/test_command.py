"""The verbs as functions: their results are those of the command."""

import json
import subprocess

import pytest

import rehearse
from conftest import root


@pytest.fixture(scope="session")
def spring(tmp_path_factory, fixtures):
    """A short recording."""
    output = tmp_path_factory.mktemp("spring") / "spring.mcap"
    result = rehearse.record(fixtures / "scenarios/spring.yaml", output, duration=0.2)
    assert result and result.trace == str(output)
    return output


def test_record_writes_the_recording_that_its_result_names(spring):
    trace = rehearse.Trace(spring)
    assert trace.ticks == 41
    assert trace.metadata["rehearse"]["duration"] == "0.2"


def test_a_check_has_the_verdict_of_the_command(fixtures):
    scenario = fixtures / "scenarios/spring.yaml"
    result = rehearse.check(scenario)
    said = json.loads(subprocess.run([rehearse.command(), "check", "--json", scenario], capture_output=True, check=True,
                                     text=True).stdout)
    assert result.status == 0 and bool(result)
    assert result.code == said["code"] and result.first is None
    assert result.levels.controller == "equal"
    assert [one.text for one in result.expectations] == [one["text"] for one in said["expectations"]]


def test_another_controller_is_a_difference_and_not_an_error(spring):
    changed = rehearse.replay(spring, set=["Rail/SLIDE/q+=0.01@tick:10..20"])
    assert changed.status == 1 and not changed
    assert changed.first is not None


def test_a_diff_names_the_first_difference(spring, fixtures):
    rehearse.record(fixtures / "scenarios/spring.yaml", "other.mcap", duration=0.1)
    assert rehearse.diff(spring, spring).equal
    shorter = rehearse.diff(spring, "other.mcap")
    assert shorter.status == 1 and "tick 20" in shorter.verdict
    with pytest.raises(AttributeError, match="the result has no 'opinion'; it has schema"):
        shorter.opinion


def test_bad_input_is_an_error_with_its_place(tmp_path):
    (tmp_path / "bad.yaml").write_text("a: [1\n")
    with pytest.raises(rehearse.Error) as raised:
        rehearse.record("bad.yaml")
    error = raised.value
    assert (error.file, error.line, error.column) == ("bad.yaml", 1, 4)
    assert error.hint == "add the ']'" and "can't be read as YAML" in error.message
    assert str(error) == f"bad.yaml:1:4: error: {error.message} ({error.hint})"


def test_a_name_that_looks_like_an_option_is_a_file():
    with pytest.raises(rehearse.Error, match="--seed"):
        rehearse.check("--seed")


def test_record_takes_other_values_of_the_scenario(fixtures):
    run = rehearse.record(fixtures / "scenarios/sr1_minimum.yaml", "heavy.mcap", duration=0.01, frames=False,
                          set={"bodies[SR1].links[WAIST].mass": 8.2, "bodies.SR1.joints.RLEG_KNEE": "20 deg"})
    trace = rehearse.Trace(run.trace)
    text = trace.attachments["scenario.yaml"].decode()
    assert "mass: 8.2" in text and "RLEG_KNEE" in text
    assert trace["SR1/RLEG_KNEE/q"][0] == pytest.approx(0.349066)
    again = rehearse.record(fixtures / "scenarios/sr1_minimum.yaml", "usual.mcap", duration=0.01, frames=False)
    assert not rehearse.diff(run.trace, again.trace).equal


@pytest.mark.parametrize("path, value, message", [
    ("bodies[SR1].links[WAISTT].mass", 8.2, "with 'bodies[SR1].links[WAISTT].mass' at 8.2: the scenario states no 'WAISTT'"),
    ("bodies[SR1].links[WAIST].mass", -1, "with 'bodies[SR1].links[WAIST].mass' at -1: "),
    ("duration", "long", "with 'duration' at long: "),
])
def test_a_value_that_the_scenario_cannot_have_is_named_with_its_path(fixtures, path, value, message):
    with pytest.raises(rehearse.Error) as raised:
        rehearse.record(fixtures / "scenarios/sr1_minimum.yaml", set={path: value})
    assert raised.value.message.startswith(message) and raised.value.file.endswith("sr1_minimum.yaml")


def test_verbs_are_functions(fixtures, standing, tmp_path):
    assert rehearse.inspect(fixtures / "models/pendulum.urdf").json
    page = rehearse.report(standing.file, output=tmp_path / "page.html")
    assert page.status == 0 and (tmp_path / "page.html").read_text().startswith("<!doctype html")
    swept = rehearse.sweep(fixtures / "campaigns/stand_push.yaml", tmp_path / "pushed", cases=2, jobs=1)
    assert (tmp_path / "pushed").is_dir() and swept.json
    audited = rehearse.audit(root / "golden/PendulumSwingUp.EndsUpright.mcap")
    assert audited.json and audited.status in (0, 1)
    line = {"history": 1, "commit": "v1", "changed": False, "date": "", "scenario": "walk", "code": "same", "proved": True,
            "first": None, "margins": []}
    (tmp_path / "history.jsonl").write_text(json.dumps(line) + "\n")
    assert rehearse.history(tmp_path / "history.jsonl").status == 0
