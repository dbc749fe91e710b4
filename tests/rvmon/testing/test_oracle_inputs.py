"""Signals, events, payloads, probes and numbers, worked out by hand from SEMANTICS 1 and 2."""

from typing import Any

import pytest
from tests.tools.build import (
    always,
    compared,
    e,
    eventually,
    f,
    g,
    k,
    no,
    p,
    probe,
    q,
    requirement,
    spec_of,
    two,
    x,
)
from tests.tools.each import each

from rvmon.errors import TimeOrderError, TraceError
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import (
    Arithmetic,
    Formula,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.language.checked.specification import TimeModel
from rvmon.testing.law.sample_words import MOST_TICKS
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample, Trace

ALL = frozenset({"p", "q", "r", "x", "y", "mode", "e", "f", "g"})
ABSENT = ALL - {"p", "x", "e", "g"}
SUM_OF_7 = compared(Arithmetic(NumericOp.ADD, (k, x)), "==", 7)


def at(judge: Any, formula: Formula, instant: int, **told: Any) -> str:
    """The verdict of a formula at one instant, where the event f is made to occur."""
    row = "." * instant + "1"
    [attempt] = judge(requirement(formula, upon=f), f=row, **told)
    return attempt.split()[1]


def of_updates(function: str, name: str = "x") -> Numeric:
    return UpdateValue(UpdateFunction(function), name)


@pytest.mark.slow
@each(
    ("formula", "instant", "told", "expected"),
    [
        # A signal holds its last value.
        (p, 4, {"p": "1"}, "P"),
        # Before its first value it is unknown, and after None.
        (p, 1, {"q": "1", "p": "..1"}, "I"),
        # An event is true at its tick only.
        (e, 1, {"e": ".1"}, "P"),
        (e, 2, {"e": ".1"}, "F"),
        # Labels.
        (compared(SignalValue("mode"), "==", "red"), 1, {"mode": "r"}, "P"),
        # A bool as a number.
        (compared(SignalValue("p"), "==", 1), 1, {"p": "1"}, "P"),
        # An update is any entry in a sample; `changed` compares the last two.
        (probe("updated", "x"), 1, {"x": ".5"}, "P"),
        (probe("updated", "e"), 1, {"e": ".1"}, "P"),
        # The first update changes nothing; the same value neither; then only at its tick.
        (probe("changed", "x"), 0, {"x": "5"}, "F"),
        (probe("changed", "x"), 2, {"x": "5.5"}, "F"),
        (probe("changed", "x"), 2, {"x": "5.6"}, "P"),
        (probe("changed", "x"), 3, {"x": "5.6"}, "F"),
        (probe("changed", "x"), 1, {"x": "5u7"}, "I"),
        # A stale value is still the value of the last update.
        (probe("changed", "x"), 9, {"x": "5........6", "stale": {"x": 2}}, "P"),
        # `prev`, `delta` and `rate` speak of the last two updates.
        # The last two updates of x, however many ticks and other samples lie between.
        (compared(of_updates("prev"), "==", 5), 7, {"x": "5..7", "p": "1.0.1"}, "P"),
        (compared(of_updates("delta"), "==", 2), 3, {"x": "5..7"}, "P"),
        # 2 in 4 ns is 5e8 per second.
        (compared(of_updates("rate"), "==", 500_000_000), 4, {"x": "5...7"}, "P"),
        # Unknown before the second update, if either value is, or x itself is stale.
        (compared(of_updates("prev"), "==", 5), 2, {"x": "5..7"}, "I"),
        (compared(of_updates("prev"), "==", 5), 2, {"x": "57u"}, "I"),
        (compared(of_updates("prev"), "==", 5), 3, {"x": "57", "stale": {"x": 2}}, "P"),
        # What has no source is unknown throughout, an event as well, and never false.
        (p, 2, {"q": "1", "names": ABSENT}, "I"),
        (no(e), 2, {"q": "1", "names": ABSENT}, "I"),
        (compared(k, ">", 3), 2, {"q": "1", "names": ABSENT}, "I"),
        (probe("updated", "p"), 2, {"q": "1", "names": ABSENT}, "I"),
        (two(e, "or", q), 2, {"q": "1", "names": ABSENT}, "P"),
        # A comparison of a payload field is false, not unknown, where the event does not occur.
        (compared(k, ">", 3), 1, {"p": "1", "g": ".."}, "F"),
        # It occurs without the field, or with None: unknown.
        (compared(k, ">", 3), 1, {"p": "1", "g": ".t"}, "I"),
        # Whether it occurs is not known: neither is the comparison.
        (compared(k, ">", 3), 1, {"p": "1", "g": ".u"}, "I"),
        # With an unknown other side: false without an occurrence, else unknown.
        (compared(k, ">", x), 1, {"p": "1", "g": ".."}, "F"),
        (compared(k, ">", x), 1, {"p": "1", "g": ".5"}, "I"),
        # It is false again at the next instant, and may mix a field with a signal's held value.
        (compared(k, "==", 5), 2, {"g": ".5"}, "F"),
        (SUM_OF_7, 1, {"x": "2", "g": ".5"}, "P"),
        (SUM_OF_7, 1, {"x": "2", "g": ".4"}, "F"),
        (SUM_OF_7, 1, {"x": "2", "g": "5"}, "F"),
        # With `stale after 2` an update at t is good up to t + 2 and unknown from t + 3.
        *(
            (formula, instant, {"p": row, "stale": {"p": 2}, "time": time}, verdict)
            for time in (TimeModel.HELD, TimeModel.SAMPLED)
            for row, instant in (("1", 2), ("1.1", 4))
            for formula, verdict in ((p, "P"), (probe("known", "p"), "P"))
        ),
        *(
            (formula, instant, {"p": row, "stale": {"p": 2}, "time": time}, verdict)
            for time in (TimeModel.HELD, TimeModel.SAMPLED)
            for row, instant in (("1", 3), ("1.1", 5))
            for formula, verdict in ((p, "I"), (probe("known", "p"), "F"))
        ),
    ],
)
def test_values(judge: Any, formula: Formula, instant: int, told: Any, expected: str) -> None:
    """Signals hold, events do not, and what was never told is unknown."""
    assert at(judge, formula, instant, **told) == expected


def test_staleness_needs_no_sample(judge: Any) -> None:
    """A signal becomes stale by time alone, and that is seen at once."""
    stale = eventually(no(probe("known", "p")), 0, 9)
    assert judge(stale, p="1", stale={"p": 2}, end=5) == ["0 P 3"]
    assert judge(stale, p="1", stale={"p": 2}, end=2) == ["0 I"]


def test_absent_trigger(judge: Any) -> None:
    """A trigger that is unknown throughout may hide attempts."""
    assert judge(requirement(p, upon=e), p="1..0", names=ALL - {"e"}) == ["0 I"]


def test_an_event_that_is_said_not_to_be_has_no_field(judge: Any) -> None:
    assert judge(compared(k, "==", 5), samples=[Sample(0, {"g": False})]) == ["0 F 0"]


@pytest.mark.parametrize(
    ("op", "verdicts"),
    [("<", "PFF"), ("<=", "PPF"), ("==", "FPF"), ("!=", "PFP"), (">=", "FPP"), (">", "FFP")],
)
def test_comparisons(judge: Any, op: str, verdicts: str) -> None:
    got = [judge(compared(x, op, 5), x=value)[0].split()[1] for value in "456"]
    assert "".join(got) == verdicts


def test_infinite_value(judge: Any) -> None:
    """An infinite value compares as a number; what is computed from it is unknown."""
    samples = [Sample(0, {"x": float("inf")})]
    assert judge(compared(x, ">", 5), samples=samples) == ["0 P 0"]
    difference = Arithmetic(NumericOp.SUB, (x, Literal(1)))
    assert judge(compared(difference, ">", 5), samples=samples) == ["0 I"]


def test_clock_gathers(judge: Any) -> None:
    """To a tick of the clock falls all that came after the tick before."""

    def attempts(formula: Formula, **rows: str) -> list[str]:
        told = {**rows, "time": TimeModel.CLOCKED, "period": 3, "end": 9}
        return judge(requirement(p, upon=formula), p="1", **told)

    assert attempts(e, e="....1") == ["6 P 6"]
    assert attempts(e, e="...11") == ["3 P 3", "6 P 6"]
    assert attempts(e, e="....11") == ["6 P 6"]
    assert attempts(e, e="....u0") == []
    assert attempts(e, e="....u1") == ["6 P 6"]
    assert attempts(compared(k, "==", 4), g="....45") == ["6 P 6"]
    assert attempts(compared(k, "==", 4), g="....54") == ["6 P 6"]
    assert attempts(probe("changed", "x"), x="5...75") == ["6 P 6"]
    assert attempts(probe("updated", "x"), x="5..5") == ["0 P 0", "3 P 3"]


def test_events_before_the_first_tick(judge: Any) -> None:
    """What came before the first tick of the clock belongs to it."""
    told = {"time": TimeModel.CLOCKED, "period": 5, "end": 5}
    assert judge(requirement(p, upon=e), p=".1", e="..1", **told) == ["5 P 5"]


def test_negative_times(judge: Any) -> None:
    """Multiples of the period are counted from zero, below it as well."""
    samples = [Sample(-4, {"p": True}), Sample(-1, {"p": False})]
    told = {"time": TimeModel.CLOCKED, "period": 3}
    assert judge(always(p, 0, 3), samples=samples, end=0, **told) == ["-3 F 0"]


def test_several_payloads_need_for_each() -> None:
    """Two payloads of one event at one instant are refused without a `for each`."""
    spec = spec_of(requirement(p, upon=g))
    with pytest.raises(TraceError, match="2 payloads of `g`"):
        evaluate(spec, [Sample(0, {"g": ({"k": 1}, {"k": 2})})])


def test_wrong_traces() -> None:
    spec = spec_of(requirement(p))
    with pytest.raises(TimeOrderError, match="3 ns after one at 3 ns"):
        evaluate(spec, [(3, {}), (3, {})])
    with pytest.raises(TraceError, match="scale durations"):
        evaluate(spec, [(0, {}), (MOST_TICKS + 1, {})])
    with pytest.raises(TraceError, match="`p`, which has no source"):
        evaluate(spec, [(0, {"p": True})], names=frozenset({"q"}))


def test_trace_brings_end_and_names() -> None:
    spec = spec_of(requirement(two(eventually(p, 0, 3), "and", no(e))))
    samples = (Sample(0, {"p": False}),)
    assert evaluate(spec, Trace(samples, end=4)).verdicts["R"] == "F"
    names = ALL - {"e"}
    assert evaluate(spec, Trace(samples, names, 2)).verdicts["R"] == "I"
    assert evaluate(spec, Trace(samples, end=4), end=9).attempts[0].decided == 4


def test_accepts_a_public_spec() -> None:
    class Loaded:
        checked = spec_of(requirement(p))

    assert evaluate(Loaded(), [(0, {"p": True})]).verdicts["R"] == "P"
