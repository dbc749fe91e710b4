"""`rvmon why`: explain one attempt of a recording."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from rvmon.analysis.subformulas import dissect, why_not_triggered
from rvmon.analysis.window_values import WindowValues, unit_of, windows_blamed
from rvmon.cli import reading
from rvmon.cli.options import constants_of
from rvmon.cli.output import busy, say_json, shown_while_reading
from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.language.print import format_window
from rvmon.monitor.missing_names import expect_names
from rvmon.recordings.batch import Batch
from rvmon.recordings.held_recording import MOST_HELD, HeldRecording, weight_of
from rvmon.recordings.places import name_of
from rvmon.recordings.source import Source, pieces_up_to
from rvmon.report.changes import Looks, RunChanges
from rvmon.report.printer import Printer
from rvmon.report.tracks import tracks_of
from rvmon.report.why_text import attempt_values, why_lines
from rvmon.report.wording import value_text
from rvmon.session import load
from rvmon.trace.sample import Sample, Trace
from rvmon.trace.time import TIME_LIMIT, ticks_of_seconds
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report


def run_why(arguments: argparse.Namespace) -> int:
    """Judge the recording, print the explanation of the attempt, and return the exit code."""
    with reading.unpacked(arguments) as case:
        if case is not None:
            if arguments.attempt is not None:
                raise RvmonError("a reproducer contains its recording: name only an attempt")
            arguments.attempt = arguments.trace or case.attempt
            arguments.trace = case.recording
        with reading.noticing_changes([arguments.trace]):
            return _explain(arguments, None if case is None else name_of(case.spec))


def _explain(arguments: argparse.Namespace, known_as: str | None) -> int:
    if arguments.trace == "-":
        raise RvmonError("error: standard input can be read once only: save the recording first")
    spec = reading.reading_spec(
        load(arguments.spec, name=known_as, const=constants_of(arguments.const)), arguments
    )
    name, exact = reading.named_attempt(arguments.attempt, spec)
    recording = reading.opened(spec, arguments.trace)
    allowed = reading.allowed_names(arguments.allow_missing)
    mapped = spec.schema.named
    expect_names(spec.checked, recording, mapped, only=[name], allowed=allowed)
    is_cut = arguments.until is not None
    until = recording.end if arguments.until is None else ticks_of_seconds(arguments.until)
    pieces: list[Batch | Sample] | None = []

    def kept(parts: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        nonlocal pieces
        weight = 0
        for piece in shown_while_reading(recording, iter(parts)):
            weight += weight_of(piece)
            if weight > MOST_HELD and recording.can_be_read_again:
                pieces = None
            if pieces is not None:
                pieces.append(piece)
            yield piece

    def read() -> Iterator[Batch | Sample]:
        if pieces is None:
            return Source(reading.opened(spec, arguments.trace), until, is_cut=is_cut).pieces()
        return pieces_up_to(pieces, TIME_LIMIT if until is None or not is_cut else until)

    report = spec.judge(Source(recording, until, is_cut=is_cut, shown=kept), only=[name])
    samples = HeldRecording(read(), recording.outages, read if pieces is None else None)
    if not report.attempts and report.end is not None:
        requirement = spec.requirements[name]
        miss = why_not_triggered(spec.checked, requirement, samples, report.end, recording.names)
        report = replace(report, misses={name: miss})
    attempt = reading.chosen_attempt(report, name, exact)
    assert report.end is not None, "a recording with an attempt has an end"
    requirement = spec.requirements[name]
    last = report.end if attempt.decided is None else attempt.decided
    changes = RunChanges(spec.checked, Looks([(attempt.triggered, last)]))
    passing = HeldRecording(changes.passing(samples), samples.outages, samples.pieces)
    with busy(f"taking {attempt.name} apart"):
        breakdown = dissect(spec.checked, passing, report.end, attempt, recording.names)
    tracks = tracks_of(spec.checked, requirement, changes.by_name, report.absent)
    values = attempt_values(tracks, attempt, last)
    values |= _window_values(spec.checked, attempt, samples, report, recording.names)
    if arguments.format == "json":
        import msgspec

        say_json(msgspec.json.encode({**msgspec.to_builtins(breakdown), "values": values}).decode())
        return 0

    printer = Printer()
    for line in why_lines(breakdown, requirement, values):
        printer.line(*line)
    return 0


def _window_values(
    checked: CheckedSpec,
    attempt: Attempt,
    samples: HeldRecording,
    report: Report,
    names: frozenset[str] | None,
) -> dict[str, Sequence[str]]:
    """The values of the blamed windows, at the trigger and at the decision."""
    if attempt.blame is None or attempt.decided is None:
        return {}
    windows = windows_blamed(checked, checked.requirements[attempt.requirement], attempt.blame)
    if not windows:
        return {}
    instants = sorted({attempt.triggered, attempt.decided})
    questions = [(t, window) for window in windows for t in instants]
    run = WindowValues(
        checked, questions, report.origin, Trace((), names, report.end, samples.outages)
    )
    for piece in samples.pieces():
        run.take(piece)
    values = run.values()
    return {
        format_window(window): [
            value_text(values.get((t, window)), unit_of(checked, window) or "") for t in instants
        ]
        for window in windows
    }
