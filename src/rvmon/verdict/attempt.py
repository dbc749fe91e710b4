"""The record of one attempt; attempts that are made when someone looks at them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, ClassVar

from rvmon.native import Record
from rvmon.trace.sample import Scalar
from rvmon.trace.time import format_instant
from rvmon.verdict import Verdict


class Decision(StrEnum):
    """What settled an attempt."""

    PREFIX = "prefix"
    """The samples so far leave no other value."""

    HELD_TO_END = "held to the end"
    """Only unbounded `always` obligations were open when the trace ended."""

    POLICY = "policy"
    """The requirement's `at end` policy."""

    OPEN = "open"
    """Nothing: undecided when the trace ended, or still running."""


@dataclass(frozen=True, slots=True)
class Blame:
    """The obligation that decided an attempt, and the window it spoke of.

    Attributes:
        subformula: its text as in the spec.
        start: span of the subformula in the spec's text, first character.
        end: behind the last character.
        window: first and last instant of its window in ticks; the last is `None` if unbounded.
        at: the instants of the samples that are to blame, in ticks.
    """

    subformula: str
    start: int
    end: int
    window: tuple[int, int | None]
    at: tuple[int, ...] = ()


@dataclass(slots=True)
class Attempt(Record):
    """One obligation that a trigger started; a record, which is not to be changed.

    It is not frozen: to make one would take three times as long.

    Attributes:
        requirement: its id.
        number: from 1 per requirement, in the order in which triggers became certain; attempts in
            doubt have numbers of their own, in the order of their starts.
        triggered: instant of the trigger, ticks; of an attempt in doubt, the first at which there
            may have been one.
        decided: the first instant at which the prefix left one value; the end of the trace
            for what the end rule or a policy settled; `None` for `I`.
        verdict: `P`, `F` or `I` (undecided).
        decision: what settled it.
        reason: one sentence for people.
        deadline: the last instant before time alone settles what is still required (or was),
            ticks: if no position comes that does so before, it is decided a tick later.
        at_trigger: values of its propositions at the trigger, by their text.
        at_decision: the same at the decision.
        required: what was open at the end, as text of the spec.
        captured: values captured by `let` and `for each`.
        blame: what failed, for `F`.
        forecast: `P` or `F` if no continuation can change that any more, though undecided.
        in_doubt: whether it is not known that there was a trigger: it is `I`, or undecided.
        origin: the first instant of its run, ticks: people count seconds from it.
        robustness: how far from the other verdict at least, in SI units, where somebody measured.
    """

    requirement: str
    number: int
    triggered: int
    decided: int | None
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
    """What notebooks show; `rvmon.session` sets it, as pages lie above verdicts."""

    def _work_out(self) -> None:
        """Set the fields that were never set: called when someone asks for one."""
        if not hasattr(self, "_details"):
            raise AttributeError("of this attempt nothing more is known")
        for name, value in self._details(self, self._noted).items():
            setattr(self, name, value)
        del self._details, self._noted

    def __reduce__(self) -> tuple[type[Attempt], tuple[Any, ...]]:
        """What copies and other processes get: all fields, worked out."""
        return Attempt, tuple(getattr(self, one.name) for one in fields(self))

    @property
    def name(self) -> str:
        """How people name it.

        >>> Attempt("R1", 2, 0, None, Verdict.INCONCLUSIVE, Decision.OPEN, in_doubt=True).name
        'R1?2'
        """
        return f"{self.requirement}{'?' if self.in_doubt else '#'}{self.number}"

    @property
    def numbered(self) -> str:
        """Its number, behind a question mark if it is in doubt."""
        return f"?{self.number}" if self.in_doubt else str(self.number)

    def __str__(self) -> str:
        """One line for people.

        >>> print(Attempt("R1", 3, 0, 2 * 10**9, Verdict.FAIL, reason="`a` false at 2 s"))
        R1 #3 FAIL at 2 s: `a` false at 2 s
        """
        when = f"triggered at {format_instant(self.triggered, self.origin)}"
        if self.decided is not None:
            when = f"at {format_instant(self.decided, self.origin)}"
        mark = "?" if self.in_doubt else "#"
        headline = f"{self.requirement} {mark}{self.number} {self.verdict.name} {when}"
        return f"{headline}: {self.reason}" if self.reason else headline


_EARLY = (
    *("requirement", "number", "triggered", "decided"),
    *("verdict", "decision", "in_doubt", "origin"),
)
"""The fields that every record has from the start; the others may be worked out late."""

_LATE = tuple(one.name for one in fields(Attempt) if one.name not in (*_EARLY, "robustness"))


def measured_attempt(attempt: Attempt, robustness: float | None) -> Attempt:
    """The same attempt with its robustness; what is worked out later still is.

    Args:
        attempt: without robustness.
        robustness: in SI units; `None` if it has none.

    >>> measured_attempt(Attempt("R1", 1, 0, 5, Verdict.PASS, reason="`p`"), 0.5).robustness
    0.5
    """
    made = Attempt.__new__(Attempt)
    for name in _EARLY:
        setattr(made, name, getattr(attempt, name))
    made.robustness = robustness
    made._details = lambda _, noted: {name: getattr(noted, name) for name in _LATE}
    made._noted = attempt
    return made


_SHOWN = 3
"""So many attempts stand in the text of many."""


class LazyAttempts(Sequence[Attempt]):
    """Equal to any sequence of the same attempts; its text shows the first few."""

    @abstractmethod
    def __iter__(self) -> Iterator[Attempt]:
        """The attempts, each made as it is asked for."""

    @abstractmethod
    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """Those of a requirement with one verdict, in their order, each made as it is asked for."""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # as of a list: it equals other sequences

    def __repr__(self) -> str:
        first = ", ".join([*map(repr, self[:_SHOWN]), *["…"][: len(self) - _SHOWN]])
        word = "attempt" if len(self) == 1 else "attempts"
        return f"<{len(self)} {word}: {first}>"
