"""What fuzzing found, and what it begins with: no input that is kept makes anything stumble."""

from pathlib import Path

import pytest
from fuzz.targets import TARGETS, run

CORPUS = Path(__file__).parents[1] / "fuzz" / "corpus"
MOST_BYTES = 300_000


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(TARGETS.keys() - {"recording"}))
def test_kept_inputs_are_read_or_refused(name):
    """Each target has some; anything but an error for people comes out of it."""
    files = sorted((CORPUS / name).iterdir())
    assert files
    for path in files:
        assert run(name, path.read_bytes())


@pytest.mark.slow
def test_kept_recordings_are_judged_alike():
    """By columns and by samples; some are judged, not only refused."""
    ends = {run("recording", path.read_bytes()) for path in (CORPUS / "recording").iterdir()}
    assert "judged" in ends


@pytest.mark.slow
def test_kept_snapshots_are_of_this_form():
    """What is changed by fuzzing is a run that can be taken up, else it is refused at the door."""
    found = {run("snapshot", path.read_bytes()) for path in (CORPUS / "snapshot").iterdir()}
    assert "restored" in found


def test_the_corpus_stays_small():
    """It is a beginning, not what was found in hours."""
    assert sum(path.stat().st_size for path in CORPUS.rglob("*")) < MOST_BYTES
