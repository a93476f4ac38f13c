"""slow: the script that makes the weights of the learned policy makes one that walks."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import rehearse
from conftest import root


def test_the_weights_can_be_made_again():
    for folder in ("policy", "models"):
        shutil.copytree(root / "fixtures" / folder, folder)
    Path("scenarios").mkdir()
    shutil.copy(root / "fixtures/scenarios/trot_policy.yaml", "scenarios")
    Path("policy/trot.txt").unlink()
    subprocess.run([sys.executable, "policy/train_trot.py"], check=True, env=os.environ)
    run = rehearse.record("scenarios/trot_policy.yaml", controllers={"Policy": "policy/trot_policy.py:TrotPolicy"})
    assert run.failure is None and all(expectation.holds for expectation in run.expectations)
