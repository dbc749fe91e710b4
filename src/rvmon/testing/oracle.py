"""The reference oracle: the semantics in slow, obvious, executable form.

Every position is explicit, every truth is computed recursively from its definition, and the instant
of a decision is found by trying every instant in turn. The core is tested against the oracle, which
shares no code with it. Traces have to be short: every tick of held time is a position.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from rvmon.errors import TraceError
from rvmon.language.checked.specification import CheckedSpec, EndPolicy, Requirement
from rvmon.testing.law.attempts import Start, obligation
from rvmon.testing.law.decisions import Followed, Followings, follow
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.syntax import is_upon_end
from rvmon.testing.law.word import Outage, Rest, Truth, Word
from rvmon.trace.sample import Sample, Trace, Value
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision
from rvmon.verdicts.report import Report, report_of


class HasChecked(Protocol):
    """A public specification (`rvmon.Spec`), which has the checked one."""

    @property
    def checked(self) -> CheckedSpec:
        """The checked specification."""


def evaluate(
    spec: CheckedSpec | HasChecked,
    samples: Trace | Iterable[Sample | tuple[int, Mapping[str, Value]]],
    *,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
    outages: Iterable[Outage] = (),
) -> Report:
    """Judge a trace by the definitions of the semantics.

    Args:
        spec: the checked specification, or the public `Spec`.
        samples: a trace, or samples or pairs `(ticks, values)` with strictly increasing times.
        end: the instant passed to `finish`, ticks; default the trace's own end, if it has one.
        advances: the instants passed to `advance`, ticks, in an order that fits the samples.
        names: the names that have a source; default the trace's own, else all.
        outages: the outages, in any order.

    Returns:
        The report, without reasons.

    Raises:
        TimeOrderError: the times do not increase strictly.
        TraceError: the trace is too long to be laid out tick by tick; or a sample holds a name
            without a source, or two payloads of an event while some requirement has no `for each`.

    Cost: unbounded, on purpose; some milliseconds for a dozen samples within forty ticks.

    Source: SEMANTICS, sections 1 to 3 and 5; decision records 1 and 4.
    """
    checked = spec if isinstance(spec, CheckedSpec) else spec.checked
    if isinstance(samples, Trace):
        end = samples.end if end is None else end
        names = samples.names if names is None else names
    listed = [entry if isinstance(entry, Sample) else Sample(*entry) for entry in samples]
    word = word_of(checked, listed, end=end, advances=advances, names=names, outages=tuple(outages))
    followings = judge_views(checked, word, listed)
    return report_on(checked, followings, origin=listed[0].t if listed else 0, end=word.end)


def judge_views(spec: CheckedSpec, word: Word, samples: Sequence[Sample]) -> dict[str, Followings]:
    """Judge the attempts of each requirement on a word.

    Raises:
        TraceError: two payloads of an event while some requirement has no `for each`.
        RvmonError: the `pulse` of a requirement disagrees with the syntax of its trigger.
    """
    _refuse_double_payloads(spec.requirements.values(), samples)
    return {name: follow(requirement, word) for name, requirement in spec.requirements.items()}


def report_on(
    spec: CheckedSpec, followings: Mapping[str, Followings], *, origin: int, end: int | None
) -> Report:
    """The report of attempts that were followed to the end of the trace."""
    attempts = [
        record
        for following in followings.values()
        for followed in following.attempts
        if (record := _record(followed, origin)) is not None
    ]
    undetermined = [name for name, following in followings.items() if not following.is_determined]
    return report_of(
        tuple(spec.requirements), attempts, incomplete=undetermined, origin=origin, end=end
    )


def _record(followed: Followed, origin: int) -> Attempt | None:
    """The record of an attempt; `None` for an attempt in doubt whose obligation is met."""
    start = followed.start
    requirement = start.view.requirement
    triggered = start.triggered
    end = start.word.end
    assert end is not None, "a word with positions has an end"
    instant: int | None
    if followed.decided is not None:
        instant, truth = followed.decided
        verdict = Verdict.PASS if truth is Truth.TRUE else Verdict.FAIL
        decision = Decision.PREFIX
    else:
        verdict, decision = _settle(requirement, start)
        instant = None if verdict is Verdict.INCONCLUSIVE else end
    if start.sure is None:
        if verdict is Verdict.PASS:
            return None
        verdict, decision, instant = Verdict.INCONCLUSIVE, Decision.OPEN, None
    if is_upon_end(requirement):
        triggered = end
        instant = None if instant is None else end
    return Attempt(
        requirement.id, followed.number if start.sure is not None else followed.doubtful_number,
        triggered, instant, verdict, decision,
        in_doubt=start.sure is None, captured=dict(start.captured), origin=origin,
    )  # fmt: skip


def _settle(requirement: Requirement, start: Start) -> tuple[Verdict, Decision]:
    """The verdict of an undecided attempt at the end of the trace, and its decision.

    Source: SEMANTICS, section 3 (The end, Doubt); decision records 1 (The end, Policies) and 4.
    """

    def under(rest: Rest) -> Truth:
        return obligation(start, start.view.readings(rest))

    open_ = (Verdict.INCONCLUSIVE, Decision.OPEN)
    certain = start.sure is not None and not start.may_be_over
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
            return (Verdict.FAIL, Decision.POLICY) if failed and certain else open_
        case EndPolicy.PASS | EndPolicy.FAIL:
            if not certain or Truth.UNKNOWN in (under(Rest.WEAK), under(Rest.STRONG)):
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
                    "only a requirement `for each` can distinguish them"
                )
