"""Bins and combinations hit by runs, counted by hand."""

import math
import operator
import random

import pytest
from tests.tools.each import each

from rvmon import loads
from rvmon.errors import UnknownNameError

SIGNALS = """signal p, q : bool
signal x : real
signal state : {idle, moving, done}
event e, pick(id: int)
"""


def counts(goals, samples, group="c", time="held", end=None):
    """The hits of each item."""
    spec = loads(f"time {time}\n{SIGNALS}{goals}\n")
    recording = spec.recording([(t, values) for t, values in samples])
    hits = spec.coverage_model.of(recording, end)
    return {item: hit.count for item, hit in hits.get(group, {}).items()}


def states(*names):
    return [(t, {"state": name}) for t, name in enumerate(names)]


@pytest.mark.slow
@each(
    ("bins", "samples", "expected"),
    [
        ("p {yes: true, no: false}", [(0, {"p": True}), (1, {"p": False})], {"yes": 1, "no": 1}),
        ("p {yes: true}", [(t, {"p": True}) for t in range(5)], {"yes": 1}),
        (
            "x {low: [0, 1), high: [1, inf)}",
            [(0, {"x": 1.0}), (1, {"x": 0.5})],
            {"low": 1, "high": 1},
        ),
        ("x {two: 2, ignore three: 3}", [(0, {"x": 2}), (1, {"x": 3})], {"two": 1, "three": 1}),
        ("state {idle, on: moving}", states("idle", "moving", "idle"), {"idle": 2, "on": 1}),
        ("{both: p and q}", [(0, {"p": True}), (1, {"q": True})], {"both": 1}),
        ("{often: e}", [(t, {"e": True}) for t in range(3)], {"often": 3}),
        ("{second: pick.id == 2}", [(t, {"pick": {"id": t}}) for t in range(4)], {"second": 1}),
        ("{one: p, same: p}", [(0, {"p": True})], {"one": 1, "same": 1}),
        ("{late: held(p, 2 s)}", [(0, {"p": True}), (5, {"p": False})], {"late": 1}),
    ],
)
def test_forms_of_bins(bins, samples, expected):
    if "{" in bins and not bins.startswith("{"):
        bins = f"= {bins}"
    assert counts(f"coverpoint c {bins}", samples) == expected


def test_many_comparisons_of_one_signal():
    """Bins follow the value across one constant, across many, and to unknown."""
    signs = {
        "<": operator.lt,
        "<=": operator.le,
        "==": operator.eq,
        "!=": operator.ne,
        ">=": operator.ge,
        ">": operator.gt,
    }
    asked = {f"x {sign} {c}": (holds, c) for c in range(-3, 4) for sign, holds in signs.items()}
    bins = ", ".join(f"b{place}: {text}" for place, text in enumerate(asked))
    rng = random.Random(1)
    values = [
        rng.choice([*range(-4, 5), 0.5, -0.0, math.inf, -math.inf, math.nan]) for _ in range(300)
    ]
    expected = {}
    for place, (holds, constant) in enumerate(asked.values()):
        known = [holds(value, constant) for value in values if not math.isnan(value)]
        hits = sum(now and not before for before, now in zip([False, *known], known, strict=False))
        expected[f"b{place}"] = hits
    samples = [(t, {"x": float(value)}) for t, value in enumerate(values)]
    assert counts(f"coverpoint c {{{bins}}}", samples) == expected


STEPS = (
    "coverpoint c = state {go: idle => moving, all: idle => moving => done, back: moving => idle}"
)


@each("time", ["held", "sampled"])
@each(
    ("names", "expected"),
    [
        (("idle", "moving", "done"), {"go": 1, "all": 1}),
        (("idle", "idle", "moving", "moving", "done"), {"go": 1, "all": 1}),
        (("done", "moving", "done"), {}),
        (("idle", "moving", "idle", "moving", "done"), {"go": 2, "all": 1, "back": 1}),
        (("idle", "moving", "done", "moving", "done"), {"go": 1, "all": 1}),
        (("moving", "idle"), {"back": 1}),
        (("idle",), {}),
    ],
)
def test_steps(time, names, expected):
    assert counts(STEPS, states(*names), time=time) == expected


CROSS = """coverpoint a = p {yes: true, no: false}
coverpoint b = state {idle, moving, ignore done}
cross c = a, b
"""


def test_cross_is_where_its_points_are():
    goals = CROSS.replace("{yes: true, no: false}", "{yes: true, no: false}\n  upon e")
    samples = [(0, {"p": True, "state": "idle"}), (1, {"e": True}), (2, {"e": True})]
    assert counts(goals, samples) == {"yes × idle": 2}
    assert counts(f"{goals}  upon pick\n", samples) == {}


def test_online_is_offline():
    spec = loads(f"{SIGNALS}{STEPS}\n")
    monitor = spec.coverage_model.monitor()
    for _ in range(2):
        for t, values in states("idle", "moving", "done"):
            monitor.step(t, values)
            monitor.advance(t + 0.5)
        assert monitor.hits == {"c": monitor.finish(9)["c"]}
        assert monitor.finish() == spec.coverage(states("idle", "moving", "done"))
        monitor.reset()


def test_combinations_have_names_of_their_own():
    bins = "= p {x: true, `y × z`: false}", "= q {`x × y`: true, z: false}"
    points = "".join(f"coverpoint {n} {own}\n" for n, own in zip("ab", bins, strict=True))
    spec = loads(f"{SIGNALS}{points}cross c = a, b\n")
    assert len(spec.coverage_model.model.groups["c"].items) == 4


@pytest.mark.parametrize("goals", ["", "coverpoint c = p {yes: true}"])
def test_an_unknown_way_to_settle_is_refused(goals):
    """Also if there is nothing to cover."""
    model = loads(f"{SIGNALS}{goals}\n").coverage_model
    with pytest.raises(UnknownNameError, match="settle='later': expected 'now' or 'next'"):
        model.monitor(settle="later")
