"""Example timelines have their verdict by the definitions."""

import random

import pytest
from tests.tools import build

import rvmon
from rvmon.analysis.example import Budget
from rvmon.analysis.shortest_examples import shortest_examples, verdict_of
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import show_spec
from rvmon.testing.oracle import evaluate

pytestmark = pytest.mark.law

KINDS = ("P", "F", "NT", "I")
SMALL = Budget(runs=120, samples=3, step=4)


def examples_of(checked, name="R", budget=None):
    """The examples of one requirement of a checked specification."""
    compiled = compile_spec(checked)
    one = compiled.requirements[name]
    return shortest_examples(compiled, [one], verdict_of(name), KINDS, budget)


@pytest.mark.parametrize("seed", range(8))
def test_examples_of_random_requirements(seed):
    rng = random.Random(seed)
    shown = 0
    for _ in range(12):
        spec = random_spec(rng, Profile(requirements=1, depth=2, mixed=False))
        for kind, example in examples_of(spec, "R1", SMALL).examples.items():
            report = evaluate(spec, example.samples, end=example.end)
            assert report.verdicts["R1"].value == kind, (show_spec(spec), example)
            instants = [(a.triggered, a.decided) for a in example.attempts]
            assert [(a.triggered, a.decided) for a in report.attempts] == instants
            shown += 1
    assert shown > 12


def test_shortest_means_fewest_samples_then_earliest_end():
    spec = build.spec_of(
        build.requirement(
            build.two(build.eventually(build.e, 2, 4), "and", build.always(build.p, 0, 3)),
            upon=build.rise(build.q),
        )
    )
    found = examples_of(spec).examples
    for kind, example in found.items():
        best = next(
            (count, end)
            for count in (1, 2, 3)
            for end in range(8)
            if _exists(spec, kind, count, end)
        )
        assert (len(example.samples), example.end) == best, kind


def _exists(spec, kind, count, end):
    from itertools import combinations, product

    for times in combinations(range(1, end + 1), count - 1):
        for values in product(product((False, True), repeat=3), repeat=count):
            samples = [
                (t, {"p": p, "q": q, **({"e": True} if e else {})})
                for t, (p, q, e) in zip((0, *times), values, strict=True)
            ]
            if evaluate(spec, samples, end=end).verdicts["R"].value == kind:
                return True
    return False


def test_captured_values_and_instances():
    spec = rvmon.loads(
        "signal x : real\nevent pick(id: int)\nevent place(id: int)\n"
        "requirement L\n upon pick\n then within 2 s x > v + 1\n let v = x\n"
        "requirement Each\n upon pick\n then within 2 s (place and place.id == n)\n"
        " for each n in pick.id\n"
        "requirement A1\n upon age(x) > 200 ms\n then within 1 s updated(x)\n"
    )
    for name in ("L", "Each", "A1"):
        found = examples_of(spec.checked, name).examples
        assert set(found) == set(KINDS), name


def test_signals_that_go_stale_do_not_prolong_an_example():
    """However many there are: in the shortest run all of them are updated."""
    spec = rvmon.loads(
        "signal mode : {hold, rtl}\nsignal north, east, height : real [m] stale after 200 ms\n"
        "requirement Q\n upon mode == rtl\n"
        " then hypot(north, east) >= d - 1 m until height > 30 m\n let d = hypot(north, east)\n"
    )
    found = examples_of(spec.checked, "Q").examples
    assert set(found) == set(KINDS)
    assert len(found["NT"].samples) == 1


def test_what_cannot_be_is_not_shown():
    spec = build.spec_of(build.requirement(build.eventually(build.f), upon=build.start))
    found = examples_of(spec, budget=Budget(runs=50))
    assert set(found.examples) == {"P", "I"}
    assert found.runs <= 50


def test_waiting_without_end_does_not_hide_other_runs():
    """What starts again at all times is never at rest; runs of two samples are tried all the same.

    What has to stay true as long as it is true fails when it ends, and can never pass.
    """
    head = "spec s\ntime held\nsignal a, b : bool\nrequirement R\n"
    found = examples_of(rvmon.loads(head + " whenever a then for 1 s b").checked)
    assert set(found.examples) == set(KINDS)
    found = examples_of(rvmon.loads(head + " whenever a then for 1 s a").checked)
    assert set(found.examples) == {"F", "NT", "I"}
    assert len(found.examples["F"].samples) == 2
