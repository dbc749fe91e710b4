"""Operators equal their definitions in section 2 of the semantics, on random traces."""

import re
from collections.abc import Iterator
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from msgspec import structs
from tests.rvmon.laws.tried import ONE, TRIED, judge, judged_otherwise, known_from_the_first
from tests.tools.build import (
    always,
    eventually,
    fall,
    false,
    following,
    held,
    historically,
    no,
    once,
    previous,
    requirement,
    rise,
    spec_of,
    start,
    true,
    two,
)

from rvmon.language.checked.formula import Formula, Interval, UnaryOp
from rvmon.language.checked.specification import CheckedSpec, EndPolicy, TimeModel
from rvmon.language.print import format_formula
from rvmon.testing.generate.formula import interval
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.strategies import formulas, specs, traces

pytestmark = pytest.mark.law

Pair = tuple[Formula, Formula]


def is_born_with_its_signals(formula: Formula) -> bool:
    """Whether the formula has a value once its signals have; otherwise the laws do not apply."""
    return not re.search(r"\b(prev|delta|rate|mean|variance)\(", format_formula(formula))


def anywhere(a: Formula, b: Formula, low: int, high: int | None) -> Iterator[Pair]:
    """Pairs that are equivalent in every time model."""
    window = (low, high)
    yield no(no(a)), a
    yield no(two(a, "U", b, *window)), two(no(a), "R", no(b), *window)
    yield no(two(a, "R", b, *window)), two(no(a), "U", no(b), *window)
    yield no(eventually(a, *window)), always(no(a), *window)
    yield eventually(a, *window), two(true, "U", a, *window)
    yield always(a, *window), two(false, "R", a, *window)
    yield two(a, "W", b, 0, high), two(b, "R", two(a, "or", b), 0, high)
    yield two(a, "M", b, 0, high), two(b, "U", two(a, "and", b), 0, high)
    yield no(once(a, *window)), historically(no(a), *window)
    yield once(a, *window), two(true, "S", a, *window)
    yield held(a, low), two(historically(a, 0, low), "and", once(start, low))
    yield two(a, "->", b), two(no(a), "or", b)
    yield two(a, "<->", b), two(two(a, "and", b), "or", two(no(a), "and", no(b)))
    yield two(a, "xor", b), two(two(a, "and", no(b)), "or", two(no(a), "and", b))
    yield no(two(a, "and", b)), two(no(a), "or", no(b))


def in_steps(a: Formula) -> Iterator[Pair]:
    """Pairs with `X` and `Y` that are equivalent outside held time."""
    yield no(following(a)), following(no(a))
    yield rise(a), two(a, "and", no(previous(a)))
    yield fall(a), two(no(a), "and", previous(a))
    yield no(previous(a)), two(previous(no(a)), "or", start)


def in_ticks(a: Formula) -> Iterator[Pair]:
    """Pairs that are equivalent in held time, where the previous tick is one tick before."""
    yield rise(a), two(a, "and", no(once(a, 1, 1)))
    yield fall(a), two(no(a), "and", once(a, 1, 1))


def with_consequent(spec: CheckedSpec, consequent: Formula) -> CheckedSpec:
    [first, *_] = spec.requirements.values()
    changed = replace(first, consequent=consequent, captures=(), for_each=None)
    return structs.replace(spec, requirements={first.id: changed})


TRACES = TraceProfile(outages=35)


@pytest.mark.parametrize("time", TimeModel)
@TRIED
@given(data=st.data())
def test_equivalent_formulas_have_the_same_attempts(data: st.DataObject, time: TimeModel) -> None:
    spec = data.draw(specs(replace(ONE, time=time)))
    shape = Shape(step=time is not TimeModel.HELD)
    drawn = formulas(shape, depth=2).filter(is_born_with_its_signals)
    a, b = (data.draw(drawn) for _ in range(2))
    window: Interval = data.draw(st.builds(interval, st.randoms(), st.just(shape)))
    pairs = [*anywhere(a, b, window.low, window.high)]
    pairs += in_ticks(a) if time is TimeModel.HELD else in_steps(a)
    left, right = data.draw(st.sampled_from(pairs))
    case = known_from_the_first(data.draw(traces(spec, TRACES)))
    # `held` is an exception: values unknown up to the first tick of a clock may not exist yet,
    # and a trace may surely have lasted long enough although its start is unknown.
    exact = time is not TimeModel.CLOCKED and not case.outages
    assume(exact or getattr(left, "op", None) is not UnaryOp.HELD)
    cases = [replace(case, spec=with_consequent(spec, formula)) for formula in (left, right)]
    assert judged_otherwise(*cases) == []


@TRIED
@given(specs(ONE), st.data())
def test_negation_exchanges_verdicts(spec: CheckedSpec, data: st.DataObject) -> None:
    """`not φ` fails where φ passes, as far as the prefix decides; `weak` and `strong` swap."""
    formula = data.draw(formulas(Shape(step=spec.time is not TimeModel.HELD)))
    case = data.draw(traces(spec, TRACES))
    swap = {EndPolicy.WEAK: EndPolicy.STRONG, EndPolicy.STRONG: EndPolicy.WEAK}
    for policy, other in swap.items():
        reports = []
        for consequent, at_end in ((formula, policy), (no(formula), other)):
            changed = with_consequent(spec, consequent)
            [required] = changed.requirements.values()
            upon = requirement(consequent, upon=required.trigger, at_end=at_end)
            made = spec_of(upon, time=spec.time, period=spec.period)
            reports.append(judge(replace(case, spec=structs.replace(made, signals=spec.signals))))
        exchange = {"P": "F", "F": "P", "I": "I"}
        # Attempts in doubt are left out, as they can only pass.
        sure = [[a for a in report.attempts if not a.in_doubt] for report in reports]
        wanted = [(a.number, a.decided, exchange[a.verdict.value], a.decision) for a in sure[0]]
        got = [(a.number, a.decided, a.verdict.value, a.decision) for a in sure[1]]
        assert got == wanted
