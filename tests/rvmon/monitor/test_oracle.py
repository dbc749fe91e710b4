"""Robustness against its oracle, and its sign against the verdict, on random cases."""

import pytest
from tests.tools.build import actions
from tests.tools.compare import key_of
from tests.tools.differential import case_of
from tests.tools.drive import Found, Lost, feed, told
from tests.tools.each import each
from tests.tools.judgement import Judgement

from rvmon import loads
from rvmon.language.checked.specification import Mode, TimeModel
from rvmon.monitor.robustness import RobustnessMonitor
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, show_case
from rvmon.testing.law.margins import margins
from rvmon.testing.law.word import Outage
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision

pytestmark = pytest.mark.law

PAIRS = 30


def measured(case):
    """The figures of the engine during the case, by attempt.

    The bounds of an open attempt may only become tighter, up to its final figure.
    """
    monitor = RobustnessMonitor(Spec(case.spec)._compiled, sources=case.names)
    found, bounds = {}, {}
    for action in told(case):
        match action:
            case Lost(names, t):
                said = monitor.lose_ns(names, t)
            case Found(names, t):
                said = monitor.found_ns(names, t)
            case _:
                said = feed(monitor, action)
        for one in said or ():
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


def by_oracle(case):
    judgement = Judgement(case)
    return margins(judgement.followings, judgement.outcomes, case.spec.time)


def assert_within(later, earlier, case):
    """Later bounds are within earlier ones."""
    if earlier is not None:
        assert earlier.low <= later.low <= later.high <= earlier.high, show_case(case)


def fits(attempt, low, high, kept, *, says_nothing):
    """Whether figures that are not 0 have the sign of a verdict.

    An episode may pass without a meaningful figure if a part of it had no value.
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
        case = case_of(f"margins {number}", Profile(time=time), TraceProfile(outages=20))
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


INFINITE = float("inf")
RARE = {
    "before the first sample nothing was true of a signal yet to come: it never rose and fell": (
        *("held", "upon start then always not fall(rise(p))", "0; 2!", None, ()),
        [(-INFINITE, INFINITE)],
    ),
    "an attempt is measured in the piece of the trace in which it begins": (
        *("sampled", "upon start then for 9 ns x <= 5", "0 x=2; 1 x=3; 4 x=4; 6 x=1", 20),
        *((("x", 2, 3),), [(-INFINITE, 2.0)]),
    ),
    "what lies beyond an outage may be anything to what looks back": (
        *("sampled", "upon e then H[0 ns, 2 ns] x <= 5", "0 x=2; 4 x=4 e; 6 x=1 e", 20),
        *((("x", 2, 3),), [(-INFINITE, 1.0), (1.0, 1.0)]),
    ),
    "an event that is lost between samples may have occurred, unknown before or not": (
        *("held", "upon start then for 3 ns h.m < 5", "-3 h=/?", 3, (("h", -2, -1),)),
        [(-INFINITE, -INFINITE)],
    ),
    "the same up to the end": (
        *("held", "upon start then for 1 ns h.m < 5", "-3 h=/?", -2, (("h", -2, -2),)),
        [(-INFINITE, INFINITE)],
    ),
    "an outage does not hide that something was false before it": (
        *("sampled", "upon e then false since[1 ns, inf) g.k != 1", "0; 5 x=5 e; 9!", None),
        *((("", 2, 3),), [(-INFINITE, -INFINITE)]),
    ),
    "nor that the trace had begun": (
        *("sampled", "upon e then held(x >= 2 or F[1 ns, 1 ns] x >= 9, 1 ns)"),
        *("0; 5 x=5 e; 9!", None, (("", 2, 3),), [(3.0, 3.0)]),
    ),
    "a trace that may begin in an outage has held nothing for sure": (
        *("sampled", "upon start then held(true, 1 ns) for each one in g.k", "6 g=2", None),
        *((("", 4, 4),), []),
    ),
}
"""Time, requirement, what is told, the end, what was lost; the figures of what is sure."""


@each("name", RARE)
def test_a_rare_case_is_measured_as_the_law_has_it(name):
    time, required, said, end, lost, figures = RARE[name]
    text = f"time {time}\nsignal p : bool\nsignal x : real\nevent e\nevent g(k: int)\n"
    spec = loads(f"{text}event h(m: real)\nrequirement R\n  {required}\n")
    outages = tuple(Outage(frozenset({own} - {""}), first, last) for own, first, last in lost)
    case = Case(spec.checked, actions(said), end, outages=outages)
    found, _ = measured(case)
    assert found == by_oracle(case)
    assert [one[:2] for key, one in sorted(found.items()) if not key[1]] == figures


@each("value", [INFINITE, -INFINITE])
@each("compare", ["<=", "<", ">=", ">", "==", "!="])
@each("time", ["held", "sampled"])
def test_equal_infinities_are_nothing_apart(time, compare, value):
    text = f"time {time}\nsignal x, y : real\nevent q\nrequirement Q\n"
    spec = loads(f"{text}  upon q then immediately x {compare} y\n")
    values = {"x": value, "y": value, "q": True}
    case = Case(spec.checked, (Sample(0, values), Sample(1, {"x": 1.0, "y": 2.0})))
    columns = {"t": [0, 1], "x": [value, 1.0], "y": [value, 2.0], "q": [1, 0]}
    of_rows = [(one.low, one.high, one.kept) for one in spec.robustness(columns).attempts.values()]
    figures = [*of_rows, *measured(case)[0].values(), *by_oracle(case).values()]
    assert figures == [(0.0, 0.0, 0.0)] * 3
