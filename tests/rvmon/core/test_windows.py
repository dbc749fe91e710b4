"""Attempts that owe windows of windows, which the core follows without a network."""

import random

import pytest
from tests.tools.differential import disagreements
from tests.tools.forms import Maker
from tests.tools.special_specs import random_chain

from rvmon.testing.generate.trace import TraceProfile, random_trace


@pytest.mark.law
@pytest.mark.parametrize("form", ["c", "c rows", "c+interrupt", "c+next"])
@pytest.mark.parametrize("seed", range(3))
def test_the_law_decides(form, seed):
    """The oracle's records, also where something is lost and where much is let go of."""
    rng, make = random.Random(f"windows {seed}"), Maker(form)
    for _ in range(6):
        spec = random_chain(rng)
        for unknowns in (False, True):
            case = random_trace(rng, spec, TraceProfile(unknowns=unknowns, long=50, span=60))
            assert not disagreements(case, make, online=True)
