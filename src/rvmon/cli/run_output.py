"""The files that `rvmon run` writes."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.evaluation import Judged
from rvmon.cli.output import say, shown_while_reading
from rvmon.cli.reading import opened, reading_words
from rvmon.files import write_file
from rvmon.recordings.held_recording import HeldRecording
from rvmon.recordings.recording import can_be_read_again
from rvmon.recordings.source import Source
from rvmon.session import Spec
from rvmon.verdicts.serialise import VerdictRow, broken_rows

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch
    from rvmon.recordings.recording import FileRecording
    from rvmon.trace.sample import Sample
    from rvmon.verdicts.known_failures import KnownFailures


def write_results(path: str, spec: Spec, judged: Sequence[Judged]) -> None:
    """Write the verdicts as a table (`--out`)."""
    import rvmon
    from rvmon.verdicts import LAW
    from rvmon.verdicts.table_file import write_results as write

    about = {"spec": spec.checked.name, "law": str(LAW), "rvmon": rvmon.__version__}
    write(path, rows_of(judged), about)


def rows_of(judged: Iterable[Judged]) -> Iterator[VerdictRow]:
    """The verdicts on recordings as table rows."""
    for result in judged:
        if result.report is not None:
            yield from result.report.rows()
        else:
            yield from broken_rows(result.trace, result.error, result.before)


def write_files(
    arguments: argparse.Namespace,
    spec: Spec,
    judged: Sequence[Judged],
    known: KnownFailures,
    reproducer: str,
) -> None:
    """Write the files requested by `--coverage`, `--junit`, `--mcap` and `--report`.

    `reproducer` is the path of the reproducer that was judged; "" if there is none.
    """
    reports = [result.report for result in judged if result.report is not None]
    if arguments.coverage is not None:
        _record_coverage(Path(arguments.coverage), spec, judged, known)
    broken = [(result.trace, result.error) for result in judged if result.report is None]
    if arguments.junit:
        from rvmon.report.junit import junit_xml

        write_file(arguments.junit, junit_xml(reports, spec.checked, broken, known))

    def read(trace: str) -> Sequence[Sample]:
        # Standard input cannot be read again: its page shows the verdicts without the signals.
        place = arguments.traces[0] if reproducer else trace
        if not can_be_read_again(place):
            return []
        recording = opened(spec, place)
        return HeldRecording(
            _pieces(recording), recording.outages, lambda: _pieces(opened(spec, place))
        )

    if arguments.mcap:
        from rvmon.report.verdicts_mcap import write_verdicts

        for report in reports:
            end = report.end or 0
            samples = (sample for sample in read(report.trace) if sample.t <= end)
            write_verdicts(arguments.mcap, spec.checked, report, samples)
    if arguments.report:
        from rvmon.report.run_pages import write_run_pages

        def command(trace: str) -> str:
            if reproducer:
                return shlex.join(["rvmon", "run", reproducer])
            return shlex.join(["rvmon", "run", arguments.spec, trace, *reading_words(arguments)])

        folder = Path(arguments.report)
        written = write_run_pages(
            folder, spec.checked, reports, read, command, broken=broken, known=known
        )
        if written and arguments.format == "text":
            say(f"wrote {written[-1]}")


def _pieces(recording: FileRecording) -> Iterator[Batch | Sample]:
    return Source(recording, shown=partial(shown_while_reading, recording)).pieces()


def _record_coverage(
    path: Path, spec: Spec, judged: Sequence[Judged], known: KnownFailures
) -> None:
    from rvmon.coverage import TestRecord
    from rvmon.coverage.database import Database

    with Database.open(path) as database:
        database.declare(spec.coverage_model.model)
        for number, result in enumerate(judged):
            if result.report is not None:
                test = TestRecord(
                    result.trace,
                    campaign=spec.checked.name,
                    recording=result.trace,
                    verdicts=result.report.verdicts,
                    number=number,
                    seconds=result.seconds,
                    expected=known.expected(result.report),
                    origin=result.report.origin,
                )
                database.record(test, result.hits)
