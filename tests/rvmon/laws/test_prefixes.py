"""Decisions do not depend on later samples, on the portions of a trace, or on a shift in time."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.rvmon.laws.tried import TRIED, judge, judged_otherwise, moved
from tests.tools.compare import differences, outcomes
from tests.tools.drive import drive, feed
from tests.tools.law import names_read

from rvmon.language.checked.specification import TimeModel
from rvmon.session import Spec
from rvmon.testing.generate import BOOLS
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.syntax import is_upon_end
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample
from rvmon.verdicts.attempt import Decision
from rvmon.verdicts.report import Report

pytestmark = pytest.mark.law


@TRIED
@given(cases(), st.data())
def test_a_longer_trace_changes_no_decision(case: Case, data: st.DataObject) -> None:
    count = data.draw(st.integers(0, len(case.actions)))
    prefix = judge(replace(case, actions=case.actions[:count], end=None))
    later = outcomes(judge(case))
    for key, outcome in outcomes(prefix).items():
        if outcome.decision is Decision.PREFIX and not is_upon_end(case.spec.requirements[key[0]]):
            assert later[key] == outcome


@TRIED
@given(cases(), st.data())
def test_advancing_between_samples_changes_nothing(case: Case, data: st.DataObject) -> None:
    actions: list[Sample | int] = []
    before: int | None = None
    for action in case.actions:
        instant = action.t if isinstance(action, Sample) else action
        if before is not None:
            middle = st.integers(before, instant)
            actions += sorted(data.draw(st.lists(middle, max_size=2)))
        actions.append(action)
        before = instant
    assert judged_otherwise(case, replace(case, actions=tuple(actions))) == []


@pytest.mark.parametrize("time", [TimeModel.HELD, TimeModel.CLOCKED])
@TRIED
@given(data=st.data())
def test_samples_of_names_that_no_requirement_reads_change_nothing(
    data: st.DataObject, time: TimeModel
) -> None:
    case = data.draw(cases(Profile(time=time)))
    if not case.samples:
        return
    read = {n for one in case.spec.requirements.values() for n in names_read(one, keys=False)}
    others = [name for name in BOOLS if name not in read and case.names is None]
    values = {name: data.draw(st.booleans()) for name in others}
    first, last = case.samples[0].t, case.samples[-1].t
    extra = {*data.draw(st.lists(st.integers(first, last), max_size=5))}
    extra -= {sample.t for sample in case.samples}
    samples = sorted([*case.samples, *(Sample(t, values) for t in extra)], key=lambda one: one.t)
    advances = tuple(t for t in case.advances if t > last)
    assert judged_otherwise(case, replace(case, actions=(*samples, *advances))) == []


@TRIED
@given(cases())
def test_the_order_of_names_in_a_sample_does_not_matter(case: Case) -> None:
    turned = tuple(
        Sample(action.t, dict(reversed(action.values.items())))
        if isinstance(action, Sample)
        else action
        for action in case.actions
    )
    assert judged_otherwise(case, replace(case, actions=turned)) == []


@TRIED
@given(cases())
def test_a_shift_in_time_shifts_the_attempts(case: Case) -> None:
    """In clocked time, for shifts by multiples of the period."""
    shift = 7 * (case.spec.period or 1)
    end = None if case.end is None else case.end + shift
    later = replace(case, actions=moved(case.actions, lambda t: t + shift), end=end)
    assert differences(judge(case), _back(judge(later), shift)) == []


def _back(report: Report, shift: int) -> Report:
    attempts = tuple(
        replace(
            attempt,
            triggered=attempt.triggered - shift,
            decided=None if attempt.decided is None else attempt.decided - shift,
        )
        for attempt in report.attempts
    )
    return replace(report, attempts=attempts)


@TRIED
@given(cases(), st.data())
def test_a_reset_monitor_behaves_like_a_new_one(case: Case, data: st.DataObject) -> None:
    before = data.draw(st.integers(0, len(case.actions)))
    monitor, new = (Spec(case.spec).monitor(sources=case.names) for _ in "12")
    for action in case.actions[:before]:
        feed(monitor, action)
    if data.draw(st.booleans()):
        monitor.finish_ns()
    monitor.reset()
    assert monitor.open == new.open
    assert drive(monitor, case) == drive(new, case)
