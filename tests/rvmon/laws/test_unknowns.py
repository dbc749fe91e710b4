"""Decisions made with unknown values hold for all values."""

from dataclasses import replace
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from msgspec import structs
from tests.rvmon.laws.tried import ONE, TRIED, judge, known_from_the_first
from tests.tools.build import start
from tests.tools.compare import outcomes
from tests.tools.sound import is_spoken_of, overturned, refilled

from rvmon.language.checked.specification import CheckedSpec, EndPolicy, Mode
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.strategies import cases, specs, traces
from rvmon.verdicts.attempt import Decision

pytestmark = pytest.mark.law


@TRIED
@given(specs(ONE), st.data(), st.randoms(use_true_random=False))
def test_known_values_change_no_decision(
    spec: CheckedSpec, data: st.DataObject, rng: Random
) -> None:
    """P stays P and F stays F, decided no later, if unknown values become known.

    The trigger is known (`start`); formulas with `known(x)` are left out, as they refer to the
    unknown itself. Every signal has a value from the first sample on, because a signal without a
    first value differs from one whose value was lost.
    """
    [first] = spec.requirements.values()
    assume(is_spoken_of(spec))
    assume(first.at_end not in (EndPolicy.PASS, EndPolicy.FAIL))
    required = replace(first, trigger=start, mode=Mode.UPON, pulse=False)
    spec = structs.replace(spec, requirements={required.id: required})
    case = known_from_the_first(data.draw(traces(spec)))
    before = outcomes(judge(case))
    after = outcomes(judge(refilled(rng, case)))
    assert set(before) == set(after)
    for key, outcome in before.items():
        if outcome.decided is not None:
            assert after[key].verdict == outcome.verdict
            assert after[key].decided is not None
            assert after[key].decided <= outcome.decided
            if outcome.decision is Decision.PREFIX:
                assert after[key].decision is Decision.PREFIX


@TRIED
@given(cases(Profile(), TraceProfile(outages=35)), st.randoms(use_true_random=False))
def test_no_values_for_lost_samples_overturn_a_pass(case: Case, rng: Random) -> None:
    assume(is_spoken_of(case.spec))
    assert overturned(rng, case, 4, judge).overturning is None
