"""Robustness as users ask for it."""

import copy
import doctest
import pickle
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest
from tests.tools.build import actions
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError, UnknownNameError

HEAD = "spec s\nsignal x, y : real [cm]\nsignal p : bool\nevent e\nrequirement R1\n  "
INFINITE = float("inf")
S = 1_000_000_000


RISING = "0 x=2 e -p; 1 x=4 e p; 2 x=6 e p; 3 x=8 e p"
FIGURES = [
    # In base units; the best value of the window counts, even after the decision.
    ("held", "upon e then within 3 ns x > 10 cm", "0 x=2 e; 1 x=12; 2 x=30; 9 x=99", 0.2, 0.2),
    # The end of the trace leaves windows open.
    ("held", "upon e then within 3 ns x > 10 cm", "0 x=3 e; 2", -0.07, INFINITE),
    # The distance of a bool is infinite.
    ("held", "upon e then immediately p", "0 p e", INFINITE, INFINITE),
    # Unknown values may be anything.
    ("held", "upon e then for 3 ns x < 10 cm", "0 x=3 e; 1 ?x; 2 x=5; 9", -INFINITE, 0.05),
    # The state that ends an episode does not count for it.
    ("held", "whenever p then immediately x < 10 cm", "0 p x=3; 1 -p x=99", 0.07, 0.07),
    # A value that was never known does not count as true below a past operator.
    ("held", "upon start then once (x <= 5 cm and p)", "0 x=1", -INFINITE, INFINITE),
    ("held", "upon start then once (x <= -5 cm and p)", "0 x=1", -INFINITE, -INFINITE),
    # At the first position nothing has been held yet, whatever its distance.
    ("held", "upon start then held(not (y > x), 1 ns)", "0 x=0 y=1", -INFINITE, -INFINITE),
    # An excuse of an episode is measured together with the time before it.
    (
        *("sampled", "whenever e and fall(p) then within 4 ns x > v let v = 3 cm"),
        *("0 p x=1; 1 -p e; 2 x=2; 9", -0.01, -0.01),
    ),
    # Values after the last tick of a clock are never seen.
    ("sampled every 4 ns", "upon end then x <= 2 cm", "0 x=1; 5 x=3", 0.01, 0.01),
    *(
        ("held", f"upon e then x {op} y", "0 x=500 y=500; 1 y=200; 2 e", low, low)
        for op, low in (("==", -3), ("!=", 3), ("<", -3), (">=", 3))
    ),
    *(
        (time, f"upon end then {required}", RISING, low, low)
        for time, required, low in (
            ("held", "count(e, 3 ns) <= 2", -2),
            ("held", "max(x, 3 ns) - min(x, 3 ns) <= 4 cm", -0.02),
            ("held", "abs(delta(x, 3 ns)) <= 10 cm", 0.04),
            ("held", "x >= mean(last(2, x))", 0.01),
            ("sampled", "mean(x, 3 ns) >= 3 cm", 0.02),
            ("sampled every 1 ns", "duration(p, 3 ns) <= 1 ns", -1e-9),
            # There is no distance if the value moves between samples.
            ("held", "integral(x, 3 ns) / 1 ns >= -1 cm", INFINITE),
        )
    ),
]


@each(("time", "required", "told", "low", "high"), FIGURES)
def test_a_figure_lies_between_the_least_and_the_greatest(time, required, told, low, high):
    spec = rvmon.loads(HEAD.replace("spec s", f"spec s\ntime {time}") + f"{required}\n")
    samples = [(one.t * 1e-9, one.values) for one in actions(told)]
    found = spec.robustness(samples).attempts["R1", 1]
    assert (found.low, found.high) == (pytest.approx(low), pytest.approx(high))


