"""Verdicts of runs with lost samples hold whatever the lost samples were."""

from itertools import islice

import pytest
from tests.rvmon.laws.lossy_doors import DOORS, outcomes, trials

pytestmark = pytest.mark.law
RUNS = 30


@pytest.mark.parametrize("door", DOORS)
def test_lost_samples_overturn_no_verdict(door, tmp_path):
    tried = list(outcomes(door, DOORS[door], RUNS, 2, tmp_path))
    assert [(trial.name, trial.overturned) for trial in tried if trial.overturned] == []
    assert len(tried) == RUNS
    assert sum(trial.is_split for trial in tried) >= RUNS / 10


def test_a_door_that_drops_samples_silently_is_found(tmp_path):
    """This tests the test above."""

    def silent(trial):
        rest = [s for n, s in enumerate(trial.case.samples) if n not in trial.lost]
        monitor = trial.spec.monitor(sources=trial.case.names)
        for sample in rest:
            monitor.step_ns(sample.t, sample.values)
        monitor.advance_ns(trial.end)
        return monitor.finish_ns().verdicts

    assert any(trial.overturned for trial in outcomes("stdin", silent, 50, 1, tmp_path))


def test_no_run_is_drawn_twice(tmp_path):
    names = [trial.name for trial in islice(trials("stdin", 1, tmp_path), 20)]
    assert len({*names}) == len(names) == 20
