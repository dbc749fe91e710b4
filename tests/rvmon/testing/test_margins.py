"""Robustness against its oracle, and its sign against the verdict, on random cases."""

import pytest

from rvmon.monitor.robustness import RobustnessMonitor
from rvmon.session import Spec
from rvmon.spec.checked import TimeModel
from rvmon.testing.differential import case_of
from rvmon.testing.drive import tell
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile
from rvmon.testing.law import judge
from rvmon.testing.margins import margins
from rvmon.testing.show import show_case
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict

PAIRS = 90


def measured(case):
    """What the engine finds while the case goes on, by requirement and number.

    What is known of an open attempt must only draw closer, up to its figure.
    """
    monitor = RobustnessMonitor(Spec(case.spec)._compiled, sources=case.names)
    found, bounds = {}, {}
    for action in case.actions:
        for one in tell(monitor, action):
            found[one.requirement, one.number] = one.robustness
        for one in monitor.open:
            assert_within(one.robustness, bounds.get((one.requirement, one.number)), case)
            bounds[one.requirement, one.number] = one.robustness
    settled = len(found)
    for one in monitor.finish_ns(case.end):
        found[one.requirement, one.number] = one.robustness
    for key, figures in found.items():
        assert_within(figures, bounds.get(key), case)
    return {key: (one.low, one.high, one.kept) for key, one in found.items()}, settled


def assert_within(later, earlier, case):
    """What is known later lies within what was known earlier."""
    if earlier is not None:
        assert earlier.low <= later.low <= later.high <= earlier.high, show_case(case)


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
    finite = early = 0
    for number in range(PAIRS):
        case = case_of(f"margins {number}", Profile(time=time), TraceProfile())
        expected = margins(case)
        found, settled = measured(case)
        assert found == expected, show_case(case)
        early += settled
        for attempt in judge(case).attempts:
            figures = expected[attempt.requirement, attempt.number]
            assert fits(attempt, *figures), show_case(case)
            finite += any(abs(figure) < float("inf") for figure in figures)
    assert finite > 5
    assert early > 5
