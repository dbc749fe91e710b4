"""What fuzzing found, and what it begins with: no input that is kept makes anything stumble."""

import pytest
from fuzz.targets import CORPUS, TARGETS, run, seeds

MOST_BYTES = 300_000


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(TARGETS.keys() - {"recording"}))
def test_kept_inputs_are_read_or_refused(name):
    found = [*seeds(name)]
    assert found
    for data in found:
        assert run(name, data)


@pytest.mark.slow
def test_kept_recordings_are_judged_alike():
    ends = {run("recording", data) for data in seeds("recording")}
    assert "judged" in ends


@pytest.mark.slow
def test_snapshots_that_fuzzing_begins_with_are_of_this_form():
    """What is changed is a run that can be taken up, else all is refused at the door."""
    assert {run("snapshot", data) for data in seeds("snapshot")} == {"restored"}


def test_the_corpus_stays_small():
    """It is a beginning, not what was found in hours."""
    assert sum(path.stat().st_size for path in CORPUS.rglob("*")) < MOST_BYTES
