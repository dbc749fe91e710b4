"""What the records of attempts say of the input: the truth of each proposition, by its text."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.language.checked.formula import (
    Arithmetic,
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
)
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.print import format_formula, format_numeric
from rvmon.testing.law.attempts import Start
from rvmon.testing.law.syntax import constant_value, parts_of, subformulas
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Truth
from rvmon.trace.sample import Scalar
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report
from tests.tools.compare import Key, key_of
from tests.tools.health import may_be_simplified

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
    parts = [one for side in (part.left, part.right) for one in parts_of(side)]
    return all(isinstance(one, Captured | Literal | Arithmetic | NowValue) for one in parts)


def _shown(part: Formula) -> str:
    """A proposition as records tell of it; of what asks whether a number is known, that."""
    match part:
        case Compare(op=CompareOp.EQ, left=left, right=right) if left == right:
            return f"known({format_numeric(left)})"
    return format_formula(part)
