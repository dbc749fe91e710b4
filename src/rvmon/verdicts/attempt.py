"""The record of one attempt, and sequences whose attempts are created on access."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, ClassVar

from rvmon.native import Record
from rvmon.trace.sample import Scalar
from rvmon.trace.time import format_instant
from rvmon.verdicts import Verdict


class Decision(StrEnum):
    """The ways in which an attempt is settled."""

    PREFIX = "prefix"
    """Decided by a prefix of the trace, for every continuation."""

    HELD_TO_END = "held to the end"
    """Only unbounded `always` obligations were open when the trace ended."""

    POLICY = "policy"
    """Settled by the requirement's `at end` policy."""

    OPEN = "open"
    """Not settled: undecided when the trace ended, or still open."""


VERDICTS = (Verdict.FAIL, Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED)
DECISIONS = tuple(Decision)
"""Verdicts and decisions by their numbers in `core.h`."""


@dataclass(frozen=True, slots=True)
class Blame:
    """The obligation that failed, and its window.

    Attributes:
        subformula: its text in the language.
        start: index of its first character in the text of the specification.
        end: index after its last character.
        window: first and last instant of its window in ticks; the last is `None` if unbounded.
        at: the instants of the offending samples, in ticks.
    """

    subformula: str
    start: int
    end: int
    window: tuple[int, int | None]
    at: tuple[int, ...] = ()


@dataclass(slots=True)
class Attempt(Record):
    """One attempt: the obligation that a trigger started, with its verdict. Treat as immutable.

    The class is not frozen, because creation would take three times as long.

    Attributes:
        requirement: the id of its requirement.
        number: from 1 per requirement, in the order in which triggers became certain; attempts in
            doubt are numbered separately, in the order of their starts.
        triggered: instant of the trigger, ticks; for an attempt in doubt, the first instant at
            which there may have been a trigger.
        decided: the first instant at which the prefix decided it, ticks; the end of the trace if
            the end rule or a policy settled it; `None` for `I`.
        verdict: `P`, `F` or `I` (undecided).
        decision: the way it was settled.
        reason: one sentence.
        deadline: the last instant before time alone decides the obligation, ticks: unless a
            position decides it earlier, it is decided one tick later.
        at_trigger: the values of its propositions at the trigger, by their text.
        at_decision: the same at the decision.
        required: the obligation still open at the end, in the specification language.
        captured: values captured by `let` and `for each`.
        blame: the obligation that failed, for `F`.
        forecast: for an undecided attempt, `P` or `F` if every continuation leads to that verdict.
        in_doubt: whether the trigger itself is uncertain; its verdict is `P` or `I`, never `F`.
        origin: the first instant of its run, ticks, which is shown as 0 s.
        robustness: a lower bound of the distance to the other verdict, in SI units; `None` if not
            measured.
    """

    requirement: str
    number: int
    triggered: int
    decided: int | None = field()  # without a default, though Record has it as a property
    verdict: Verdict
    decision: Decision = Decision.PREFIX
    reason: str = ""
    deadline: int | None = None
    at_trigger: Mapping[str, Scalar] = field(default_factory=dict)
    at_decision: Mapping[str, Scalar] = field(default_factory=dict)
    required: str = ""
    captured: Mapping[str, Scalar] = field(default_factory=dict)
    blame: Blame | None = None
    forecast: Verdict | None = None
    robustness: float | None = None
    in_doubt: bool = False
    origin: int = 0

    _repr_html_: ClassVar[Callable[[Attempt], str]]
    """HTML for notebooks; set by `rvmon.session`, because `report` is a layer above this one."""

    def _work_out(self, name: str) -> None:
        """Compute a lazy field and those found with it; `Record` calls it on the first access."""
        if not hasattr(self, "_details"):
            raise AttributeError("nothing more is known of this attempt")
        for attribute, value in self._details(self, self._noted, name).items():
            setattr(self, attribute, value)

    def __reduce__(self) -> tuple[type[Attempt], tuple[Any, ...]]:
        """Compute all fields before copying or pickling."""
        return Attempt, tuple(getattr(self, attribute.name) for attribute in fields(self))

    @property
    def name(self) -> str:
        """Its name in texts.

        >>> Attempt("R1", 2, 0, None, Verdict.INCONCLUSIVE, Decision.OPEN, in_doubt=True).name
        'R1?2'
        """
        return f"{self.requirement}{'?' if self.in_doubt else '#'}{self.number}"

    @property
    def numbered(self) -> str:
        """The number, with a question mark before it if the attempt is in doubt."""
        return f"?{self.number}" if self.in_doubt else str(self.number)

    def __str__(self) -> str:
        """One line of text.

        >>> print(Attempt("R1", 3, 0, 2 * 10**9, Verdict.FAIL, reason="`a` false at 2 s"))
        R1#3 F at 2 s: `a` false at 2 s
        """
        when = f"triggered at {format_instant(self.triggered, self.origin)}"
        if self.decided is not None:
            when = f"at {format_instant(self.decided, self.origin)}"
        headline = f"{self.name} {self.verdict} {when}"
        return f"{headline}: {self.reason}" if self.reason else headline


_EARLY = (
    *("requirement", "number", "triggered", "decided"),
    *("verdict", "decision", "in_doubt", "origin"),
)
"""The fields that every record has from the start; the others may be computed lazily."""


def measured_attempt(attempt: Attempt, robustness: float | None) -> Attempt:
    """A copy of an attempt with its robustness set; lazy fields stay lazy.

    >>> measured_attempt(Attempt("R1", 1, 0, 5, Verdict.PASS, reason="`p`"), 0.5).robustness
    0.5
    """
    copy = Attempt.__new__(Attempt)
    for name in _EARLY:
        setattr(copy, name, getattr(attempt, name))
    copy.robustness = robustness
    copy._details = lambda _, noted, name: {name: getattr(noted, name)}
    copy._noted = attempt
    return copy


_SHOWN = 3  # the number of attempts in the `repr` of a sequence


class LazyAttempts(Sequence[Attempt]):
    """A sequence that creates attempts on access; equal to any sequence of equal attempts."""

    @abstractmethod
    def __iter__(self) -> Iterator[Attempt]:
        """The attempts in order."""

    @abstractmethod
    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """The attempts of a requirement with one verdict, in order."""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # unhashable like a list, as it equals sequences

    def __repr__(self) -> str:
        first = ", ".join([*map(repr, self[:_SHOWN]), *["…"][: len(self) - _SHOWN]])
        word = "attempt" if len(self) == 1 else "attempts"
        return f"<{len(self)} {word}: {first}>"
