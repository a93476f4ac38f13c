"""A learned policy: the same bits in Python and in C++, and the mistakes of its deployment, named by a replay."""

import os
import shutil
from pathlib import Path

import pytest

import rehearse
from conftest import root

POLICY = root / "fixtures/policy/trot_policy.py"
SCENARIO = root / "fixtures/scenarios/trot_policy.yaml"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run under the policy in Python."""
    recorded = rehearse.record(SCENARIO, tmp_path_factory.mktemp("policy") / "python.mcap",
                               controllers={"Policy": f"{POLICY}:TrotPolicy"})
    assert recorded.failure is None and all(expectation.holds for expectation in recorded.expectations)
    return recorded.trace


def replayed(run, library):
    return rehearse.replay(run, controllers={"Policy": library})


def explanation(run, fault):
    """What the replay says beside the first different command."""
    result = replayed(run, Path(os.environ["FAULTY_POLICIES"]) / f"TrotPolicyWith_{fault}.so")
    assert not result.equal
    assert result.verdict.startswith("differs: ") and result.verdict.endswith("; " + result.explanation)
    return result.explanation


def test_the_controller_in_cpp_has_the_bits_of_the_one_in_python(run):
    result = replayed(run, "TrotPolicyController")
    assert result.equal and result.words.different == 0 and result.words.variables == 300 * (41 + 12)
    assert result.verdict == "equal bit for bit: 3000 ticks, 39000 commanded numbers" and result.explanation == ""


def test_another_order_of_sums_changes_last_bits_only(run):
    text = POLICY.read_text()
    by_library = text.replace("    y = weights[:, -1].copy()\n", "    return weights[:, :-1] @ x + weights[:, -1]\n")
    assert by_library != text
    shutil.copytree(root / "fixtures/policy", "policy")
    Path("policy/trot_policy.py").write_text(by_library)
    result = replayed(run, "policy/trot_policy.py:TrotPolicy")
    assert result.explanation == ""
    assert result.equal or result.worst.difference < 1e-9  # [N·m]


def test_a_permuted_order_of_joints_is_named(run):
    said = explanation(run, "order")
    assert said.startswith("the order differs: observation.dq.FL_KNEE has the recorded values of observation.dq.RL_KNEE, ")
    assert said.endswith(" more likewise, in all 300 values")


def test_a_missing_scale_is_named(run):
    assert explanation(run, "scale") == (
        "the scale differs: observation.angular_velocity.x is 4 times the recorded one, "
        "observation.angular_velocity.y is 4 times the recorded one, "
        "observation.angular_velocity.z is 4 times the recorded one, and 12 more likewise, in all 300 values")


def test_another_default_pose_is_named(run):
    assert explanation(run, "pose") == (
        "the zero differs: observation.q.FL_KNEE is the recorded one - 1.3, "
        "observation.q.FL_THIGH is the recorded one + 0.7, observation.q.FR_KNEE is the recorded one - 1.3, "
        "and 5 more likewise, in all 300 values")


def test_a_stale_action_is_named(run):
    said = explanation(run, "stale")
    assert said.startswith("it is stale: observation.last_action.FL_ABDUCTION is action.FL_ABDUCTION of 2 values "
                           "before, in the recording of 1 value before, ")
    assert said.endswith("and 9 more likewise, in all 300 values") and said.count(": ") == 1


def test_check_names_the_fault_of_a_changed_controller(run):
    shutil.copyfile(run, "python.mcap")
    fault = Path(os.environ["FAULTY_POLICIES"]) / "TrotPolicyWith_scale.so"
    result = rehearse.check(SCENARIO, golden="python.mcap", controllers={"Policy": fault})
    assert "the controller changed" in result.verdict and "the scale differs: observation." in result.verdict


def test_a_file_of_weights_that_does_not_fit_is_refused():
    shutil.copytree(root / "fixtures/policy", "share/policy")
    weights = Path("share/policy/trot.txt")
    weights.write_text(weights.read_text().replace("32 42\n", "32 41\n", 1))
    os.environ["REHEARSE_CHOREONOID_SHARE"] = str(Path("share").resolve())
    try:
        result = rehearse.record(SCENARIO, "refused.mcap")
    finally:
        del os.environ["REHEARSE_CHOREONOID_SHARE"]
    assert "trot.txt isn't two layers from 41 numbers to 12" in result.failure.message
