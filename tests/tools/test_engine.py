"""The engines against the oracle: a fixed number of random cases, disagreements shrunk.

`python -m benchmarks.differential` runs as many as one likes.
"""

from __future__ import annotations

import pytest

from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from tests.tools.differential import campaign
from tests.tools.forms import Maker

pytestmark = pytest.mark.law

PAIRS = 35


@pytest.mark.parametrize("time", TimeModel)
def test_no_disagreement(time: TimeModel) -> None:
    """Verdicts, decision instants and what each call returns are the oracle's."""
    seeds = [f"{engine} {number}" for number in range(PAIRS)]
    profile = Profile(time=time, mixed=engine != "progression")
    tally = campaign(Maker(engine), seeds, profile, TraceProfile(), online_every=4)
    assert tally.pairs == PAIRS
    assert "\n\n".join(tally.disagreements) == ""


def test_automata_alone() -> None:
    """The automata of those formulas that have one are right without any help."""
    profile = Profile(mixed=False, requirements=1, depth=3)
    seeds = [f"automaton {number}" for number in range(50)]
    tally = campaign(Maker("automaton"), seeds, profile, TraceProfile(), online_every=0)
    assert tally.pairs > 25
    assert "\n\n".join(tally.disagreements) == ""
