"""Robustness against its oracle, and its sign against the verdict, on random cases."""

import pytest

from rvmon.monitor.robustness import MarginMonitor
from rvmon.session import Spec
from rvmon.spec.checked import TimeModel
from rvmon.testing.differential import case_of, judge
from rvmon.testing.drive import drive
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile
from rvmon.testing.margins import margins
from rvmon.testing.show import show_case
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict

PAIRS = 90


def measured(case):
    """What the engine finds, by requirement and number."""
    compiled = Spec(case.spec)._compiled
    monitor = MarginMonitor(compiled, list(compiled.requirements.values()), case.names)
    drive(monitor, case)
    return {
        key: (found.low, found.high, found.kept)
        for key, found in monitor.margins_ns(None).attempts.items()
    }


def fits(attempt, low, high, kept):
    """Whether figures have the sign of a verdict, where they are not 0."""
    match attempt.decision, attempt.verdict:
        case Decision.PREFIX, Verdict.PASS:
            return low >= 0
        case Decision.PREFIX, Verdict.FAIL:
            return high <= 0
        case Decision.HELD_TO_END, _:
            return kept >= 0
        case Decision.OPEN, _:
            return low <= 0 <= high
        case _:
            return True


@pytest.mark.parametrize("time", TimeModel)
def test_engine_and_oracle_agree(time):
    """Each attempt has the oracle's least and greatest value, and the sign of its verdict."""
    finite = 0
    for number in range(PAIRS):
        case = case_of(f"margins {number}", Profile(time=time), TraceProfile())
        expected = margins(case)
        assert measured(case) == expected, show_case(case)
        for attempt in judge(case).attempts:
            figures = expected[attempt.requirement, attempt.number]
            assert fits(attempt, *figures), show_case(case)
            finite += any(abs(figure) < float("inf") for figure in figures)
    assert finite > 5
