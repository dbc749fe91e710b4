"""Online monitors run by the core, as users of `Spec.monitor()` see them."""

import math
from enum import StrEnum
from fractions import Fraction
from types import MappingProxyType

import numpy as np
import pytest
from tests.tools.compare import outcomes
from tests.tools.each import each
from tests.tools.law import judge

import rvmon
from rvmon.errors import TimeOrderError, TraceError
from rvmon.monitor.intake import Validator
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample
from rvmon.trace.time import ticks_of_seconds

SPEC = """
spec watch "A base"
time held
signal p, q : bool
signal speed : real
signal count : int
signal mode : {red, green}
event stop
event pick(id: int, weight: real, color: {red, blue})
requirement R1 "a"
  upon rise(p)
  then within 3 s q
requirement R2 "b"
  always (speed < 2 or mode == red)
requirement R3 "c"
  upon pick.id > 2 and pick.weight < 1.5 and pick.color == red
  then within 1 s (count > 3 or stop)
"""

FIRST = {"p": False, "q": False, "speed": 1.0, "count": 0, "mode": "green"}


@pytest.fixture
def spec() -> rvmon.Spec:
    return rvmon.loads(SPEC)


def told(attempts):
    return [(a.requirement, a.number, a.triggered, a.decided, a.verdict.value) for a in attempts]


def both(spec, samples, end=None, **how):
    """Step a monitor whose core reads the samples and one for which Python does; they must agree.

    The core leaves mappings that are not a dict to Python. Returns what the steps decided.
    """
    fast, slow = spec.monitor(**how), spec.monitor(**how)
    found = []
    for t, values in samples:
        due = fast.next_due
        mine, other = fast.step_ns(t, values), slow.step_ns(t, MappingProxyType(values))
        assert told(mine) == told(other)
        if how.get("settle") != "next" and (due is None or t < due):
            assert all(attempt.decided >= t for attempt in mine), "decided before it was due"
        assert told(sorted(fast.open, key=order)) == told(sorted(slow.open, key=order))
        found += told(mine)
    mine, other = fast.finish_ns(end), slow.finish_ns(end)
    assert mine.verdicts == other.verdicts
    assert mine.counts == other.counts
    assert told(mine.attempts) == told(other.attempts)
    assert (mine.origin, mine.end) == (other.origin, other.end)
    return found


