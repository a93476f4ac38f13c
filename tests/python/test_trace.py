"""rehearse.Trace: arrays, moments, pictures, logs of others, errors."""

import json
import subprocess

import numpy as np
import pytest

import rehearse
from conftest import root
from rows import write_log


def command(*words):
    return subprocess.run([rehearse.command(), *map(str, words)], capture_output=True, text=True, check=True).stdout


def test_a_series_is_the_memory_of_the_recording(standing):
    knee = standing["SR1/RLEG_KNEE/q"]
    assert knee.dtype == np.float64 and knee.shape == standing.times("SR1/RLEG_KNEE/q").shape
    assert not knee.flags.owndata and not knee.flags.writeable
    assert np.shares_memory(knee, standing["SR1/RLEG_KNEE/q"])
    with pytest.raises(ValueError):
        knee[0] = 1.0
    with pytest.raises(TypeError):
        standing["SR1/RLEG_KNEE/q"] = knee


def test_an_array_outlives_its_trace(standing):
    expected = standing["SR1/RLEG_KNEE/q"].copy()
    alone = rehearse.Trace(standing.file)["SR1/RLEG_KNEE/q"]
    assert np.array_equal(alone, expected)


def test_numbers_are_those_that_the_command_prints(standing):
    row = json.loads(command("cat", standing.file, "--topics", "/SR1/joints", "--limit", "1", "--json").splitlines()[0])
    names = row["message"]["name"]
    for name, q in zip(names, row["message"]["position"]):
        assert standing[f"SR1/{name}/q"][0] == q


def test_a_part_has_the_same_numbers_and_no_others(standing):
    part = rehearse.Trace(standing.file, topics=["/SR1/joints", "/SR1/LeftCamera/image"])
    assert set(part.topics) == {"/SR1/joints", "/SR1/LeftCamera/image"} and part.file == standing.file
    for name in part:
        assert np.array_equal(part[name], standing[name]) and np.array_equal(part.stamps(name), standing.stamps(name))
    assert np.array_equal(part.images["SR1/LeftCamera"][7], standing.images["SR1/LeftCamera"][7])
    assert len(rehearse.Trace(standing.file, topics="/tick").time) == 1001
    with pytest.raises(rehearse.Error, match="/SR1/joint[^s]"):
        rehearse.Trace(standing.file, topics="/SR1/joint")


def test_every_series_has_a_time_and_a_unit(standing):
    assert len(standing) == len(list(standing)) == len(standing.units) > 400
    for name in standing:
        assert len(standing[name]) == len(standing.times(name))
        assert np.all(np.diff(standing.stamps(name).astype(np.int64)) >= 0)
    assert standing.units["SR1/RLEG_KNEE/q"] == "rad"
    assert standing.units["SR1/RLEG_KNEE/u"] == "N·m"


def test_the_time_is_that_of_the_ticks(standing):
    assert len(standing.time) == standing.ticks == 1001
    assert standing.time[0] == 0.0 and standing.time[-1] == pytest.approx(standing.duration, abs=1e-12)


def test_integers_and_booleans_keep_their_type(standing):
    assert standing["tick"].dtype == np.int64
    assert standing["SR1/LeftCamera/height"].dtype == np.uint64
    assert standing["SR1/LeftCamera/roi/do_rectify"].dtype == np.bool_


def test_a_moment_is_the_last_tick_at_or_before_it(standing):
    moment = standing.at(0.3204)
    assert moment.tick == 320 and moment.time == pytest.approx(0.32)
    inputs = moment.inputs["SR1/SR1Minimum"]
    place = list(standing.times("SR1/SR1Minimum/input/RLEG_KNEE/q")).index(moment.time)
    assert inputs["RLEG_KNEE/q"] == standing["SR1/SR1Minimum/input/RLEG_KNEE/q"][place]
    assert "RLEG_KNEE/u" in moment.outputs["SR1/SR1Minimum"]
    assert list(moment.inputs) == ["SR1/SR1Minimum"]
    for outside in (-0.1, 1.5):
        with pytest.raises(rehearse.Error, match=r"no tick at .* \(it lasts from 0 to 1 s\)"):
            standing.at(outside)