def test_what_is_held_to_the_end_is_measured_to_the_end_and_a_stream_at_each_sample():
    samples = [(0, {"x": 3}), (1, {"x": 12}), (2, {"x": 5})]
    spec = rvmon.loads(HEAD + "always x < 10 cm\n")
    *_, attempt = spec.evaluate(samples).attempts
    found = spec.robustness(samples)
    assert found.attempts["R1", 1].low == -INFINITE
    assert found.of(attempt).robustness == pytest.approx(0.05)
    assert [(t, one.kept) for t, one in found.streams["R1"]] == [
        (0, pytest.approx(-0.02)),
        (10**9, pytest.approx(-0.02)),
        (2 * 10**9, pytest.approx(0.05)),
    ]


def test_an_attempt_in_doubt_has_a_figure_if_it_has_a_record():
    """An attempt in doubt may not exist; one that was met in doubt is not measured."""
    samples = [(0, {"e": None, "x": 3}), (1, {"x": 5})]
    found, met = (
        rvmon.loads(f"{HEAD}upon e then x {op} 10 cm\n").robustness(samples) for op in "><"
    )
    assert not found.attempts
    assert found.doubtful["R1", 1].low == pytest.approx(-0.07)
    assert found.doubtful["R1", 1].high == INFINITE
    assert not met.doubtful


def online(requirement, **options):
    return rvmon.loads(HEAD + requirement + "\n").robustness_monitor(**options)


def test_a_figure_is_given_as_soon_as_its_window_is_over():
    monitor = online("upon e then within 3 s x > 10 cm")
    assert not monitor.step(0, {"x": 2, "e": True})
    assert not monitor.step(1, {"x": 12})
    [known] = monitor.open
    assert (known.number, known.robustness.low) == (1, pytest.approx(0.02))
    assert known.robustness.high == INFINITE
    [found] = monitor.step(4, {"x": 50})
    assert (found.requirement, found.number, found.t) == ("R1", 1, 0)
    assert found.robustness.low == found.robustness.high == pytest.approx(0.02)
    assert not monitor.open
    monitor.step(5, {"x": 2, "e": True})
    assert not monitor.advance(8)
    [found] = monitor.advance(8.5)  # by time alone
    assert found.robustness.high == pytest.approx(-0.08)
    assert not monitor.finish()


def test_a_stream_is_given_as_it_goes():
    monitor = online("always within 1 s x > 10 cm", streams=True)
    assert not [one for t in range(4) for one in monitor.step(t, {"x": 10 + t}) if one.number]
    assert [one.t for one in monitor.finish() if one.number is None] == [0, S, 2 * S, 3 * S]
    monitor = online("upon e then within 1 s x > 10 cm", streams=True)
    found = [one for t in range(4) for one in monitor.step(t, {"x": 10 + t})]
    figures = [(one.t, one.robustness.low) for one in found]
    assert figures == [(0, pytest.approx(0.01)), (S, pytest.approx(0.02))]


@pytest.mark.slow
@each("time", ["held", "sampled"])
@each(
    "requirement",
    [
        "upon e then within 50 ms x > 10 cm",
        "upon e then (x > 1 cm) until (x > 20 cm)",
        "upon e then (always x > 0 cm) and within 50 ms p",
        "always within 50 ms x > 10 cm",
        "upon e then immediately once[0, 50 ms] x > 10 cm",
    ],
)
def test_memory_does_not_grow_with_the_run(time, requirement):
    text = HEAD.replace("spec s\n", f"spec s\ntime {time}\n") + requirement + "\n"
    monitor = rvmon.loads(text).robustness_monitor()
    sizes = []
    for step in range(3000):
        monitor.step_ns(step * 5_000_000, {"x": step * 7 % 13, "e": step == 0, "p": False})
        if step in (299, 2999):
            sizes.append(monitor._core.memory_used())
    assert sizes[1] == sizes[0]


def test_a_way_to_settle_that_there_is_not_is_refused():
    with pytest.raises(UnknownNameError, match="expected 'now' or 'next'"):
        online("always p", settle="soon")


