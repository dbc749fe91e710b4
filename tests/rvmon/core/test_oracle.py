"""The core against the law: random cases, step by step and by rows."""

from collections.abc import Iterator

import pytest
from tests.tools.compare import differences
from tests.tools.differential import campaign_of, cases_of
from tests.tools.filled import filled, judge_columns
from tests.tools.forms import Compiler, Maker
from tests.tools.law import judge

from rvmon.monitor import compile_spec
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

pytestmark = pytest.mark.law


@pytest.mark.parametrize("time", TimeModel)
def test_each_call_says_what_the_law_has_it_say(time):
    """What a call returns, what the report says, and that what is wrong is refused; rows, too."""
    seeds = [f"core/{time.name}/{number}" for number in range(70)]
    profile, traces = Profile(time=time, crowded=5, wide=10), TraceProfile(sparse=10)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in ("c", "c rows")}
    found = campaign_of(makers, seeds, profile, traces, each=10, online_every=4)
    assert not found.disagreements, found.disagreements[0]
    assert [(one.pairs, one.refused) for one in found.tallies.values()] == [(700, 0)] * 2


def by_columns(seeds: int) -> Iterator[tuple[Case, list[str]]]:
    """Random cases as columns, and what is said otherwise of them."""
    for seed in range(seeds):
        compiled = None
        for case in map(filled, cases_of(f"columns/{seed}", Profile(), TraceProfile(), 3)):
            compiled = compiled or compile_spec(case.spec)
            cuts = [len(case.samples) // 3] if len(case.samples) > 3 else []
            report = judge_columns(compiled, case, "c", cuts)
            if report is not None:
                yield case, differences(judge(case), report)


def test_columns_are_judged_as_the_law_has_it():
    """Random specifications on random arrays: what the oracle says of the same samples."""
    found = [text for _, text in by_columns(40)]
    assert len(found) >= 100
    assert not any(found), next(filter(None, found))
