"""Green means green at the doors: what one loses is filled in, and overturns no verdict of it."""

from itertools import islice

import pytest
from tests.rvmon.laws.lossy_doors import DOORS, outcomes, trials

pytestmark = pytest.mark.law
RUNS = 30


@pytest.mark.parametrize("door", DOORS)
def test_no_verdict_is_overturned(door, tmp_path):
    """By what was lost, or any other in its place; late samples may take no failure back."""
    tried = list(outcomes(door, DOORS[door], RUNS, 2, tmp_path))
    assert [(one.name, one.overturned) for one in tried if one.overturned] == []
    assert len(tried) == RUNS
    assert sum(one.is_split for one in tried) >= RUNS / 10


def test_a_door_that_loses_in_silence_is_found(tmp_path):
    """The test of the test: it drops the samples, and tells nobody."""

    def silent(trial):
        rest = [s for n, s in enumerate(trial.case.samples) if n not in trial.lost]
        monitor = trial.spec.monitor(sources=trial.case.names)
        for sample in rest:
            monitor.step_ns(sample.t, sample.values)
        monitor.advance_ns(trial.end)
        return monitor.finish_ns().verdicts

    assert any(one.overturned for one in outcomes("stdin", silent, 50, 1, tmp_path))


def test_a_door_loses_what_requirements_read(tmp_path):
    """Each run lacks a letter without what is lost; no run is drawn twice."""
    some = [one.name for one in islice(trials("stdin", 1, tmp_path), 20)]
    assert len({*some}) == len(some) == 20
