"""`finish(t)` is `advance(t + 1 tick)`, and then the end."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tools.compare import differences
from tests.tools.law import judge, word

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.strategies import cases


@pytest.mark.law
@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_an_advance_behind_the_end_says_no_more(data: st.DataObject) -> None:
    """Whoever calls `advance` up to behind the end is told what `finish` alone tells."""
    case = data.draw(cases(Profile(), TraceProfile(outages=30)))
    end = word(case).end
    if end is None:
        return
    told = replace(case, actions=(*case.actions, end + 1), end=end)
    expected = judge(case)
    assert differences(expected, judge(told)) == []
