"""The core against progression, on traces too long for the law: what is kept over time stays right.

Random formulas with windows of up to some hundred ticks, required from the start or upon a signal,
in held and in sampled time; nothing is unknown. What an attempt owes is taken on by `progression`,
which has the formula's core form in common with the core, and neither automata, queues, networks
nor chains of windows. Compared are, of every attempt, trigger, verdict
and instant of what the prefix decides, stepped and by rows.
"""

from __future__ import annotations

import random
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from benchmarks.comparisons.comparison import Found
from tests.tools.build import scaled
from tests.tools.drive import drive
from tests.tools.forms import FORMS, Compiler, Maker
from tests.tools.generate_ltl import random_mtl

from rvmon.errors import RvmonError
from rvmon.language.checked.formula import Bound, BoundAtom, Constant, SignalAtom
from rvmon.language.checked.specification import (
    CheckedSpec,
    Mode,
    Requirement,
    Signal,
    TimeModel,
    Type,
)
from rvmon.language.print import format_formula
from rvmon.logic.alphabet import Alphabet, alphabet_of, holds
from rvmon.logic.automaton import FAILED, NOW, PASSED, Location, Token, location_of, normalise
from rvmon.logic.formula import Factory, Literal, Temporal
from rvmon.logic.lower import lower
from rvmon.logic.progress import after, step, value
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Residual, TooManyClausesError
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Elapsed, State, StateOp
from rvmon.testing.generate import BOOLS
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision
from rvmon.verdicts.report import Report

MOST_CLOCKS = 16
"""Obligations with an age of their own that one attempt may owe at once.

A window above 0 that is started anew at every tick of held time would need one for every tick.
"""

MOST_CLAUSES = 32
"""Ways to fulfil what one attempt owes that may be weighed at once, before they are reduced."""


class TooManyObligationsError(RvmonError):
    """An attempt cannot be judged by progression within bounded memory."""


class Progression:
    """Judges any formula; memory grows with the residuals that occur.

    Source: AUTOMATA 1.

    Args:
        required: the consequent under `X`, as an attempt starts before its trigger's position.
        alphabet: of that formula.

    Raises:
        TooManyObligationsError: in a step, if an attempt owes more than `MOST_CLOCKS` at once, or
            in more than `MOST_CLAUSES` ways.
    """

    def __init__(self, required: Temporal, alphabet: Alphabet) -> None:
        self.alphabet = alphabet
        self._locations: list[Location] = []
        self._index: dict[Residual, int] = {}
        self._edges: dict[tuple[int, tuple[int, ...], int], tuple[int, tuple[int, ...]]] = {}
        for residual in (FAILS, HOLDS):
            self._location(residual)
        self.start: Token = (self._location(frozenset([frozenset([(required, NO_CLOCK)])])), ())

    def _location(self, residual: Residual) -> int:
        if residual not in self._index:
            self._index[residual] = len(self._locations)
            self._locations.append(location_of(residual))
        return self._index[residual]

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        index, anchors = token
        cuts = self._locations[index].cuts
        ages = [t - anchor for anchor in anchors]
        # Within a region of ages the same is owed.
        key = index, tuple(map(bisect_right, cuts, ages)), letter
        if key not in self._edges:
            self._edges[key] = self._edge(index, ages, letter)
        target, sources = self._edges[key]
        return target, tuple([t if source == NOW else anchors[source] for source in sources])

    def _edge(self, index: int, ages: list[int], letter: int) -> tuple[int, tuple[int, ...]]:
        """The target, and the sources of its clocks."""
        valuation = self.alphabet.valuation(letter)

        def read(literal: Literal) -> Residual:
            return HOLDS if holds(literal.sense, valuation[literal.proposition]) else FAILS

        try:
            reached = step(self._locations[index].residual, ages, read, MOST_CLAUSES)
        except TooManyClausesError:
            raise TooManyObligationsError("it can be fulfilled in too many ways") from None
        residual, sources = normalise(reached, len(ages))
        if len(sources) > MOST_CLOCKS:
            raise TooManyObligationsError("it has too many open obligations at once")
        return self._location(residual), sources

    def settle(self, token: Token, t: int, until: int) -> tuple[Token, int]:
        """Let time pass from `t` to `until` without a position.

        Returns the token and the instant of its decision, or the next at which it might be decided.
        """
        index, anchors = token
        location = self._locations[index]
        aged = zip(location.cuts, anchors, strict=True) if anchors else ()
        for t in sorted({anchor + cut for own, anchor in aged for cut in own if anchor + cut > t}):
            if t > until:
                break
            truth = value(after(location.residual, [t - anchor for anchor in anchors]))
            if truth != UNKNOWN:
                return (PASSED if truth else FAILED, ()), t
        return token, t


TRIGGER = SignalAtom("p")
LENGTHS = (1, 7, 40)
"""What the windows of a few ticks are multiplied by."""

Told = Mapping[int, tuple[int, int | None, Verdict | None]]
"""By number of an attempt its trigger, and instant and verdict if the prefix decides it."""


@dataclass(frozen=True, slots=True)
class Long:
    """Settings of `long`: of how many samples a trace is."""

    samples: int = 10_000


def _case(seed: int, number: int, samples: int) -> Case:
    """A random case of one requirement and so many samples."""
    rng = random.Random(f"{seed}/{number}")
    formula = scaled(random_mtl(rng, rng.randint(2, 4)), rng.choice(LENGTHS))
    trigger = rng.choice((TRIGGER, TRIGGER, BoundAtom(Bound.START)))
    model = (TimeModel.HELD, TimeModel.SAMPLED)[number % 2]
    requirement = Requirement("R", Mode.UPON, trigger, formula)
    signals = {name: Signal(name, Type(Kind.BOOL)) for name in BOOLS}
    spec = CheckedSpec("long", "", model, signals, {}, {"R": requirement})
    return Case(spec, tuple(_samples(rng, samples)))