def test_pictures_are_read_when_they_are_asked_for(standing):
    eye = standing.images["SR1/LeftCamera"]
    assert len(eye) == len(eye.time) == 30
    assert eye[0].shape == (480, 640, 3) and eye[0].dtype == np.uint8
    assert np.array_equal(eye[-1], eye[29])
    assert len(np.unique(eye[29])) > 1
    depth = standing.images["SR1/LeftCamera/depth"]
    assert depth[3].dtype == np.float32 and depth[3].shape == (480, 640) and np.nanmin(depth[3]) > 0.0
    with pytest.raises(IndexError, match="has 30 pictures, no number 30"):
        eye[30]


def test_events_contacts_metadata_and_files_are_there(standing):
    assert [change["link"] for change in standing.contacts] == ["Floor/Floor"] * 2
    assert standing.contacts[0]["begins"] is True and standing.contacts[0]["tick"] == 34
    assert standing.metadata["rehearse"]["scenario"] == "sr1_minimum"
    assert standing.attachments["scenario.yaml"].startswith(b"#") or b"bodies" in standing.attachments["scenario.yaml"]
    assert standing.topics["/tick"] == "rehearse_msgs/msg/Tick"


def test_an_unknown_name_names_the_nearest(standing):
    with pytest.raises(rehearse.UnknownName) as raised:
        standing["SR1/RLEG_KNEEE/q"]
    assert isinstance(raised.value, KeyError) and isinstance(raised.value, rehearse.Error)
    assert "SR1/RLEG_KNEE/q" in raised.value.hint and "no series 'SR1/RLEG_KNEEE/q'" in str(raised.value)
    assert standing.get("nothing") is None and "nothing" not in standing and 3 not in standing
    with pytest.raises(rehearse.UnknownName, match="no camera 'SR1/Eye'"):
        standing.images["SR1/Eye"]


@pytest.mark.parametrize("name, sentence", [
    ("missing.mcap", "No such file"), ("text.mcap", "not an MCAP file"), ("cut.mcap", "")])
def test_a_file_that_cannot_be_read_is_an_error_with_its_name(standing, tmp_path, name, sentence):
    (tmp_path / "text.mcap").write_text("no recording")
    with open(standing.file, "rb") as whole:
        (tmp_path / "cut.mcap").write_bytes(whole.read()[:200_000])
    with pytest.raises(rehearse.Error, match=sentence) as raised:
        rehearse.Trace(name)
    assert raised.value.file == name and raised.value.diagnostics[0].severity == "error"


def test_a_damaged_file_is_read_as_far_as_possible_if_asked(standing, tmp_path):
    with open(standing.file, "rb") as whole:
        (tmp_path / "cut.mcap").write_bytes(whole.read()[:1_000_000])
    cut = rehearse.Trace("cut.mcap", tolerate=True)
    assert cut.damage and 0 < cut.ticks < standing.ticks
    knee = cut["SR1/RLEG_KNEE/q"]
    assert np.array_equal(knee, standing["SR1/RLEG_KNEE/q"][:len(knee)])


def test_a_bag_is_opened_as_the_command_opens_it():
    bag = root / "tests/fuzz/corpus/ros1_bag/plain.bag"
    listed = {channel["topic"] for channel in json.loads(command("info", bag, "--json"))["channels"]}
    trace = rehearse.Trace(bag)
    assert set(trace.topics) == listed
    assert trace.ticks == 0
    with pytest.raises(rehearse.Error, match="has no ticks"):
        trace.time


def test_a_part_is_read_without_decoding_the_rest(tmp_path):
    file = tmp_path / "rows.mcap"
    write_log(file, 120_000, unreadable="/battery/voltage")
    with pytest.raises(rehearse.Error, match="/battery/voltage: message 0 isn't a valid std_msgs/msg/Float64"):
        rehearse.Trace(file)
    part = rehearse.Trace(file, topics="/motor/current")
    assert list(part) == ["motor/data"] and part["motor/data"][1] == np.sin(1e-3) and len(part["motor/data"]) == 120_000


def test_a_trace_closes_its_file_at_the_end_of_with(standing):
    with rehearse.Trace(standing.file) as trace:
        knee = trace["SR1/RLEG_KNEE/q"]
    assert np.array_equal(knee, standing["SR1/RLEG_KNEE/q"]), "an array that was read stays"
    with pytest.raises(rehearse.Error, match="the trace is closed"):
        trace["SR1/RLEG_KNEE/q"]
    assert "closed" in repr(trace)