def test_the_page_about_it_is_true():
    page = Path(__file__).parents[3] / "docs" / "reference" / "robustness.md"
    failures, tried = doctest.testfile(str(page), module_relative=False)
    assert (failures, tried > 4) == (0, True)


def test_a_number_that_no_double_holds_is_refused():
    monitor = online("upon e then within 3 s x > 1 cm")
    monitor.step(0, {"x": 1.0, "e": True})
    with pytest.raises(TraceError, match="too large for a double"):
        monitor.step(1, {"x": 10**400})
    monitor.step(2, {"x": 5.0})
    [measured] = monitor.finish(9)
    assert measured.robustness.low == pytest.approx(0.04)


@each(
    ("x", "y", "low"),
    [
        (2**53 + 1, 2**53, -1.0),
        (2**63 - 1, -(2**63), -float(2**64)),
        (-(2**63), 2**63 - 1, float(2**64)),
        (2**63 - 1, 2**63 - 2, -1.0),
    ],
)
def test_whole_numbers_are_subtracted_exactly(x, y, low):
    """Their difference is rounded once."""
    spec = rvmon.loads("spec s\nsignal x, y : int\nevent e\nrequirement R1\n  upon e then x < y\n")
    [found] = spec.robustness_monitor().step(0, {"x": x, "y": y, "e": True})
    assert found.robustness.low == low


def test_what_captures_values_and_what_does_not_is_given_in_order():
    head = "spec s\nsignal x : real\nsignal p : bool\nevent e\n"
    texts = [
        "requirement R1\n  upon rise(p)\n  then within 2 s x > 5\n",
        "requirement R2\n  upon e then for 1 s x < v\n  let v = 7\n",
        "requirement R3\n  whenever x > 3\n  then within 1 s p\n",
    ]
    samples = [
        (t, {"x": float(t * 7 % 11), "p": t % 3 == 0, **({"e": True} if t % 4 == 1 else {})})
        for t in range(40)
    ]

    def told(text):
        monitor = rvmon.loads(head + text).robustness_monitor(streams=True)
        found = [(t, one) for t, values in samples for one in monitor.step(t, values)]
        return [*found, *((None, one) for one in monitor.finish())]

    together = told("".join(texts))
    for name, text in zip(("R1", "R2", "R3"), texts, strict=True):
        assert [entry for entry in together if entry[1].requirement == name] == told(text)
    assert len({one.requirement for t, one in together if t is not None}) == 3


def test_an_attempt_that_becomes_certain_in_one_call_has_its_final_number():
    """Not its number among those in doubt."""
    spec = rvmon.loads(
        "spec s\nsignal q : bool stale after 1 ns\nevent g(k : int)\nrequirement R1\n"
        "  whenever q or g.k == each\n  then true\n  for each each in g.k\n"
    )
    monitor = spec.robustness_monitor()
    found = [*monitor.step_ns(0, {"q": False, "g": {"k": 0}})]
    found += [*monitor.step_ns(3, {"g": {"k": 0}}), *monitor.finish()]
    assert [(one.number, one.t, one.in_doubt) for one in found] == [(1, 0, False), (2, 2, False)]


def test_a_figure_is_a_value():
    monitor = rvmon.loads(f"{HEAD}upon start then x <= 2 cm").robustness_monitor(streams=True)
    attempt, position = monitor.step_ns(0, {"x": 1.0})
    assert (attempt.number, position.number) == (1, None)
    assert position == type(position)("R1", None, 0, type(position.robustness)(0.01, 0.01, 0.01))
    assert hash(position) == hash(copy.deepcopy(position))
    assert pickle.loads(pickle.dumps(position)) == position != attempt  # noqa: S301 - ours
    with pytest.raises(AttributeError, match="robustness"):
        object.__delattr__(position, "robustness")
    with pytest.raises(FrozenInstanceError):
        position.t = 1
    with pytest.raises(TypeError):
        type(position)("R1", None, 0, 0.01)