def _samples(rng: random.Random, count: int) -> Iterator[Sample]:
    t, values = 0, dict.fromkeys(BOOLS, False)
    chances = {name: rng.choice((0.01, 0.1, 0.5)) for name in BOOLS}
    for _ in range(count):
        for name, chance in chances.items():
            values[name] = values[name] is not (rng.random() < chance)
        yield Sample(t, dict(values))
        t += rng.choice((1, 1, 1, 2, 3, 8, 41))


def by_progression(case: Case) -> Told:
    """What progression makes of a case; attempts that owe the same go on together.

    Raises:
        TooManyObligationsError: one owes too much at once.
    """
    (requirement,) = case.spec.requirements.values()
    is_held = case.spec.time is TimeModel.HELD
    factory = Factory()
    required = lower(requirement, factory, sampled=not is_held).required
    alphabet = alphabet_of(required)
    machine = Progression(factory.next(required), alphabet)
    told: dict[int, tuple[int, int | None, Verdict | None]] = {}
    going: dict[Token, list[int]] = {}
    # Where only samples are positions, that none follows is known an instant behind the end.
    last = case.samples[-1].t + (not is_held)
    before = False
    for sample, until in zip(case.samples, _until(case.samples, last), strict=True):
        starts = sample.t == 0 if requirement.trigger != TRIGGER else bool(sample.values["p"])
        if starts and not before:
            number = len(told) + 1
            told[number] = sample.t, None, None
            going.setdefault(machine.start, []).append(number)
        before = starts
        letter = _letter(alphabet, sample)
        behind: dict[Token, list[int]] = {}
        for token, numbers in going.items():
            after, at = _taken(machine, token, letter, sample.t, until, is_held=is_held)
            if after[0] > PASSED:
                behind.setdefault(after, []).extend(numbers)
                continue
            verdict = Verdict.PASS if after[0] == PASSED else Verdict.FAIL
            told.update({one: (told[one][0], at, verdict) for one in numbers})
        going = behind
    return told


def _until(samples: Sequence[Sample], last: int) -> Iterator[int]:
    """For each sample the last instant before the next one."""
    yield from (later.t - 1 for _, later in pairwise(samples))
    yield last


def _letter(alphabet: Alphabet, sample: Sample) -> int:
    letter = 0
    for proposition, entry in zip(alphabet.propositions, alphabet.pessimistic, strict=True):
        letter += entry[TRUE if _holds(proposition, sample) else FALSE]
    return letter


def _holds(state: State, sample: Sample) -> bool:
    """Whether a formula without operators of the past is true; all is known."""
    match state.op, state.leaf:
        case StateOp.LEAF, SignalAtom(name=name):
            return bool(sample.values[name])
        case StateOp.LEAF, Constant(value=value):
            return value
        case StateOp.LEAF, Elapsed(duration=0):  # each sample is a position
            return True
        case StateOp.NOT, _:
            return not _holds(state.args[0], sample)
        case StateOp.AND, _:
            return all(_holds(one, sample) for one in state.args)
        case StateOp.OR, _:
            return any(_holds(one, sample) for one in state.args)
    raise AssertionError(f"nothing of these formulas is lowered to {state.op}, {state.leaf}")


def _taken(
    machine: Progression, token: Token, letter: int, t: int, until: int, *, is_held: bool
) -> tuple[Token, int]:
    """A token after a sample and the time behind it, and the instant if that decided it."""
    after = machine.step(token, t, letter)
    if not is_held:
        return (after, t) if after[0] <= PASSED else machine.settle(after, t, until)
    while after[0] > PASSED and t < until:  # in held time every tick is a position
        t, before = t + 1, after
        after = machine.step(before, t, letter)
        if after == before and not after[1]:  # without clocks it only loops
            break
    return after, t


def of_report(report: Report) -> Told:
    """What a report says of its attempts."""
    return {
        one.number: (
            (one.triggered, one.decided, one.verdict)
            if one.decision is Decision.PREFIX
            else (one.triggered, None, None)
        )
        for one in report.attempts
    }


def judge_long(seed: int, own: Long, numbers: range) -> Found:
    counts, texts = Counter[str](), list[str]()
    for number in numbers:
        case = _case(seed, number, own.samples)
        try:
            wanted = by_progression(case)
        except TooManyObligationsError:
            counts["passed over: too much is required at once"] += 1
            continue
        counts.update(traces=1, samples=len(case.samples))
        for _, _, verdict in wanted.values():
            counts[f"attempts {'open' if verdict is None else verdict.value}"] += 1
        compiler = Compiler()
        automaton = compiler(case.spec).requirements["R"].automaton
        counts[f"judged by {'a network' if automaton is None else 'an automaton'}"] += 1
        for form in FORMS:
            got = of_report(drive(Maker(form, compiler)(case), case)[0])
            wrong = [k for k in sorted(wanted.keys() | got.keys()) if wanted.get(k) != got.get(k)]
            if wrong:
                text = format_formula(case.spec.requirements["R"].consequent)
                texts.append(
                    f"number {number}, {case.spec.time.value}, {text}: attempt {wrong[0]}: "
                    f"{wanted.get(wrong[0])}, {form} {got.get(wrong[0])}"
                )
    return counts, texts
