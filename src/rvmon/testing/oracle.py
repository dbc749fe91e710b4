"""The reference oracle: the law of SEMANTICS.md in its slow, obvious, executable form.

Every position is explicit, every truth is computed by recursion from its definition, and the
instant of a decision is found by trying every instant in turn. Engines are tested against it; it
shares no code with them. Traces have to be short: every tick of held time is a position.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from rvmon.errors import TraceError
from rvmon.spec.checked import (
    CheckedSpec,
    EndPolicy,
    Requirement,
)
from rvmon.testing.attempts import Start, is_upon_end, obligation, starts
from rvmon.testing.kleene import Truth
from rvmon.testing.truths import Rest, Truths
from rvmon.testing.word import Word
from rvmon.testing.wording import word_of
from rvmon.trace.sample import Sample, Scalar, Trace, Value
from rvmon.verdict.assemble import report_of
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


class HasChecked(Protocol):
    """A public spec: it carries the checked one."""

    @property
    def checked(self) -> CheckedSpec:
        """Names, types, units and formulas, settled."""


def evaluate(
    spec: CheckedSpec | HasChecked,
    samples: Trace | Iterable[Sample | tuple[int, Mapping[str, Value]]],
    *,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
) -> Report:
    """Judge a trace by the definitions.

    Args:
        spec: checked, or the public `Spec`.
        samples: a trace, or samples or pairs `(ticks, values)` with strictly increasing times.
        end: the instant given to `finish`, ticks; default the trace's own, if it has one.
        advances: the instants given to `advance`, ticks, in whatever order fits the samples.
        names: the names that have a source; default the trace's own, else all.

    Returns:
        The report, without reasons.

    Raises:
        TimeOrderError: the times do not increase.
        TraceError: the trace is too long to be laid out tick by tick, a sample holds a name
            without a source, or two payloads of an event though not every requirement is a `for
            each`.

    Cost: without bound on purpose; some milliseconds for a dozen samples within forty ticks.

    Source: SEMANTICS, sections 1 to 3; decision record 1.
    """
    checked = spec if isinstance(spec, CheckedSpec) else spec.checked
    if isinstance(samples, Trace):
        end = samples.end if end is None else end
        names = samples.names if names is None else names
    listed = [entry if isinstance(entry, Sample) else Sample(*entry) for entry in samples]
    word = word_of(checked, listed, end=end, advances=advances, names=names)
    followed = follow(checked, word, listed)
    return report_on(checked, followed, origin=listed[0].t if listed else 0, end=word.end)


@dataclass(frozen=True, slots=True)
class Followed:
    """One attempt, and the first instant at which the prefix decides it, with its truth then."""

    start: Start
    decided: tuple[int, Truth] | None


def follow(
    spec: CheckedSpec, word: Word, samples: Sequence[Sample]
) -> dict[str, Sequence[Followed]]:
    """The attempts of each requirement on a word, in order of trigger.

    Args:
        spec: gives the requirements.
        word: the trace, position by position.
        samples: what it was made from.

    Raises:
        TraceError: two payloads of an event, though not every requirement is a `for each`.
    """
    _refuse_double_payloads(spec.requirements.values(), samples)
    found: dict[str, Sequence[Followed]] = {}
    for name, requirement in spec.requirements.items():
        begun = starts(requirement, word)
        decisions = _decisions(requirement, word, begun)
        found[name] = [Followed(*pair) for pair in zip(begun, decisions, strict=True)]
    return found


def report_on(
    spec: CheckedSpec, followed: Mapping[str, Sequence[Followed]], *, origin: int, end: int | None
) -> Report:
    """The report on attempts that were followed to the end of the trace.

    Args:
        spec: gives the requirements.
        followed: by requirement, from `follow`.
        origin: the instant of the first sample.
        end: the last instant whose letter is known.
    """
    attempts = [
        _record(spec.requirements[name], one.start, number, one.decided)
        for name, begun in followed.items()
        for number, one in enumerate(begun, start=1)
    ]
    return report_of(tuple(spec.requirements), attempts, origin=origin, end=end)


def _decisions(
    requirement: Requirement, word: Word, begun: Sequence[Start]
) -> list[tuple[int, Truth] | None]:
    """For each attempt the first instant at which its truth is not UNKNOWN, and that truth."""
    found: list[tuple[int, Truth] | None] = [None] * len(begun)
    if not begun:
        return found
    # Attempts with the same word and captured values share what they remember.
    shared: dict[tuple[int, tuple[tuple[str, Scalar], ...]], Truths] = {}
    keys = [(id(start.word), tuple(start.captured.items())) for start in begun]
    for start, key in zip(begun, keys, strict=True):
        shared.setdefault(key, Truths(start.word, start.captured))
    first = word.letters[begun[0].position].instant
    for reached in range(first, word.reached + 1):
        for truths in shared.values():
            truths.reach(reached)
        for n, start in enumerate(begun):
            if found[n] is None and word.letters[start.position].instant <= reached:
                truth = obligation(requirement, start, shared[keys[n]])
                if truth is not Truth.UNKNOWN:
                    found[n] = (reached, truth)
    return found


def _record(
    requirement: Requirement, start: Start, number: int, decided: tuple[int, Truth] | None
) -> Attempt:
    triggered = start.word.letters[start.position].instant
    end = start.word.end
    assert end is not None, "a word with positions has an end"  # noqa: S101
    instant: int | None
    if decided is not None:
        instant, truth = decided
        verdict = Verdict.PASS if truth is Truth.TRUE else Verdict.FAIL
        decision = Decision.PREFIX
    else:
        verdict, decision = _settle(requirement, start)
        instant = None if verdict is Verdict.INCONCLUSIVE else end
    if is_upon_end(requirement):
        triggered = end
        instant = None if instant is None else end
    return Attempt(
        requirement.id,
        number,
        triggered,
        instant,
        verdict,
        decision,
        captured=dict(start.captured),
    )


def _settle(requirement: Requirement, start: Start) -> tuple[Verdict, Decision]:
    """What becomes of an undecided attempt at the end of the trace.

    Source: SEMANTICS, section 3 (The end); decision record 1 (The end, Policies).
    """

    def under(rest: Rest) -> Truth:
        return obligation(requirement, start, Truths(start.word, start.captured, rest))

    open_ = (Verdict.INCONCLUSIVE, Decision.OPEN)
    match requirement.at_end:
        case EndPolicy.DEFAULT:
            held = under(Rest.END) is Truth.TRUE
            return (Verdict.PASS, Decision.HELD_TO_END) if held else open_
        case EndPolicy.STRICT:
            return open_
        case EndPolicy.WEAK:
            return (Verdict.PASS, Decision.POLICY) if under(Rest.WEAK) is Truth.TRUE else open_
        case EndPolicy.STRONG:
            failed = under(Rest.STRONG) is Truth.FALSE
            return (Verdict.FAIL, Decision.POLICY) if failed else open_
        case EndPolicy.PASS | EndPolicy.FAIL:
            if Truth.UNKNOWN in (under(Rest.WEAK), under(Rest.STRONG)):
                return open_
            passed = requirement.at_end is EndPolicy.PASS
            return (Verdict.PASS if passed else Verdict.FAIL), Decision.POLICY


def _refuse_double_payloads(requirements: Iterable[Requirement], samples: Sequence[Sample]) -> None:
    if all(requirement.for_each is not None for requirement in requirements):
        return
    for sample in samples:
        for name, value in sample.values.items():
            if isinstance(value, tuple) and len(value) > 1:
                raise TraceError(
                    f"sample at {sample.t} ns holds {len(value)} payloads of `{name}`: "
                    "only a requirement `for each` can tell them apart"
                )
