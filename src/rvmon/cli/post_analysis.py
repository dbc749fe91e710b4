"""What is asked of a recording when its verdicts are known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import islice, takewhile
from typing import TYPE_CHECKING

from rvmon.cli.reading import opened
from rvmon.readers.blocks import NotPlainError
from rvmon.readers.recording import can_be_read_again
from rvmon.readers.source import Source
from rvmon.session import Spec
from rvmon.trace.sample import Sample, Trace
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rvmon.explain.late import Known
    from rvmon.formula.state import Leaf
    from rvmon.plan.graph import Graph
    from rvmon.readers.recording import FileRecording
    from rvmon.spec.checked.formula import Formula
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report

MOST_LATE = 1000
"""Failures of a requirement of which it is looked up whether what they awaited came late."""

MOST_LATE_IN_ALL = 10_000
"""The same of all requirements, of which each gets its share, and at least one."""


def in_order(recording: Iterable[Sample]) -> list[Sample]:
    """The samples in order of time, equal stamps merged (under `max delay` they may come late)."""
    merged: dict[int, Sample] = {}
    for sample in recording:
        known = merged.get(sample.t)
        values = sample.values if known is None else {**known.values, **sample.values}
        merged[sample.t] = Sample(sample.t, values)
    return [merged[t] for t in sorted(merged)]


def post_analysis(spec: Spec, recording: FileRecording, report: Report, *, goals: bool) -> Report:
    """The report with the cover goals, and with what only the whole recording shows.

    That is what the triggers lacked that never came true, and what came after its deadline.

    Streams cannot be read again.
    """
    trace, names, end = recording.path, recording.names, report.end
    if end is None or not can_be_read_again(trace):
        return report

    @cache
    def samples() -> Sequence[Sample]:
        read: Iterable[Sample] = spec.recording(trace)
        if spec.checked.max_delay is None:  # what comes behind may be broken
            read = takewhile(lambda sample: sample.t <= end, read)
        return [sample for sample in in_order(read) if sample.t <= end]

    if goals and spec.checked.covers:
        report = replace(report, goals=_goals(spec, trace, end, names, samples))

    late = _missed(spec, report)
    silent = _silent(spec, report)
    asked = [graph for graph, _ in late.values()] + list(silent.values())
    changes = _changes(spec, recording, asked, end, samples)

    def read(leaves: frozenset[Leaf] | None) -> Sequence[Sample]:
        return samples() if leaves is None else changes[leaves]

    return replace(
        report,
        late=_late(spec, late, read, end, names),
        misses=_misses(spec, silent, read, end, names),
    )


def _missed(spec: Spec, report: Report) -> Mapping[str, tuple[Graph | None, Sequence[Attempt]]]:
    """By requirement what its first failures awaited, if values are all that counts, and these."""
    failed = [name for name, verdict in report.verdicts.items() if verdict == "F"]
    if not failed:
        return {}
    from rvmon.explain.late import awaited
    from rvmon.explain.states import values_read

    most = max(1, min(MOST_LATE, MOST_LATE_IN_ALL // len(failed)))
    found = {}
    for name in failed:
        requirement = spec.requirements[name]
        attempts: list[Attempt] = []
        formulas: set[Formula] = set()
        for attempt in islice(report.of(name, Verdict.FAIL), most):
            formula = awaited(requirement, attempt)
            if formula is not None:
                attempts.append(attempt)
                formulas.add(formula)
        if attempts:
            found[name] = values_read(spec.checked, requirement, formulas), attempts
    return found


def _silent(spec: Spec, report: Report) -> dict[str, Graph | None]:
    """The requirements without attempts, and their triggers, if values are all that counts."""
    names = [name for name in report.verdicts if report.is_silent(name)]
    if not names:
        return {}
    from rvmon.explain.not_triggered import read_as_values

    return {name: read_as_values(spec.checked, spec.requirements[name]) for name in names}


def _late(
    spec: Spec,
    missed: Mapping[str, tuple[Graph | None, Sequence[Attempt]]],
    read: Callable[[frozenset[Leaf] | None], Sequence[Sample]],
    end: int,
    sources: frozenset[str] | None,
) -> Mapping[str, Mapping[int, int]]:
    """What came after its deadline; requirements that read the same are looked up together."""
    if not missed:
        return {}
    from rvmon.explain.late import late_arrivals

    alike: dict[frozenset[Leaf] | None, list[str]] = {}
    for name, (graph, _) in missed.items():
        alike.setdefault(_leaves(graph), []).append(name)
    found = {}
    for leaves, own in alike.items():
        known: Known = {}
        samples = read(leaves)
        for name in own:
            requirement, attempts = spec.requirements[name], missed[name][1]
            late = late_arrivals(
                spec.checked, requirement, attempts, samples, end, sources, known=known
            )
            if late:
                found[name] = late
    return found


def _misses(
    spec: Spec,
    silent: Mapping[str, Graph | None],
    read: Callable[[frozenset[Leaf] | None], Sequence[Sample]],
    end: int,
    sources: frozenset[str] | None,
) -> dict[str, str]:
    """What the triggers lacked that never came true; the same trigger is looked at once."""
    if not silent:
        return {}
    from rvmon.explain.not_triggered import why_not_triggered
    from rvmon.spec.print.printer import format_formula

    known: dict[str, str] = {}
    found = {}
    for name, graph in silent.items():
        requirement = spec.requirements[name]
        trigger = format_formula(requirement.trigger)
        if trigger not in known or requirement.for_each is not None:
            samples = read(_leaves(graph))
            known[trigger] = why_not_triggered(spec.checked, requirement, samples, end, sources)
        found[name] = known[trigger]
    return {name: miss for name, miss in found.items() if miss}


def _leaves(graph: Graph | None) -> frozenset[Leaf] | None:
    """What a graph reads: those that read the same can become another at the same samples."""
    if graph is None:
        return None
    return frozenset(node.leaf for node in graph.nodes if node.leaf is not None)


def _changes(
    spec: Spec,
    judged: FileRecording,
    asked: Iterable[Graph | None],
    end: int,
    samples: Callable[[], Sequence[Sample]],
) -> Mapping[frozenset[Leaf] | None, Sequence[Sample]]:
    """What changes, by the leaves of graphs; read by columns if the file is plain."""
    alike = {_leaves(graph): graph for graph in asked if graph is not None}
    if not alike:
        return {}
    from rvmon.explain.changes import changes_in_blocks, changes_in_samples

    graphs = tuple(alike.values())
    if judged.only_block is not None:  # a short file, which need not be read again
        found = changes_in_blocks([judged.only_block], graphs, spec.checked, end)
        return dict(zip(alike, found, strict=True))
    recorded: Iterable[Sample]
    if spec.checked.max_delay is None:
        looked_at = frozenset(name for graph in graphs for name in graph.by_name)
        recording = opened(spec, judged.path, only=looked_at)
        with suppress(NotPlainError):
            if recording.is_short:
                raise NotPlainError("its samples are sooner looked at")
            blocks = recording.blocks(lambda: looked_at)
            found = changes_in_blocks(blocks, graphs, spec.checked, end)
            return dict(zip(alike, found, strict=True))
        recorded = takewhile(lambda sample: sample.t <= end, recording)
    else:
        recorded = samples()
    found = changes_in_samples(recorded, [graph.by_name for graph in graphs], spec.checked.events)
    return dict(zip(alike, found, strict=True))


def _goals(
    spec: Spec,
    trace: str,
    end: int,
    names: frozenset[str] | None,
    samples: Callable[[], Sequence[Sample]],
) -> Mapping[str, Verdict]:
    from rvmon.verdict.cover_goals import goal_verdicts, goals_as_requirements

    goals = Spec(goals_as_requirements(spec.checked))
    if spec.checked.max_delay is None:
        source = Source(spec.recording(trace), end, is_cut=True)
    else:
        source = Source(Trace(tuple(samples()), names, end))
    return goal_verdicts(goals.judge(source))