def agrees_with_the_law(samples):
    """Whether a run is judged as the oracle judges it, with ticks of half a second."""
    spec = rvmon.loads(SPEC.replace("3 s", "6 ns").replace("1 s", "2 ns"))
    check = Validator(spec.checked, None, frozenset()).check
    monitor = spec.monitor()
    for t, values in samples:
        monitor.step_ns(2 * t // S, values)
    read = tuple(Sample(2 * t // S, check(2 * t // S, values)) for t, values in samples)
    found = outcomes(monitor.finish())
    return bool(found) and found == outcomes(judge(Case(spec.checked, read, None)))


def order(attempt):
    return attempt.requirement, attempt.number


S = 1_000_000_000


def test_a_step_returns_the_records_that_it_decides(spec):
    samples = [
        (0, FIRST),
        (S, {"p": True}),
        (2 * S, {"q": True}),
        (3 * S, {"p": False, "q": False}),
        (4 * S, {"p": True, "pick": {"id": 3, "weight": 1.0, "color": "red"}}),
        (9 * S, {"speed": 3.5}),
        (10 * S, {"pick": True, "stop": True}),
        (11 * S, {"pick": None, "count": 4}),
    ]
    found = both(spec, samples, 12 * S)
    assert found == [
        ("R1", 1, S, 2 * S, "P"),
        ("R3", 1, 4 * S, 5 * S + 1, "F"),
        ("R1", 2, 4 * S, 7 * S + 1, "F"),
        ("R2", 1, 0, 9 * S, "F"),
    ]


def test_all_kinds_of_values_are_judged_as_the_law_has_it(spec):
    values = [
        {"speed": 3},
        {"speed": np.float64(1.5), "p": np.bool_(True)},
        {"speed": np.float32(2.5), "count": np.int64(7)},
        {"speed": math.nan},
        {"speed": None, "mode": None},
        {"mode": "red"},
        {"pick": {"id": 3, "weight": np.float64(0.5), "color": "red"}},
        {"pick": {"id": None, "color": "blue"}},
        {"pick": ({"id": 5, "weight": 1, "color": "red"},)},
        {"pick": (), "stop": False},
        {"pick": False, "stop": True},
        {"q": True, "p": None, "count": None},
    ]
    samples = [(0, FIRST), *((number * S // 2, row) for number, row in enumerate(values, 1))]
    both(spec, samples)
    assert agrees_with_the_law(samples)


class Row(dict):
    """A subclass of dict."""


class Name(StrEnum):
    """Names of a subclass of str."""

    P = "p"
    PICK = "pick"
    ID = "id"


def test_subclasses_of_dict_and_str_are_accepted(spec):
    samples = [
        (0, Row(FIRST)),
        (S, {Name.P: True}),
        (2 * S, Row({Name.PICK: {Name.ID: 3}})),
        (3 * S, {np.str_("q"): True}),
    ]
    assert both(spec, samples) == [("R1", 1, S, 3 * S, "P")]


@each(
    ("t", "values", "error", "text"),
    [
        (S, {}, TimeOrderError, "is not after the one at 1 s"),
        (0, {}, TimeOrderError, "is not after the one at 1 s"),
        (2 * S, {"z": True}, TraceError, "no signal or event named `z`"),
        (2 * S, {"p": 2}, TraceError, "`p`: expected True or False, found 2"),
        (2 * S, {"count": 1.5}, TraceError, "`count`: expected a whole number"),
        (2 * S, {"count": True}, TraceError, "`count`: expected a whole number"),
        (2 * S, {"mode": "blue"}, TraceError, "`mode`: expected one of red, green"),
        (2 * S, {"stop": 2}, TraceError, "`stop` is an event"),
        (2 * S, {"stop": {"x": 1}}, TraceError, "has no field `x`"),
        (2 * S, {"pick": {"id": "a"}}, TraceError, "`pick.id`: expected a whole number"),
        (2 * S, {"pick": ({"id": 1}, {"id": 2})}, TraceError, "2 payloads of `pick`"),
        (2 * S, {"count": 1 << 63}, TraceError, "`count` is a number too large for 64 bits"),
        (2 * S, {"count": -(1 << 63) - 1}, TraceError, "too large for 64 bits"),
        (2 * S, {"speed": 10**400}, TraceError, "`speed` is a number too large for a double"),
        (2 * S, {"pick": {"id": 1 << 70}}, TraceError, "`pick.id` is a number too large"),
        (2 * S, {1: True}, TraceError, "no signal or event named"),
        (2 * S, [("p", True)], TraceError, "expected values by name"),
        (1 << 62, {}, TraceError, "time"),
        (1 << 70, {}, TraceError, "time"),
        (2.5, {}, TraceError, "whole"),
    ],
)
def test_a_wrong_sample_is_refused_and_the_run_goes_on(spec, t, values, error, text):
    monitor = spec.monitor()
    assert monitor.step_ns(t_ns=S, values=FIRST) == ()
    with pytest.raises(error, match=text):
        monitor.step_ns(t, values)
    assert told(monitor.step_ns(2 * S, {"speed": 5.0})) == [("R2", 1, S, 2 * S, "F")]


@each(
    "seconds",
    [
        *(0.1, 1e-9, 0.3e-9, 0.5e-9, 2**-10, 3 * 2**-10, 1 - 2**-53, 86400.000000001, 1.7e9 + 0.1),
        *(-0.1, -1e-9, -(2**-10), -1.5, -1.7e9 - 0.1, -0.0, 1, -3, 4.4e9, -4.4e9, 4.7e9, -1e300),
        *(math.nan, math.inf, np.float64(0.1), np.float32(0.1), np.int64(7), Fraction(1, 3), "1"),
    ],
)
def test_step_rounds_seconds_like_python(spec, seconds):
    found = []
    for way in ("step", "step_ns"):
        monitor = spec.monitor()
        monitor.step_ns(-(1 << 62) + 1, FIRST)
        try:
            t = seconds if way == "step" else ticks_of_seconds(seconds)
            found.append(told(getattr(monitor, way)(t, {"speed": 3.0})))
        except TraceError as error:
            found.append(str(error))
    assert found[0] == found[1]


def test_a_monitor_can_be_finished_and_reset(spec):
    monitor = spec.monitor()
    assert monitor.open == ()
    assert monitor.next_due is None
    for _ in range(2):
        monitor.step(0.0, FIRST)
        monitor.step(1.0, {"p": True})
        assert [a.requirement for a in monitor.open] == ["R1", "R2"]
        assert monitor.next_due is not None
        assert monitor.advance(4.0) == ()
        assert told(monitor.advance(4.1)) == [("R1", 1, S, 4 * S + 1, "F")]
        with pytest.raises(TimeOrderError, match="none before would come"):
            monitor.step(4.05, {})
        report = monitor.finish(5.0)
        assert report.verdicts == {"R1": "F", "R2": "P", "R3": "NT"}
        assert monitor.finish(6.0) is report
        assert not monitor.open
        assert monitor.next_due is None
        for call in (lambda: monitor.step(7.0, {}), lambda: monitor.advance(7.0)):
            with pytest.raises(TraceError, match="finished"):
                call()
        monitor.reset()


ECHO = """
spec echo
signal p, q : bool
requirement R1
  upon once[1 s, 1 s] p
  then within 1 h q
"""


def knocks(begin: int, count: int) -> list[tuple[int, dict[str, bool]]]:
    """Pulses of `p`, each a millisecond long."""
    return [(begin + n * S // 1000, {"p": n % 2 == 0}) for n in range(2 * count)]


def test_memory_grows_with_open_attempts_and_past_intervals():
    """A gap between samples starts many attempts at once."""
    bursts = [row for n in range(4) for row in knocks(10 * n * S, 300)]
    monitor = rvmon.loads(ECHO).monitor()
    decided = []
    for t, row in [(-9 * S, {"p": False, "q": False}), *bursts, (300 * S, {"q": True})]:
        decided += told(monitor.step_ns(t, row))
    starts = [t + S for t, row in bursts if row["p"]]
    assert decided == [("R1", n, t, 300 * S, "P") for n, t in enumerate(starts, 1)]
