"""`rvmon init --campaign` writes a campaign whose commands work without an edit."""

import json
import subprocess
import sys

import pytest

from rvmon.cli import main

pytestmark = pytest.mark.process


def run(folder, *words):
    command = [sys.executable, str(folder / "campaign.py"), *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)  # noqa: S603


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("init") / "mine"
    assert main(["init", "--campaign", str(folder)]) == 0
    return folder


def test_the_campaign_passes_its_strict_gate_and_finds_its_planted_fault(written):
    done = run(written, "run", "--tests", "20", "--jobs", "1", "--strict")
    assert (done.returncode, done.stderr) == (0, "")
    assert "2 of 2 directed tests ended as they should, 1 of them with a fault" in done.stdout
    assert main(["format", "--check", str(written / "lift.rv")]) == 0


def test_the_campaign_closes_its_coverage(written):
    done = run(written, "close", "--jobs", "1", "--format", "json", "--out", "closed")
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout)
    assert (found["open"], found["wrong"], found["share"]) == ([], [], 1.0)
    tests = [json.loads(path.read_text()) for path in (written / "closed/tests").glob("*.json")]
    assert tests
    assert all(0 <= call["floor"] <= 4 for test in tests for call in test["calls"])


def test_the_code_of_the_campaign_is_mutated(written):
    words = ("mutate", "--of", "code", "--tests", "4", "--strategy", "anyone", "--jobs", "1")
    done = run(written, *words, "--only", "next_state", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)


def test_nothing_is_overwritten(written, says):
    assert "exists already" in says(2, "init", "--campaign", written).err
    says(0, "init", "--campaign", written, "--force")
