"""The core against the law: random cases, step by step and by rows."""

import pytest
from tests.tools.differential import campaign
from tests.tools.forms import Compiler, Maker

from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

pytestmark = pytest.mark.law


@pytest.mark.parametrize("time", TimeModel)
def test_each_call_says_what_the_law_has_it_say(time):
    """What a call returns, what the report says, and that what is wrong is refused; rows, too."""
    seeds = [f"core/{time.name}/{number}" for number in range(30)]
    profile, traces = Profile(time=time, crowded=5, wide=10), TraceProfile(sparse=10)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in ("c", "c rows")}
    found = campaign(makers, seeds, profile, traces, each=10, online_every=4)
    assert not found.disagreements, found.disagreements[0]
    assert [found.counts[f"judged by {form}"] for form in makers] == [300, 300]
