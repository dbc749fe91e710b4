"""What was lost at the end of a recording: nobody knows how long it went on."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from tests.tools.law import judge, word
from tests.tools.sound import is_spoken_of

from rvmon.spec.checked.formula import Binary, Formula, Unary, UnaryOp
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.law.outage import Outage
from rvmon.testing.law.walk import subformulas
from rvmon.testing.strategies import cases
from rvmon.verdict.verdict import Verdict

STEPS = (UnaryOp.PREVIOUS, UnaryOp.RISE, UnaryOp.FALL)


def asks_of_earlier(trigger: Formula) -> bool:
    """Whether a part of a trigger speaks of earlier positions alone."""
    return any(
        isinstance(part, Unary | Binary)
        and (part.op in STEPS or (part.interval is not None and part.interval.low > 0))
        for part in subformulas(trigger)
    )


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_one_position_more_is_enough(data: st.DataObject) -> None:
    """With an outage up to the next position what is green or F stays so if the run went on.

    But the policies of `at end` know no better than that it ended there, and a trigger that asks of
    earlier positions alone may come true behind that one.
    """
    profile = Profile(policies=False, stale=False)
    whole = data.draw(cases(profile, TraceProfile(unknowns=False, advances=False)))
    assume(whole.samples and is_spoken_of(whole.spec))
    assume(not any(asks_of_earlier(one.trigger) for one in whole.spec.requirements.values()))
    count = data.draw(st.integers(1, len(whole.samples)))
    last = whole.samples[count - 1].t
    spec = whole.spec
    names = frozenset((*spec.signals, *spec.events))
    tail = Outage(names, last, last + (spec.period or 1))
    assume((word(whole).end or 0) >= tail.last)
    cut = replace(whole, actions=whole.samples[:count], end=None, outages=(tail,))
    before, after = (judge(case, next_law=True).verdicts for case in (cut, whole))
    for name, verdict in before.items():
        if verdict in (Verdict.PASS, Verdict.NOT_TRIGGERED):
            assert after[name] is not Verdict.FAIL
        if verdict is Verdict.FAIL:
            assert after[name] is Verdict.FAIL