def test_a_star_stands_for_any_text(standing):
    knees = standing["SR1/*_KNEE/q"]  # of the robot, and of its controller's inputs and outputs
    assert set(knees) == {name for name in standing if name.startswith("SR1/") and name.endswith("_KNEE/q")}
    assert set(standing["SR1/R*G_KNEE/q"]) == {"SR1/RLEG_KNEE/q"}
    assert np.array_equal(knees["SR1/LLEG_KNEE/q"], standing["SR1/LLEG_KNEE/q"])
    assert len(standing["*"]) == len(standing)
    with pytest.raises(rehearse.UnknownName, match=r"no series matches 'SR1/\*_NEE/q'"):
        standing["SR1/*_NEE/q"]


def test_pictures_have_slices_and_a_clear_error(standing):
    pictures = standing.images["SR1/LeftCamera"]
    part = pictures[10:20:2]
    assert len(part) == 5 and np.array_equal(part[1], pictures[12]) and np.array_equal(part[-1], pictures[18])
    assert np.array_equal(part.time, pictures.time[10:20:2])
    assert np.array_equal(pictures[np.int64(3)], pictures[3])
    with pytest.raises(TypeError, match="expected an int or a slice, not 0.5"):
        pictures[0.5]
    with pytest.raises(IndexError, match="has 5 pictures, no number 5"):
        part[5]


def test_a_file_that_is_not_there_is_a_file_not_found_error():
    for load in (rehearse.Trace, rehearse.check, rehearse.replay):
        with pytest.raises(FileNotFoundError) as raised:
            load("nowhere/missing.mcap")
        assert isinstance(raised.value, rehearse.Error) and raised.value.file == "nowhere/missing.mcap"


def test_columns_have_the_last_value_of_each_tick(standing):
    rows, columns = standing._aligned(["tick", "SR1/RLEG_KNEE/q"])
    assert np.array_equal(rows, standing.time) and columns["tick"].dtype == standing["tick"].dtype
    stamps, values = standing.stamps("SR1/RLEG_KNEE/q"), standing["SR1/RLEG_KNEE/q"]
    for row in (0, 17, len(rows) - 1):
        before = values[stamps <= standing.stamps("tick")[row]]
        assert columns["SR1/RLEG_KNEE/q"][row] == before[-1] if len(before) else np.isnan(columns["SR1/RLEG_KNEE/q"][row])


def test_a_table_of_pandas_has_times_and_units(standing):
    pytest.importorskip("pandas")
    table = standing.to_pandas("SR1/*_KNEE/q", "tick")
    assert table.index.name == "time" and len(table) == standing.ticks
    assert table.attrs["units"]["SR1/RLEG_KNEE/q"] == "rad"


def test_a_missing_package_is_named(standing, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(rehearse.Error, match="to_pandas.. needs pandas, which isn't installed"):
        standing.to_pandas()


def test_series_are_drawn_beside_those_of_a_golden(standing):
    pytest.importorskip("matplotlib").use("Agg")
    axes = standing.plot("SR1/R*G_KNEE/q", "SR1/L*G_KNEE/q", golden=standing.file)
    labels = {line.get_label() for line in axes.get_lines()}
    assert labels == {"SR1/RLEG_KNEE/q", "SR1/RLEG_KNEE/q, golden", "SR1/LLEG_KNEE/q", "SR1/LLEG_KNEE/q, golden"}
    assert axes.get_ylabel() == "[rad]"


def test_a_notebook_shows_curves_and_a_verdict(standing):
    page = standing._repr_html_()
    assert page.count("<svg") > 5 and "1001 ticks" in page
    result = rehearse.Result({"verdict": "a < b", "report": "x.html", "levels": {"closed": "differs"},
                              "expectations": [{"text": "it holds", "holds": True}]}, 1)
    page = result._repr_html_()
    assert "a &lt; b" in page and "closed: differs" in page and "it holds" in page and 'href="file:///' in page


def test_the_module_has_a_version():
    assert rehearse.__version__.count(".") == 2
