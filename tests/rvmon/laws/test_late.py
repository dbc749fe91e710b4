"""What comes too late: no green on letters that it would have changed, no alarm taken back."""

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
    """A case as it was, and as it was judged without one of its samples; not the last."""
    whole = draw(cases(Profile(), TraceProfile(advances=False)))
    assume(len(whole.samples) > 1)
    late = whole.samples[draw(st.integers(0, len(whole.samples) - 2))]
    judged = tuple(sample for sample in whole.samples if sample is not late)
    return whole, replace(whole, actions=judged), late


@TRIED
@given(late_cases())
def test_no_green_hides_a_failure(cases_: tuple[Case, Case, Sample]) -> None:
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
def test_what_reads_none_of_its_names(cases_: tuple[Case, Case, Sample]) -> None:
    whole, judged, late = cases_
    spec = judged.spec
    touched = {
        name: is_touched(spec, one, judged.samples, late) for name, one in spec.requirements.items()
    }
    with_late, without = (outcomes(judge(one)) for one in (whole, judged))
    kept = [{k: v for k, v in one.items() if not touched[k[0]]} for one in (with_late, without)]
    assert kept[0] == kept[1]
