"""What can be asked of each peer, and how: questions, their translation, the peer's answers."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from benchmarks.peers.positions import Cell, Question

from rvmon.spec.checked import (
    Binary,
    Compare,
    CompareOp,
    EventAtom,
    Formula,
    Literal,
    SignalValue,
    TimeModel,
    Unary,
)
from rvmon.testing.dice import chance, pick
from rvmon.testing.generate_formula import Shape, formula
from rvmon.testing.peers import dialects
from rvmon.testing.peers.client import Peer
from rvmon.testing.peers.core import UntranslatableError, names_in
from rvmon.testing.peers.dialects import ALWAYS_ONE, Dialect, spelling, translate
from rvmon.testing.shrink import smaller_formulas
from rvmon.testing.vocabulary import CARRIER, EVENTS, NUMBERS


@dataclass(frozen=True, slots=True)
class Contest:
    """One way to compare with one peer.

    Attributes:
        name: for the command line.
        package: its name in the package index.
        worker: of the module that asks it.
        kind: what the worker is told of time and semantics.
        dialect: the language.
        time: our time model.
        shape: what the formulas hold.
        sign: whether the peer answers with a robustness, whose sign counts; 0 says nothing.
    """

    name: str
    package: str
    worker: str
    kind: str
    dialect: Dialect
    time: TimeModel
    shape: Shape
    sign: bool = False

    def text(self, asked: Formula) -> str:
        """The formula in the peer's language."""
        return translate(asked, self.dialect)


_EVENTS = (*EVENTS, CARRIER)
_PAST = Shape(future=False, numbers=False)
_FUTURE = Shape(past=False, numbers=False)
_BOTH = Shape(numbers=False)

CONTESTS = {
    contest.name: contest
    for contest in (
        Contest(
            "reelay-discrete",
            "reelay",
            "reelay",
            "discrete",
            dialects.REELAY_DISCRETE,
            TimeModel.SAMPLED,
            replace(_PAST, step=True),
        ),
        Contest(
            "reelay-discrete-robustness",
            "reelay",
            "reelay",
            "discrete robustness",
            dialects.REELAY_ROBUSTNESS,
            TimeModel.SAMPLED,
            replace(_PAST, step=True),
            sign=True,
        ),
        Contest(
            "reelay-dense",
            "reelay",
            "reelay",
            "dense",
            dialects.REELAY_DENSE,
            TimeModel.HELD,
            _PAST,
        ),
        Contest(
            "reelay-dense-robustness",
            "reelay",
            "reelay",
            "dense robustness",
            dialects.REELAY_DENSE_ROBUSTNESS,
            TimeModel.HELD,
            _PAST,
            sign=True,
        ),
        Contest(
            "rtamt-discrete",
            "rtamt",
            "rtamt",
            "discrete",
            dialects.RTAMT_DISCRETE,
            TimeModel.SAMPLED,
            replace(_BOTH, step=True),
            sign=True,
        ),
        Contest(
            "rtamt-dense",
            "rtamt",
            "rtamt",
            "dense",
            dialects.RTAMT_DENSE,
            TimeModel.HELD,
            _BOTH,
            sign=True,
        ),
        Contest(
            "mstlo-delayed",
            "mstlo-python",
            "mstlo",
            "DelayedQualitative",
            dialects.MSTLO,
            TimeModel.HELD,
            _FUTURE,
        ),
        Contest(
            "mstlo-robustness",
            "mstlo-python",
            "mstlo",
            "DelayedQuantitative",
            dialects.MSTLO,
            TimeModel.HELD,
            _FUTURE,
            sign=True,
        ),
    )
}


def random_question(dice: random.Random, contest: Contest) -> tuple[Question | None, str]:
    """A formula that the peer can say, and a trace; or no question and the reason."""
    asked = _with_numbers(dice, formula(dice, contest.shape, dice.randint(1, 3)))
    try:
        contest.text(asked)
    except UntranslatableError as error:
        return None, str(error)
    ticks = dice.randint(2, 24)
    columns: dict[str, list[bool | float]] = {}
    for name in sorted(names_in(asked) or {"p"}):
        if name in NUMBERS:
            columns[name] = list(_walk(dice, ticks, lambda: float(dice.randint(-2, 3))))
        else:
            columns[name] = list(_walk(dice, ticks, lambda: chance(dice, 50)))
    events = frozenset(_EVENTS) & columns.keys()
    return Question(asked, columns, events, contest.time), ""


def _with_numbers(dice: random.Random, asked: Formula) -> Formula:
    """Some of the events replaced by comparisons that no value meets exactly."""
    match asked:
        case EventAtom() if chance(dice, 50):
            op = pick(dice, (CompareOp.LT, CompareOp.LE, CompareOp.GE, CompareOp.GT))
            return Compare(op, SignalValue(pick(dice, NUMBERS)), Literal(dice.randint(-1, 2) + 0.5))
        case Unary():
            return replace(asked, operand=_with_numbers(dice, asked.operand))
        case Binary():
            left = _with_numbers(dice, asked.left)
            return replace(asked, left=left, right=_with_numbers(dice, asked.right))
        case _:
            return asked


def _walk(
    dice: random.Random, ticks: int, draw: Callable[[], bool | float]
) -> Iterator[bool | float]:
    """Values that are held for a while."""
    value = draw()
    for _ in range(ticks):
        yield value
        if chance(dice, 40):
            value = draw()


def ask_peer(contest: Contest, peer: Peer, question: Question) -> list[bool | None]:
    """The peer's verdict at every tick.

    Raises:
        PeerError: it has none.
        UntranslatableError: it cannot be asked.
    """
    ticks = question.ticks
    columns: dict[str, list[Cell]] = {
        spelling(name): list(column) for name, column in question.columns.items()
    }
    columns[spelling("start")] = [tick == 0 for tick in range(ticks)]
    columns[spelling(ALWAYS_ONE)] = [True] * ticks
    text = contest.text(question.formula)
    used = {name: column for name, column in columns.items() if name in text}
    answer = peer.ask("judge", formula=text, kind=contest.kind, columns=used)
    values = answer["values"]
    if contest.sign:
        return [None if value is None or value == 0 else value > 0 for value in values]
    return [None if value is None else bool(value) for value in values]


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
