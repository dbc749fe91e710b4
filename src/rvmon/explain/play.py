"""Short runs, judged by the project's own monitor, with what distinguishes situations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rvmon.automaton.location import PASSED
from rvmon.automaton.machine import Machine, Token
from rvmon.explain.example import Example
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.records.ledger import Ledger
from rvmon.runtime.table import next_cut
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Sample
from rvmon.verdict.report import report_of


@dataclass(frozen=True, slots=True)
class Played:
    """A short run, judged.

    Attributes:
        example: the run as it stands if it ends here.
        situation: equal for runs that go on alike, as far as the search looks.
        cut: the next instant after its end at which time alone may change something.
    """

    example: Example
    situation: tuple[object, ...]
    cut: int


def play(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    samples: Sequence[Sample],
    end: int,
) -> Played:
    """Judge a short run.

    Args:
        compiled: the specification.
        requirements: of it, those that are looked at.
        samples: at least one.
        end: the instant at which the run ends, ticks, at or after the last sample.
    """
    ledger = Ledger()
    evaluators = Evaluators(compiled.checked, requirements, "auto", None, ledger)
    for sample in samples:
        evaluators.through(sample.t - 1)
        evaluators.sample(sample.t, sample.values)
    evaluators.through(end)
    for judge in evaluators.judges:
        judge.pass_to(end)
    ledger.flush()
    decided = tuple(sorted({(a.requirement, a.verdict) for a in ledger.attempts}))
    situation = (decided, *_situation(evaluators, end))
    cut = min((*_cuts(evaluators, end), NEVER))
    evaluators.finish(end, end)
    ledger.flush()
    ids = [one.requirement.id for one in requirements]
    report = report_of(ids, ledger.attempts, origin=samples[0].t, end=end)
    example = Example(tuple(samples), end, report.verdicts, tuple(report.attempts))
    return Played(example, situation, cut)


def _cuts(evaluators: Evaluators, end: int) -> Iterator[int]:
    for evaluator in evaluators.all:
        yield evaluator.next_change()
    for judge in evaluators.judges:
        for attempt in judge.attempts:
            if isinstance(judge, MachineJudge):
                for token in _tokens(attempt.token, attempt.better):
                    yield next_cut(judge.machine, token, end)
        if isinstance(judge, NetworkJudge):
            yield judge.next_due


def _tokens(*tokens: Token | None) -> Iterator[Token]:
    return (token for token in tokens if token is not None and token[0] > PASSED)


def _situation(evaluators: Evaluators, end: int) -> Iterator[object]:
    for evaluator in evaluators.all:
        yield from _evaluator(evaluator, end)
    for judge in evaluators.judges:
        yield tuple(judge.captured.items()) if judge.attempts else ()
        if isinstance(judge, NetworkJudge):
            yield judge.situation(end)
        elif isinstance(judge, MachineJudge):
            yield _standings(judge, end)


def _standings(judge: MachineJudge, end: int) -> object:
    return frozenset(
        (
            _relative(judge.machine, attempt.token, end),
            attempt.better and _relative(judge.machine, attempt.better, end),
        )
        for attempt in judge.attempts
    )


def _evaluator(evaluator: Evaluator, end: int) -> Iterator[object]:
    yield tuple(evaluator.v)
    yield evaluator.next_change() - end
    yield tuple(
        evaluator.since[operand] - end
        for place in evaluator.graph.stateful
        for operand in evaluator.graph.operands[place]
    )
    for value, seen, stale_at in zip(evaluator.s, evaluator.h, evaluator.stale_at, strict=True):
        if stale_at < NEVER:
            yield value, stale_at - end
        if seen is not None:
            yield value, seen.updates and seen.at - end, seen.before, seen.before_at - seen.at
    for rule in evaluator.starters:
        if rule.trigger >= 0:
            yield (rule.before, rule.running)


def _relative(machine: Machine, token: Token, end: int) -> object:
    """A token with ages in place of instants; ages beyond the last cut are alike."""
    location, anchors = token
    if location <= PASSED:
        return location
    cuts = machine.cuts(location)
    ages = (
        min(end - anchor, own[-1] if own else 0) for anchor, own in zip(anchors, cuts, strict=True)
    )
    return (location, *ages)
