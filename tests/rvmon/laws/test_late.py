"""Samples that arrive too late: no pass that they might overturn, no failure taken back."""

from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.rvmon.laws.tried import TRIED
from tests.tools.compare import outcomes
from tests.tools.law import after_late, is_touched, judge

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict

pytestmark = pytest.mark.law


@st.composite
def late_cases(draw: st.DrawFn) -> tuple[Case, Case, Sample]:
    """A case, the same without one sample (not the last), and that sample."""
    whole = draw(cases(Profile(), TraceProfile(advances=False)))
    assume(len(whole.samples) > 1)
    late = whole.samples[draw(st.integers(0, len(whole.samples) - 2))]
    judged = tuple(sample for sample in whole.samples if sample is not late)
    return whole, replace(whole, actions=judged), late


@TRIED
@given(late_cases())
def test_a_late_sample_leaves_no_false_pass_and_takes_no_failure_back(
    cases_: tuple[Case, Case, Sample],
) -> None:
    whole, judged, late = cases_
    verdicts = judge(judged).verdicts
    with_late = judge(whole).verdicts
    found = after_late(judged.spec, verdicts, judged.samples, [late])
    for name, verdict in found.items():
        if verdict in (Verdict.PASS, Verdict.NOT_TRIGGERED):
            assert with_late[name] is verdict
        assert (verdict is Verdict.FAIL) is (verdicts[name] is Verdict.FAIL)


@TRIED
@given(late_cases())
def test_untouched_requirements_have_the_same_attempts(cases_: tuple[Case, Case, Sample]) -> None:
    whole, judged, late = cases_
    spec = judged.spec
    touched = {
        name
        for name, requirement in spec.requirements.items()
        if is_touched(spec, requirement, judged.samples, late)
    }
    with_late, without = (
        {key: found for key, found in outcomes(judge(case)).items() if key[0] not in touched}
        for case in (whole, judged)
    )
    assert with_late == without
