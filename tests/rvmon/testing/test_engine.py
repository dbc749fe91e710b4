"""The engines against the oracle: a fixed number of random cases, disagreements shrunk.

`python -m benchmarks.differential` runs as many as one likes.
"""

from __future__ import annotations

from functools import partial

import pytest

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.spec.checked import TimeModel
from rvmon.testing.case import Case
from rvmon.testing.differential import campaign, case_of, disagreements
from rvmon.testing.drive import Monitored
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile

PAIRS = 70


def make(engine: str, case: Case) -> Monitored:
    return Spec(case.spec).monitor(engine=engine, sources=case.names)


@pytest.mark.parametrize("engine", ["auto", "progression"])
@pytest.mark.parametrize("time", TimeModel)
def test_no_disagreement(time: TimeModel, engine: str) -> None:
    """Verdicts, decision instants and what each call returns are the oracle's."""
    seeds = [f"{engine} {number}" for number in range(PAIRS)]
    profile = Profile(time=time, mixed=False)
    tally = campaign(partial(make, engine), seeds, profile, TraceProfile(), online_every=4)
    assert tally.pairs == PAIRS
    assert "\n\n".join(tally.disagreements) == ""


def test_automata_alone() -> None:
    """The automata of those formulas that have one are right without any help."""
    judged = 0
    for number in range(100):
        profile = Profile(mixed=False, requirements=1, depth=3)
        case = case_of(f"automaton {number}", profile, TraceProfile())
        try:
            make("automaton", case)
        except RvmonError as error:
            if "no automaton" not in str(error):
                raise
            continue
        assert disagreements(case, partial(make, "automaton")) == []
        judged += 1
    assert judged > 50
