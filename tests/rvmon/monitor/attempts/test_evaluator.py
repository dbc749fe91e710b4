"""State formulas over time: values, instants of change, memory."""

import random

import pytest
from tests.tools.build import (
    compared,
    e,
    eventually,
    fall,
    held,
    historically,
    once,
    p,
    probe,
    q,
    requirement,
    rise,
    spec_of,
    timeline,
    two,
    x,
)

from rvmon.formula.factory import Factory
from rvmon.formula.lower import lower
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.evaluator_classes import generated
from rvmon.plan.graph import graph_of
from rvmon.plan.outages import Outages
from rvmon.plan.planning import uses_of
from rvmon.runtime.past import Since
from rvmon.runtime.values import NEVER


def evaluator_of(formula, stale=None, names=None):
    """An evaluator in which only the formula is evaluated, and the formula's place."""
    found = requirement(eventually(q), upon=formula)
    state = lower(found, Factory()).trigger
    spec, graph = spec_of(found, stale=stale), graph_of([state])
    uses = uses_of([graph], ())
    evaluator = generated(spec, graph, uses, uses, Evaluator)(Outages(spec, names), {})
    return evaluator, graph.index[state]


def word(formula, end, stale=None, names=None, **rows):
    """The truth at each tick, evaluated only where the evaluator says that something changes."""
    evaluator, place = evaluator_of(formula, stale=stale, names=names)
    samples = {sample.t: sample.values for sample in timeline(**rows)}
    letters = []
    for t in range(end):
        if t in samples:
            evaluator.sample(t, samples[t])
        elif t == evaluator.next_position():
            evaluator.visit(t)
        letters.append("f?t"[evaluator.v[place]])
    return "".join(letters)


@pytest.mark.parametrize(
    ("formula", "rows", "expected"),
    [
        (once(p, 0, 3), {"p": "01..0"}, "fttttttfff"),
        (once(p, 2, 3), {"p": "01.0."}, "ffftttffff"),
        (once(e, 1, 2), {"e": "1...1"}, "fttffttfff"),
        (historically(p, 0, 2), {"p": "1..0..1"}, "tttffffftt"),
        (held(p, 3), {"p": "1....0.1"}, "fffttfffff"),
        (rise(p), {"p": "10.1"}, "tfftffffff"),
        (fall(p), {"p": "10.1"}, "ftffffffff"),
        (two(p, "S", q, 0, None), {"p": "..1..0", "q": "0.1.0"}, "fftttfffff"),
        (probe("changed", "x"), {"x": "11.2.n"}, "ffftf?ffff"),
        (probe("updated", "x"), {"x": "11.2"}, "ttftffffff"),
        (probe("known", "x"), {"x": ".1.n", "p": "1"}, "fttfffffff"),
        (compared(x, ">", 1), {"x": "12.n"}, "ftt???????"),
    ],
)
def test_values_at_every_tick(formula, rows, expected):
    """Between two reported changes nothing changes, so the values at all ticks come out right."""
    assert word(formula, 10, **rows) == expected


def test_staleness_is_a_change_by_time_alone():
    """A signal is unknown from D + 1 ticks after its last update, without a message."""
    assert word(compared(x, ">", 0), 8, stale={"x": 2}, x="1..2") == "tttttt??"


def test_what_has_no_source_is_unknown_throughout():
    """An event that cannot arrive is not false but unknown, and nothing waits for it."""
    assert word(e, 3, names=frozenset("p"), p="1") == "???"
    evaluator, _ = evaluator_of(e, names=frozenset("p"))
    evaluator.visit(0)
    assert evaluator.next_position() == NEVER


def test_nothing_is_due_when_nothing_changes():
    """Held values and settled windows leave nothing to wake up for."""
    evaluator, _ = evaluator_of(two(p, "and", once(q, 0, 5)))
    evaluator.sample(0, {"p": True, "q": False})
    assert evaluator.next_position() == NEVER


@pytest.mark.parametrize(("low", "high"), [(0, 1_000), (700, 1_000), (999, 1_000), (5, None)])
def test_the_memory_of_a_window_is_bounded(low, high):
    """Stretches are merged: their number depends on the window's proportions, not on samples."""
    rng = random.Random(1)
    node = Since(low, high, 1)
    t, most = 0, 0
    for _ in range(3_000):
        t += rng.randint(2, 5)
        node.step(t, t - 1, TRUE, rng.choice((FALSE, UNKNOWN, TRUE)))
        most = max(most, len(node.runs), len(node.better.runs) if node.better else 0)
    width = None if high is None else high - low
    assert most <= (2 if width is None else low / max(width, 1) + 3)
