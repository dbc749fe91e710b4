"""What the law says of a case, worked out once for all engines: decided, open, and seen.

How far a run has come after each call, and what an attempt waits for then, is worked out, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rvmon.language.checked import formula as rv
from rvmon.language.checked.formula import (
    Arithmetic,
    Binary,
    BinaryOp,
    BoundAtom,
    Captured,
    Compare,
    CompareOp,
    EventAtom,
    Formula,
    Literal,
    NowValue,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.language.print import format_formula, format_numeric
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.attempts import Readings, Start, counts_in_favour, obligation
from rvmon.testing.law.decisions import Followed, Followings
from rvmon.testing.law.syntax import constant_value, intervals, is_upon_end, subformulas
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Rest, Truth
from rvmon.testing.oracle import judge_views, report_on
from rvmon.trace.sample import Health, Sample, Scalar
from rvmon.trace.time import format_ticks
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report
from tests.tools.compare import Key, Outcome, key_of, outcomes
from tests.tools.health import expected_health, may_be_simplified
from tests.tools.law import word

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


_SCALARS: Mapping[Truth, tuple[Scalar, ...]] = {
    Truth.TRUE: (True,),
    Truth.FALSE: (False,),
    Truth.UNKNOWN: (None,),
    Truth.UNBORN: (True, False, None),
}
"""What is shown of a truth; what is not born is shown as the requirement takes it."""


class Seen:
    """What the attempts of a case see at their trigger and decision.

    What was seen at a decision is that of the position there, or of the one before: a decision that
    time alone brings comes before the position at its instant.
    """

    def __init__(self, spec: CheckedSpec, starts: Mapping[Key, Start]) -> None:
        self._spec = spec
        self._starts = starts
        self._values: dict[Key, _Values] = {}

    def differences(self, report: Report) -> list[str]:
        """What a monitor's report, whose attempts are the law's, gets wrong of these values."""
        lines = []
        for attempt in report.attempts:
            requirement = self._spec.requirements[attempt.requirement]
            key = key_of(attempt)
            start = self._starts[key]
            values = self._values_of(key, requirement, start)
            if not values.agree(attempt.at_trigger, start.position):
                lines.append(f"{attempt} saw {attempt.at_trigger} at its trigger")
            bare = not attempt.at_trigger and not may_be_simplified(requirement, self._spec.time)
            if bare and values.atoms:
                lines.append(f"{attempt} saw nothing at its trigger")
            if not any(values.agree(attempt.at_decision, at) for at in _positions(start, attempt)):
                lines.append(f"{attempt} saw {attempt.at_decision} at its decision")
        return lines

    def _values_of(self, key: Key, requirement: Requirement, start: Start) -> _Values:
        if key not in self._values:
            self._values[key] = _Values(requirement, start)
        return self._values[key]


def _positions(start: Start, attempt: Attempt) -> list[int]:
    """The last position up to the decision, and the one before."""
    until = attempt.triggered if attempt.decided is None else attempt.decided
    last = sum(letter.instant <= until for letter in start.word.letters) - 1
    return [last, max(last - 1, 0)]


class _Values:
    """The truths of the propositions of a requirement, for one of its attempts."""

    def __init__(self, requirement: Requirement, start: Start) -> None:
        self.truths = Truths(start.word, start.captured)
        parts = [*subformulas(requirement.trigger), *subformulas(requirement.consequent)]
        # A `known` that is asked for is shown, not that of a number beside it with the same text,
        # unless a constant decides what it stands in.
        settled = [one for one in parts if constant_value(one) is not Truth.UNKNOWN]
        idle = {id(part) for one in settled for part in subformulas(one)}
        parts.sort(key=lambda part: (id(part) not in idle, isinstance(part, ProbeAtom)))
        self.atoms: dict[str, Formula] = {
            _shown(part): part
            for part in parts
            if isinstance(part, SignalAtom | EventAtom | ProbeAtom | Compare | BoundAtom)
            and not (isinstance(part, Compare) and _reads_nothing(part))
        }

    def agree(self, seen: Mapping[str, Scalar], position: int) -> bool:
        """Whether the values are those of a position."""
        return all(
            text in self.atoms and value in _SCALARS[self.truths.state(self.atoms[text], position)]
            for text, value in seen.items()
        )


def _reads_nothing(part: Compare) -> bool:
    """Whether it is of captured values and constants alone."""
    parts = [*rv.numbers_in(part.left, part.right)]
    return all(isinstance(one, Captured | Literal | Arithmetic | NowValue) for one in parts)


def _shown(part: Formula) -> str:
    """A proposition as records tell of it; of what asks whether a number is known, that."""
    match part:
        case Compare(op=CompareOp.EQ, left=left, right=right) if left == right:
            return f"known({format_numeric(left)})"
    return format_formula(part)


class Judgement:
    """The oracle's view of a case; each part is made when it is first asked for, and kept."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.word = word(case)
        self.followings: Mapping[str, Followings] = judge_views(case.spec, self.word, case.samples)

    @cached_property
    def report(self) -> Report:
        """The oracle's report."""
        samples = self.case.samples
        origin = samples[0].t if samples else 0
        return report_on(self.case.spec, self.followings, origin=origin, end=self.word.end)

    @cached_property
    def outcomes(self) -> Mapping[Key, Outcome]:
        """The outcome of every attempt."""
        return outcomes(self.report)

    @cached_property
    def health(self) -> Sequence[Health]:
        """The findings on the inputs."""
        return expected_health(self.case, self.word)

    @cached_property
    def seen(self) -> Seen:
        """What attempts see of the inputs."""
        starts = {
            key: one.start
            for name, followings in self.followings.items()
            for one in followings.attempts
            for key in ((name, False, one.number), (name, True, one.doubtful_number))
        }
        return Seen(self.case.spec, starts)

    def at(self, moment: Moment) -> tuple[dict[Key, Outcome], dict[Key, Waiting]]:
        """What the prefix has decided at a moment, and what waits; without attempts upon `end`.

        A decision before the instant that time has come to is the same however much is known
        later; one at that very instant may have needed its letter, which is tried.
        """
        decided: dict[Key, Outcome] = {}
        waiting: dict[Key, Waiting] = {}
        for key, requirement, one in self._begun(moment):
            simplified = may_be_simplified(requirement, self.case.spec.time)
            here = Waiting(one.start, moment, simplified=simplified)
            if self._is_decided(one, moment, here):
                if key in self.outcomes:  # what was met in doubt vanishes
                    decided[key] = self.outcomes[key]
            else:
                waiting[key] = here
        return decided, waiting

    def _is_decided(self, one: Followed, moment: Moment, here: Waiting) -> bool:
        if one.decided is None or one.decided[0] > moment.reached:
            return False
        if one.decided[0] < moment.reached or moment.end == moment.reached:
            return True
        return here.truth is not Truth.UNKNOWN

    def _begun(self, moment: Moment) -> Iterator[tuple[Key, Requirement, Followed]]:
        """The attempts whose trigger is known at a moment."""
        for name, followings in self.followings.items():
            requirement = self.case.spec.requirements[name]
            if is_upon_end(requirement):
                continue
            for one in followings.attempts:
                if one.start.triggered <= moment.end:
                    yield (name, *_number_at(one, moment)), requirement, one


def _number_at(one: Followed, moment: Moment) -> tuple[bool, int]:
    """Whether an attempt is in doubt at a moment, and its number then."""
    sure = one.start.sure
    if sure is not None and one.start.word.letters[sure].instant <= moment.end:
        return False, one.number
    return True, one.doubtful_number
