"""rehearse new --language python: the project goes from nothing to a golden, a red test and an accepted change."""

import os
import subprocess
import sys
from pathlib import Path

import rehearse


def run(status, *words, **environment):
    ended = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **environment}, cwd="arm")
    assert ended.returncode == status, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


def test_the_way_of_a_newcomer():
    subprocess.run([rehearse.command(), "new", "--language", "python", "arm"], check=True, capture_output=True)
    pytest = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    assert "3 passed" in run(0, *pytest, REHEARSE_GOLDEN="new")
    assert "3 passed" in run(0, *pytest)
    assert "equal" in run(0, rehearse.command(), "check")
    source = Path("arm/hold.py")
    source.write_text(source.read_text().replace("STIFFNESS = 60.0", "STIFFNESS = 59.0"))
    said = run(1, *pytest)
    assert "3 failed" in said and "the controller changed: fed with the golden's inputs, SHOULDER/u" in said
    run(1, rehearse.command(), "check")
    run(0, rehearse.command(), "golden", "accept", "--all")
    assert "1 failed, 2 passed" in run(1, *pytest)  # the number that is stated by hand
