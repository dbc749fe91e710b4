"""What is asked of a recording when its verdicts are known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import islice, takewhile
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.readers.blocks import NotPlainError
from rvmon.session import Spec
from rvmon.trace.sample import Sample

if TYPE_CHECKING:
    from rvmon.verdict.report import Report
    from rvmon.verdict.verdict import Verdict

MOST_LATE = 1000
"""Failures of a requirement of which it is looked up whether what they awaited came late."""


def in_order(recording: Iterable[Sample]) -> list[Sample]:
    """The samples in order of time, equal stamps merged (under `max delay` they may come late)."""
    merged: dict[int, Sample] = {}
    for sample in recording:
        known = merged.get(sample.t)
        values = sample.values if known is None else {**known.values, **sample.values}
        merged[sample.t] = Sample(sample.t, values)
    return [merged[t] for t in sorted(merged)]


def can_be_read_again(trace: str) -> bool:
    """Whether a recording is a file, and not a stream that is gone when it was read."""
    return trace != "-" and not Path(trace).is_fifo()


def second_look(
    spec: Spec, trace: str, report: Report, names: frozenset[str] | None, *, goals: bool
) -> Report:
    """The report with the cover goals, and with what only the whole recording tells.

    That is what the triggers lacked that never came true, and what came after its deadline.

    Streams cannot be read again.

    Args:
        spec: the specification.
        trace: the path of the recording.
        report: on it.
        names: the signals and events that have a source; `None`: all.
        goals: whether the cover goals are asked for.
    """
    silent = [name for name in report.verdicts if report.is_silent(name)]
    end = report.end
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

    def read(names: frozenset[str] | None) -> Sequence[Sample]:
        few = None if names is None else _changes(spec, trace, names, end)
        return samples() if few is None else few

    late = {
        name: _late(spec, report, name, names, read, end)
        for name, verdict in report.verdicts.items()
        if verdict == "F"
    }
    report = replace(report, late={name: found for name, found in late.items() if found})
    if not silent:
        return report
    from rvmon.explain.miss import nearest_miss, read_as_values

    found = {}
    for name in silent:
        requirement = spec.requirements[name]
        few = read(read_as_values(spec.checked, requirement))
        found[name] = nearest_miss(spec.checked, requirement, few, end, names)
    return replace(report, misses={name: miss for name, miss in found.items() if miss})


def _late(
    spec: Spec,
    report: Report,
    name: str,
    sources: frozenset[str] | None,
    read: Callable[[frozenset[str] | None], Sequence[Sample]],
    end: int,
) -> Mapping[int, int]:
    """What came after its deadline, of the first failures of a requirement."""
    from rvmon.explain.late import awaited, late_arrivals
    from rvmon.explain.states import values_read
    from rvmon.verdict.verdict import Verdict

    requirement = spec.requirements[name]
    missed = {}
    for attempt in islice(report.of(name, Verdict.FAIL), MOST_LATE):
        formula = awaited(requirement, attempt)
        if formula is not None:
            missed[attempt.number] = attempt, formula
    if not missed:
        return {}
    samples = read(values_read(spec.checked, requirement, [one for _, one in missed.values()]))
    attempts = [attempt for attempt, _ in missed.values()]
    return late_arrivals(spec.checked, requirement, attempts, samples, end, sources)


def _changes(spec: Spec, trace: str, names: frozenset[str], end: int) -> Sequence[Sample] | None:
    """The samples at which one of these names changes; `None` if the file is not plain."""
    from rvmon.readers.block_readers import reader_of
    from rvmon.readers.changes import changes

    schema = spec.schema
    reader = reader_of(trace, schema, Counter())
    if reader is None or spec.checked.max_delay is not None:
        return None
    try:
        blocks = reader(trace, schema, frozenset((*schema.signals, *schema.events)))
        return changes(blocks, names, schema.events.keys(), end)
    except NotPlainError:
        return None


def _goals(
    spec: Spec,
    trace: str,
    end: int,
    names: frozenset[str] | None,
    samples: Callable[[], Sequence[Sample]],
) -> Mapping[str, Verdict]:
    from rvmon.monitor.batch_file import evaluate_file
    from rvmon.monitor.compiled import compile_spec
    from rvmon.monitor.goals import goal_verdicts, goals_as_requirements

    goals = Spec(goals_as_requirements(spec.checked))
    report = None
    if spec.checked.max_delay is None:
        report = evaluate_file(
            compile_spec(goals.checked),
            spec.schema,
            trace,
            only=None,
            engine="auto",
            until=end,
            cut=True,
            ignored=Counter(),
        )
    if report is None:
        monitor = goals.monitor(sources=names)
        for sample in samples():
            monitor.step_ns(sample.t, sample.values)
        report = monitor.finish_ns(end)
    return goal_verdicts(report)
