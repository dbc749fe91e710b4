"""Random specifications, biased towards cases that monitors get wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rvmon.language.checked import formula as rv
from rvmon.language.checked import specification as spec
from rvmon.language.checked.classify import is_end, windows_of
from rvmon.testing.generate import (
    BOOLS,
    CARRIER,
    EVENTS,
    FIELD,
    LABEL,
    NUMBERS,
    Rng,
    chance,
    drawn,
    events,
    pick,
    signals,
)
from rvmon.testing.generate.formula import consequent, formula, past_unary
from rvmon.testing.generate.numbers import Shape, arithmetic, comparison, number_of_windows
from rvmon.testing.law.attempts import is_pulse


@dataclass(frozen=True, slots=True)
class Profile:
    """The limits of random specifications.

    Attributes:
        time: the time model; `None`: any.
        depth: the greatest depth of a consequent.
        requirements: the greatest number of requirements.
        many: the percentage of specifications with 8 to 14 requirements; half of these only read
            truth values and their past, so that plans share subformulas.
        crowded: the percentage of specifications with 20 to 26 requirements.
        wide: the percentage of specifications whose whole numbers reach the ends of 64 bits; such
            numbers are compared, but no arithmetic is done with them.
        numbers: whether comparisons and probes may occur.
        constants: the weight of constants among propositions; the others together have about 100.
        amounts: the weight of measures of windows; the other formulas together have about 120.
        form: the only measure, which occurs at least once in each specification: a name (`mean`),
            or `expression` for several. A prefix says what it is measured over: `last` (the last
            updates), `since` (since the trigger) or `each` (several occurrences).
        past: whether past operators may occur.
        future: whether future operators may occur.
        events: whether events may be read.
        mixed: whether future operators may stand below past ones.
        captures: whether requirements may hold `let`.
        for_each: whether requirements may hold `for each`.
        policies: whether requirements may hold `at end`.
        stale: whether signals may be `stale after`.
        ignoring: whether signals may `ignore NaN`.
    """

    time: spec.TimeModel | None = None
    depth: int = 4
    requirements: int = 2
    many: int = 0
    crowded: int = 0
    wide: int = 0
    constants: int = 2
    amounts: int = 0
    form: str = ""
    numbers: bool = True
    past: bool = True
    future: bool = True
    events: bool = True
    mixed: bool = True
    captures: bool = True
    for_each: bool = True
    policies: bool = True
    stale: bool = True
    ignoring: bool = True


def random_spec(rng: Rng, profile: Profile) -> spec.CheckedSpec:
    """A random specification over a fixed small vocabulary, with bounds of a few ticks.

    Args:
        rng: `random.Random` with a seed, or one that draws from Hypothesis.
        profile: the limits.
    """
    time = profile.time or pick(rng, tuple(spec.TimeModel))
    number = rng.randint(1, profile.requirements)
    draw = _requirement
    if profile.many and chance(rng, profile.many):
        number = rng.randint(8, 14)
        if profile.past and chance(rng, 50):
            draw = _law
    if profile.crowded and chance(rng, profile.crowded):
        number = rng.randint(20, 26)
    if profile.wide:
        profile = replace(profile, wide=100 if chance(rng, profile.wide) else 0)
    found = [draw(rng, profile, time, f"R{place}") for place in range(1, number + 1)]
    while profile.form and not any(
        one for rule in found for one in windows_of(rule.trigger, rule.consequent)
    ):
        found[-1] = _requirement(rng, profile, time, f"R{number}")
    return spec.CheckedSpec(
        name="random", title="", time=time,
        signals=signals(_stale(rng, profile), _ignoring(rng, profile)), events=events(),
        requirements={requirement.id: requirement for requirement in found},
        period=rng.randint(1, 4) if time is spec.TimeModel.CLOCKED else None,
    )  # fmt: skip


def _stale(rng: Rng, profile: Profile) -> dict[str, int]:
    names = (*BOOLS, *NUMBERS, LABEL)
    return {n: rng.randint(1, 9) for n in names if profile.stale and chance(rng, 10)}


def _ignoring(rng: Rng, profile: Profile) -> frozenset[str]:
    return frozenset(n for n in NUMBERS[:1] if profile.ignoring and chance(rng, 25))


def _requirement(rng: Rng, profile: Profile, time: spec.TimeModel, name: str) -> spec.Requirement:
    mode = profile.form.rpartition(" ")[0]
    since = mode == "since"
    captures: tuple[spec.Capture, ...] = ()
    if profile.captures and (since or chance(rng, 12)):
        captures = _captures(rng, profile, time)
    for_each = None
    if profile.for_each and (mode == "each" or chance(rng, 12)):
        for_each = spec.ForEach("each", rv.FieldValue(CARRIER, FIELD))
    instance = (for_each.name,) if for_each else ()
    instants = ("t0",) if captures and profile.amounts and (since or chance(rng, 50)) else ()
    shape = Shape(
        step=time is not spec.TimeModel.HELD, past=profile.past, future=profile.future,
        mixed=profile.mixed, numbers=profile.numbers, events=profile.events,
        captured=(*instance, *(capture.name for capture in captures)), wide=profile.wide > 0,
        constants=profile.constants, amounts=profile.amounts, instants=instants, form=profile.form,
    )  # fmt: skip
    amounts = 0 if since else profile.amounts
    seen = replace(shape, future=False, captured=instance, amounts=amounts, instants=())
    trigger = _trigger(rng, seen, for_each)
    at_end = is_end(trigger)
    how = spec.Mode.WHENEVER if not at_end and chance(rng, 35) else spec.Mode.UPON
    required = consequent(rng, shape, rng.randint(1, profile.depth))
    if captures and chance(rng, 70):
        op = pick(rng, (rv.BinaryOp.AND, rv.BinaryOp.OR))
        required = rv.Binary(op, required, comparison(rng, shape))
    policy = spec.EndPolicy.DEFAULT
    if profile.policies and chance(rng, 35):
        policy = pick(rng, tuple(spec.EndPolicy)[1:])
    return spec.Requirement(
        name, how, trigger, required, at_end=policy, pulse=is_pulse(trigger), for_each=for_each,
        captures=(*captures, *(spec.Capture(name, rv.NowValue()) for name in instants)),
    )  # fmt: skip


def _law(rng: Rng, profile: Profile, time: spec.TimeModel, name: str) -> spec.Requirement:
    """A requirement `always φ` over truth values and their past."""
    shape = Shape(time is not spec.TimeModel.HELD, future=False, numbers=False, events=False)
    lasting = formula(rng, shape, min(profile.depth, 3))
    start = rv.BoundAtom(rv.Bound.START)
    return spec.Requirement(
        name, spec.Mode.UPON, start, rv.Unary(rv.UnaryOp.ALWAYS, lasting), pulse=is_pulse(start)
    )


def _captures(rng: Rng, profile: Profile, time: spec.TimeModel) -> tuple[spec.Capture, ...]:
    found: list[spec.Capture] = []
    for name in ("v", "w")[: 2 if chance(rng, 25) else 1]:
        named = tuple(capture.name for capture in found)
        earlier = Shape(captured=named, wide=profile.wide > 0)
        simple: tuple[rv.Numeric, ...] = (rv.SignalValue("x"), rv.FieldValue(CARRIER, FIELD))
        value = arithmetic(rng, earlier) if chance(rng, 25) else pick(rng, simple)
        if profile.amounts and not profile.wide and chance(rng, 40):
            # In a window the language allows no captured value of a `let`, only an expression.
            held = Shape(step=time is not spec.TimeModel.HELD, longest=4)
            value = number_of_windows(
                rng, held, lambda rng, below: formula(rng, replace(below, past=profile.past), 1)
            )
        found.append(spec.Capture(name, value))
    return tuple(found)


def _trigger(rng: Rng, shape: Shape, for_each: spec.ForEach | None) -> rv.Formula:
    if for_each:
        compared = rv.Compare(rv.CompareOp.EQ, for_each.value, rv.Captured(for_each.name))
        further = rv.Binary(rv.BinaryOp.AND, compared, formula(rng, shape, 1))
        level = rv.SignalAtom(pick(rng, BOOLS))
        either = rv.Binary(rv.BinaryOp.OR, level, compared)
        options: tuple[rv.Formula, ...] = (rv.EventAtom(CARRIER), compared, further, level, either)
        if shape.past:
            earlier = past_unary(rng, shape, 1)
            options += (
                rv.Binary(rv.BinaryOp.AND, compared, earlier),
                rv.Binary(rv.BinaryOp.OR, earlier, compared),
            )
        return pick(rng, options)
    return drawn(
        rng,
        (28 if shape.events else 0, lambda: rv.EventAtom(pick(rng, EVENTS))),
        (
            16 if shape.events else 0,
            lambda: rv.Binary(
                rv.BinaryOp.AND, rv.EventAtom(pick(rng, EVENTS)), formula(rng, shape, 1)
            ),
        ),
        (12, lambda: rv.SignalAtom(pick(rng, BOOLS))),
        (14, lambda: rv.BoundAtom(rv.Bound.START)),
        (18, lambda: formula(rng, shape, rng.randint(1, 2))),
        (10 if shape.past else 0, lambda: past_unary(rng, shape, 1)),
        (6, lambda: rv.BoundAtom(rv.Bound.END)),
    )
