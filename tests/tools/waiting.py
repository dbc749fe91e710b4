"""How far a run has come after each call, and what an attempt waits for then, by the law."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.language.checked.specification import Mode, TimeModel
from rvmon.language.print import format_formula
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.attempts import Readings, Start, counts_in_favour, obligation
from rvmon.testing.law.syntax import intervals, subformulas
from rvmon.testing.law.word import Rest, Truth
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_ticks

_PART = re.compile(r"(`[^`]*`(?: (?:by|until) .*?)?)(?:(?: and |, or )(?=`)|$)")

_PAST = {
    *(UnaryOp.ONCE, UnaryOp.HISTORICALLY, UnaryOp.HELD, UnaryOp.PREVIOUS),
    *(UnaryOp.RISE, UnaryOp.FALL, BinaryOp.SINCE),
}


_EDGES = {UnaryOp.RISE, UnaryOp.FALL}


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known of a trace at some moment.

    Attributes:
        end: the last instant whose letter is known.
        reached: the instant that time is known to have come to.
    """

    end: int
    reached: int


def moments(case: Case, *, settle: str = "now") -> Iterator[Moment | None]:
    """After each action of a case, what a monitor knows; `None` before it knows a letter.

    Args:
        case: what it is told.
        settle: `now`, or `next`: a sample counts once the time of another call is behind it.

    Source: SEMANTICS 6; decision record 1 (What is known of a trace at a moment).
    """
    last: int | None = None
    waiting: int | None = None
    reached: int | None = None
    for action in case.actions:
        t = action.t if isinstance(action, Sample) else action
        if waiting is not None and waiting < t:
            last, waiting = waiting, None
        if isinstance(action, Sample) and settle == "now":
            last = t
        elif isinstance(action, Sample):
            waiting = t
        reached = t if reached is None else max(reached, t)
        if last is None:
            yield None
        else:
            sampled = case.spec.time is TimeModel.SAMPLED
            yield Moment(last if sampled else max(last, reached - 1), reached)


class Waiting:
    """One attempt as it stands at a moment.

    Args:
        requirement: of the attempt.
        start: of the attempt.
        moment: at or after its trigger.
        simplified: whether an engine may owe something simpler, of the same meaning.

    Attributes:
        triggered: the instant of the trigger.
    """

    def __init__(self, start: Start, moment: Moment, *, simplified: bool) -> None:
        requirement = start.view.requirement
        letters = tuple(one for one in start.word.letters if one.instant <= moment.end)
        word = replace(start.word, letters=letters, end=moment.end, reached=moment.reached)
        self.triggered = start.triggered
        self._requirement = requirement
        sure = start.sure
        stop = start.stop
        self._void = (
            counts_in_favour(requirement)
            and stop is not None
            and start.word.letters[stop].instant <= moment.end
            and start.view.is_unborn(stop)
        )
        self._in_doubt = sure is None or start.word.letters[sure].instant > moment.end
        self._simplified = simplified
        self._start = start
        self._letters = letters
        self._reached = moment.reached
        self._readings = Readings(word, Rest.UNKNOWN)
        self._truths = self._readings.of(start.captured, favour=counts_in_favour(requirement))
        parts = [*subformulas(requirement.consequent)]
        edges = [one for one in parts if isinstance(one, Unary) and one.op in _EDGES]
        # `rise φ` is `φ and not previous φ`: both may be told by themselves.
        parts += [Unary(UnaryOp.PREVIOUS, one.operand) for one in edges]
        looks_back = any(isinstance(p, Unary | Binary) and p.op in _PAST for p in parts)
        self._concerned = range(0 if looks_back else start.position, len(letters))
        self._parts = parts

    @property
    def truth(self) -> Truth:
        """Of what is required."""
        return obligation(self._start, self._readings)

    def deadline(self) -> int | None:
        """The last instant before time alone decides, if nothing more comes; to be asked last.

        Only at the end of a window can time alone decide something: all of these are tried. What
        is in doubt, or was over before all was born, is told to have none.
        """
        if self._in_doubt or self._void:
            return None
        highs = {window.high for window in intervals(self._requirement.consequent)}
        ends = {
            self._letters[position].instant + high
            for position in self._concerned
            for high in highs
            if high is not None
        }
        for last in sorted(end for end in ends if end >= self._reached):
            self._readings.reach(last + 1)
            if self.truth is not Truth.UNKNOWN:
                return last
        return None

    def misnamed(self, required: str, origin: int) -> Iterator[str]:
        """What is said to be required though it is none of the parts that wait for something."""
        parts = _PART.findall(required) or ([required] if required else [])
        wrong = set(parts)
        allowed = self._undecided(origin)
        while wrong and (name := next(allowed, None)):
            wrong.discard(name)
        yield from (part for part in parts if part in wrong)

    def _undecided(self, origin: int) -> Iterator[str]:
        """Parts whose truth at a position since the trigger is open, as a record names them."""
        for part in self._parts:
            for position in self._concerned:
                signs = (
                    self._truths.truth(part, position, positive=sign) for sign in (True, False)
                )
                if Truth.UNKNOWN in signs:
                    yield from _named(part, self._letters[position].instant - origin)
        held = any(isinstance(part, Unary) and part.op is UnaryOp.HELD for part in self._parts)
        if (
            self._requirement.mode is Mode.WHENEVER  # required at every position to come
            or self._in_doubt
            or self._simplified  # what a part was made into may have no name of its own
            or held
        ):
            yield f"`{format_formula(self._requirement.consequent)}`"


def _named(part: Formula, since: int) -> Iterator[str]:
    window = None
    if isinstance(part, Unary | Binary) and part.op not in _PAST:
        window = part.interval
    until = None if window is None or window.high is None else format_ticks(since + window.high)
    for shown in (part, Unary(UnaryOp.NOT, part)):
        text = f"`{format_formula(shown)}`"
        if until is None:
            yield text
        else:
            yield from (f"{text} by {until}", f"{text} until {until}")
