"""Robustness against its oracle, and its sign against the verdict, on random cases."""

import pytest
from tests.tools.compare import key_of
from tests.tools.differential import case_of
from tests.tools.drive import feed
from tests.tools.each import each
from tests.tools.judgement import Judgement

from rvmon import loads
from rvmon.language.checked.specification import Mode, TimeModel
from rvmon.monitor.robustness import RobustnessMonitor
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, show_case
from rvmon.testing.law.margins import margins
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision

pytestmark = pytest.mark.law

PAIRS = 25


def measured(case):
    """What the engine finds while the case goes on, by what tells attempts apart.

    What is known of an open attempt must only draw closer, up to its figure.
    """
    monitor = RobustnessMonitor(Spec(case.spec)._compiled, sources=case.names)
    found, bounds = {}, {}
    for action in case.actions:
        for one in feed(monitor, action):
            found[key_of(one)] = one.robustness
        for one in monitor.open:
            assert_within(one.robustness, bounds.get(key_of(one)), case)
            bounds[key_of(one)] = one.robustness
    settled = len(found)
    for one in monitor.finish_ns(case.end):
        found[key_of(one)] = one.robustness
    for key, figures in found.items():
        assert_within(figures, bounds.get(key), case)
    return {key: (one.low, one.high, one.kept) for key, one in found.items()}, settled


def assert_within(later, earlier, case):
    """What is known later lies within what was known earlier."""
    if earlier is not None:
        assert earlier.low <= later.low <= later.high <= earlier.high, show_case(case)


def fits(attempt, low, high, kept, *, says_nothing):
    """Whether figures have the sign of a verdict, where they are not 0.

    An episode may be met and say nothing, since something of it had no value.
    """
    match attempt.decision, attempt.verdict:
        case Decision.PREFIX, Verdict.PASS:
            return low >= 0
        case Decision.PREFIX, Verdict.FAIL:
            return high <= 0
        case Decision.HELD_TO_END, _:
            return kept >= 0
        case Decision.OPEN, _:
            return (low <= 0 or says_nothing) and high >= 0
        case _:
            return True


@pytest.mark.parametrize("time", TimeModel)
def test_engine_and_oracle_agree(time):
    """Each attempt has the oracle's least and greatest value, and the sign of its verdict."""
    finite = early = doubtful = 0
    for number in range(PAIRS):
        case = case_of(f"margins {number}", Profile(time=time), TraceProfile())
        judgement = Judgement(case)
        expected = margins(judgement.followings, judgement.outcomes, case.spec.time)
        found, settled = measured(case)
        assert found == expected, show_case(case)
        early += settled
        for attempt in judgement.report.attempts:
            figures = expected[key_of(attempt)]
            says_nothing = case.spec.requirements[attempt.requirement].mode is Mode.WHENEVER
            assert fits(attempt, *figures, says_nothing=says_nothing), show_case(case)
            doubtful += attempt.in_doubt
            finite += any(abs(figure) < float("inf") for figure in figures)
    assert min(finite, early, doubtful) > 2


@each("value", [float("inf"), float("-inf")])
@each("compare", ["<=", "<", ">=", ">", "==", "!="])
@each("time", ["held", "sampled"])
def test_equal_infinities_are_nothing_apart(time, compare, value):
    text = f"time {time}\nsignal x, y : real\nevent q\nrequirement Q\n"
    spec = loads(f"{text}  upon q then immediately x {compare} y\n")
    values = {"x": value, "y": value, "q": True}
    case = Case(spec.checked, (Sample(0, values), Sample(1, {"x": 1.0, "y": 2.0})))
    judgement = Judgement(case)
    of_steps, _ = measured(case)
    of_oracle = margins(judgement.followings, judgement.outcomes, case.spec.time)
    columns = {"t": [0, 1], "x": [value, 1.0], "y": [value, 2.0], "q": [1, 0]}
    of_rows = [(one.low, one.high, one.kept) for one in spec.robustness(columns).attempts.values()]
    figures = [*of_rows, *of_steps.values(), *of_oracle.values()]
    assert figures == [(0.0, 0.0, 0.0)] * 3


def test_before_the_first_sample_nothing_was_true_of_a_signal_yet_to_come():
    """What `rise` reads there is surely false, so `p` without a value never rose and fell."""
    spec = loads("signal p : bool\nrequirement Q\n  upon start then always not fall(rise(p))\n")
    case = Case(spec.checked, (Sample(0, {}), 2))
    judgement = Judgement(case)
    of_oracle = margins(judgement.followings, judgement.outcomes, case.spec.time)
    assert of_oracle == measured(case)[0] == {("Q", False, 1): (float("-inf"), *[float("inf")] * 2)}
