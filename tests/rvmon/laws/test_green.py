"""Green never hides a failure: what was lost, filled in, turns no verdict."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.rvmon.laws.tried import TRIED, judge
from tests.tools.sound import is_spoken_of, overturned

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.strategies import cases

pytestmark = pytest.mark.law


@TRIED
@given(cases(Profile(), TraceProfile(outages=35)), st.randoms(use_true_random=False))
def test_filling_in_what_was_lost(case, rng) -> None:
    assume(is_spoken_of(case.spec))
    assert overturned(rng, case, 4, judge).overturning is None
