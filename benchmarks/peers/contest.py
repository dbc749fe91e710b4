"""What can be asked of each peer, and how: questions, their translation, the peer's answers."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from benchmarks.peers.client import Peer
from benchmarks.peers.dialects import translate
from benchmarks.peers.positions import Question
from benchmarks.peers.ways import WAYS, Way, truths
from tests.tools.common_fragment import UntranslatableError, names_in
from tests.tools.shrink import smaller_formulas

from rvmon.spec.checked.formula import (
    Binary,
    Compare,
    CompareOp,
    EventAtom,
    Formula,
    Literal,
    SignalValue,
    Unary,
)
from rvmon.testing.generate import CARRIER, EVENTS, FURTHER, NUMBERS, chance, pick
from rvmon.testing.generate.formula import Shape, formula


@dataclass(frozen=True, slots=True)
class Contest:
    """A way to ask a peer, and what it is asked.

    Attributes:
        way: who and how.
        shape: what the formulas hold.
    """

    way: Way
    shape: Shape


_EVENTS = (*EVENTS, CARRIER, FURTHER)
_PAST = Shape(future=False, numbers=False)
_FUTURE = Shape(past=False, numbers=False)
_BOTH = Shape(numbers=False)
_SHAPES = {
    "reelay-discrete": replace(_PAST, step=True),
    "reelay-discrete-robustness": replace(_PAST, step=True),
    "reelay-dense": _PAST,
    "reelay-dense-robustness": _PAST,
    "rtamt-discrete": replace(_BOTH, step=True),
    "rtamt-dense": _BOTH,
    "mstlo-delayed": _FUTURE,
    "mstlo-robustness": _FUTURE,
    "sentil": replace(_BOTH, step=True),
}

CONTESTS = {name: Contest(WAYS[name], shape) for name, shape in _SHAPES.items()}

RTAMT_STEPPED = Contest(
    replace(WAYS["rtamt-discrete"], name="rtamt-discrete-online", kind="discrete online"),
    replace(_PAST, step=True),
)
"""Asked row by row, as it is timed. Random formulas are not put to it: what stands twice in one
it steps twice a row."""


def random_question(rng: random.Random, contest: Contest) -> tuple[Question | None, str]:
    """A formula that the peer can say, and a trace; or no question and the reason."""
    asked = _with_numbers(rng, formula(rng, contest.shape, rng.randint(1, 3)))
    try:
        translate(asked, contest.way.dialect)
    except UntranslatableError as error:
        return None, str(error)
    ticks = rng.randint(2, 24)
    columns: dict[str, list[bool | float]] = {}
    for name in sorted(names_in(asked) or {"p"}):
        if name in NUMBERS:
            columns[name] = list(_walk(rng, ticks, lambda: float(rng.randint(-2, 3))))
        else:
            columns[name] = list(_walk(rng, ticks, lambda: chance(rng, 50)))
    events = frozenset(_EVENTS) & columns.keys()
    return Question(asked, columns, events, contest.way.time), ""


def _with_numbers(rng: random.Random, asked: Formula) -> Formula:
    """Some of the events replaced by comparisons that no value meets exactly."""
    match asked:
        case EventAtom() if chance(rng, 50):
            op = pick(rng, (CompareOp.LT, CompareOp.LE, CompareOp.GE, CompareOp.GT))
            return Compare(op, SignalValue(pick(rng, NUMBERS)), Literal(rng.randint(-1, 2) + 0.5))
        case Unary():
            return replace(asked, operand=_with_numbers(rng, asked.operand))
        case Binary():
            left = _with_numbers(rng, asked.left)
            return replace(asked, left=left, right=_with_numbers(rng, asked.right))
        case _:
            return asked


def _walk(
    rng: random.Random, ticks: int, draw: Callable[[], bool | float]
) -> Iterator[bool | float]:
    """Values that are held for a while."""
    value = draw()
    for _ in range(ticks):
        yield value
        if chance(rng, 40):
            value = draw()


def ask_peer(contest: Contest, peer: Peer, question: Question) -> list[bool | None]:
    """The peer's verdict at every tick.

    Raises:
        PeerError: it has none.
        UntranslatableError: it cannot be asked.
    """
    return truths(contest.way, peer, question.formula, question.columns)


def shrink(question: Question, shows: Callable[[Question], bool]) -> Question:
    """A smaller question that still shows what is looked for; greedy."""
    found = True
    while found:
        found = False
        for candidate in _smaller(question):
            if shows(candidate):
                question, found = candidate, True
                break
    return question


def _smaller(question: Question) -> Iterator[Question]:
    for smaller in smaller_formulas(question.formula):
        yield replace(question, formula=smaller)
    if question.ticks > 1:
        for cut in (slice(0, -1), slice(1, None)):
            columns = {name: column[cut] for name, column in question.columns.items()}
            yield replace(question, columns=columns)
    for name, column in question.columns.items():
        for tick in range(question.ticks):
            if column[tick]:
                quiet = 0.0 if isinstance(column[tick], float) else False
                changed = [*column[:tick], quiet, *column[tick + 1 :]]
                yield replace(question, columns={**question.columns, name: changed})
