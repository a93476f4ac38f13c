"""Files that the tests of the module share."""

import os
from pathlib import Path

import pytest

import rehearse

root = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    """Commands write into the working directory, and read these variables."""
    monkeypatch.chdir(tmp_path)
    for variable in ("CI", "REHEARSE_GOLDEN", "REHEARSE_GOLDEN_DIR", "REHEARSE_PENDING", "REHEARSE_CONTROLLER_PATH"):
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture(scope="session")
def standing():
    """SR1 stands for a second: 498 series, two cameras."""
    return rehearse.Trace(root / "golden/SR1.StandsUnderItsMinimumController.mcap")


@pytest.fixture(scope="session")
def fixtures():
    return root / "fixtures"
