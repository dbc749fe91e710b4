"""The core against the oracle: a fixed number of random cases, disagreements shrunk.

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
    seeds = [f"auto {number}" for number in range(PAIRS)]
    tally = campaign(Maker(), seeds, Profile(time=time), TraceProfile(), online_every=4)
    assert tally.pairs == PAIRS
    assert "\n\n".join(tally.disagreements) == ""
