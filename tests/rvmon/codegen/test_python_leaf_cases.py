"""Samples that bring one new value, on monitors of many requirements."""

import random

import pytest

import rvmon
from rvmon.codegen import python_leaf_cases
from rvmon.errors import TraceError
from rvmon.runtime.unit import Unit, closures
from rvmon.spec.print.printer import format_formula
from rvmon.testing.generate.formula import Shape, formula
from rvmon.trace.time import TIME_LIMIT

pytestmark = pytest.mark.law

SIGNALS = ("p", "q", "r")
SHAPE = Shape(future=False, numbers=False, events=False)


def many(rng, time, count):
    """A specification of so many past formulas, and samples of which each brings a new value."""
    signals = [f"signal {name} : bool" for name in SIGNALS]
    texts = [
        f"requirement R{n}\n  always ({format_formula(formula(rng, SHAPE, 3))})"
        for n in range(count)
    ]
    samples = [(0, dict.fromkeys(SIGNALS, False))]
    values = dict(samples[0][1])
    for _ in range(40):
        t = samples[-1][0] + rng.choice((1, 1, 1, 2, 3, 7))
        name = rng.choice(SIGNALS)
        values[name] = None if rng.random() < 0.03 else not values[name]
        samples.append((t, dict(values) if rng.random() < 0.5 else {name: values[name]}))
    return "\n".join(["spec many", f"time {time}", *signals, *texts]), samples


def judged(spec, samples, engine):
    """What each sample decided, and all records at the end."""
    monitor = spec.monitor(engine=engine)
    steps = [[*map(repr, monitor.step_ns(t, values))] for t, values in samples]
    return steps, monitor.finish_ns(samples[-1][0] + 9)


@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize("count", [2, 4])
def test_they_judge_as_tables_do(time, count, monkeypatch):
    """Whether timers are due beside the new value or not, and whether both meet or not."""
    met = set()
    meets = Unit.meets
    monkeypatch.setattr(
        Unit, "meets", lambda unit, t, cone: met.add(found := meets(unit, t, cone)) or found
    )
    for seed in range(10):
        rng = random.Random(f"{time}/{count}/{seed}")
        text, samples = many(rng, time, count)
        spec = rvmon.loads(text)
        assert judged(spec, samples, "python") == judged(spec, samples, "automaton"), text
    assert met == {False, True}


@pytest.mark.parametrize("deepest", [0, python_leaf_cases._DEEPEST])
@pytest.mark.parametrize("count", [1, 3])
def test_they_judge_as_tables_do_however_deep_blocks_stand(count, deepest, monkeypatch):
    """What depends on one node alone stands within its block, or behind it and asks for it."""
    monkeypatch.setattr(python_leaf_cases, "_DEEPEST", deepest)
    for seed in range(6):
        text, samples = many(random.Random(f"deep/{count}/{seed}"), "held", count)
        spec = rvmon.loads(text)
        assert judged(spec, samples, "python") == judged(spec, samples, "automaton"), text


@pytest.mark.parametrize("count", [1, 12])
def test_times_beyond_the_limit_are_refused_whatever_they_bring(count):
    """All values, one or none; the monitor goes on as if it had not been asked."""
    text, samples = many(random.Random(f"limit/{count}"), "held", count)
    spec = rvmon.loads(text)
    monitor, table = spec.monitor(engine="python"), spec.monitor(engine="automaton")
    for t, values in samples:
        monitor.step_ns(t, values)
        table.step_ns(t, values)
    whole = dict.fromkeys(SIGNALS, True)
    for values in (whole, {**whole, "p": False}, {"p": True}, {"p": False}, {}):
        for t in (TIME_LIMIT, TIME_LIMIT + 1):
            with pytest.raises(TraceError, match="out of range"):
                monitor.step_ns(t, values)
    last = (TIME_LIMIT - 1, whole)
    assert monitor.step_ns(*last) == table.step_ns(*last)
    assert monitor.finish_ns() == table.finish_ns()


def test_what_depends_on_a_node_is_all_above_it():
    """A node behind two others is above both, and above what is below them."""
    assert closures([0b110, 0b1000, 0b1000, 0]) == (0b1111, 0b1010, 0b1100, 0b1000)
