"""`rvmon run`: evaluate recordings against a specification."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli import evaluation
from rvmon.cli.options import ids_of, refuse_over
from rvmon.cli.output import rendered, say_json, warn
from rvmon.cli.reading import noticing_changes, reading_words, refuse_empty, unpacked
from rvmon.cli.run_output import write_files, write_results
from rvmon.errors import RvmonError
from rvmon.execute import finished_shards
from rvmon.files import refuse_no_file
from rvmon.recordings.places import JOINT, files_of, found_recordings, name_of
from rvmon.session import Spec
from rvmon.trace.time import format_stamped
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.known_failures import NONE_KNOWN, KnownFailures, read_known
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from rvmon.reproducer import Case


def run_run(arguments: argparse.Namespace) -> int:
    """Evaluate recordings, print and write the results, and return the exit code."""
    given = arguments.spec
    with unpacked(arguments) as case:
        if case is not None:
            if arguments.traces or arguments.evidence:
                fix = "name no other, and leave out --evidence"
                raise RvmonError(f"{given} contains its recording: {fix}")
            arguments.traces = [case.recording]
        return _run(arguments, case, given)


def _run(arguments: argparse.Namespace, case: Case | None, given: str) -> int:
    known_as = None if case is None else name_of(case.spec)
    spec, options = evaluation.spec_and_options(arguments, known_as)
    _show_warnings(spec)
    refuse_empty(spec)
    traces = list(found_recordings(arguments.traces))
    if arguments.join:  # a folder is named by itself, not by all the files in it
        given = arguments.traces
        traces = [JOINT.join(given if len(given) > 1 else [*given, ""])]
    if arguments.shard is not None:
        traces = _share(arguments, traces)
    _refuse_places(arguments, traces, spec)
    before = None
    if arguments.evidence is not None:
        from rvmon.cli.evidence import read_inputs, write_run

        before = read_inputs(arguments, traces)
    must_trigger = ids_of(arguments.require_triggered or None, spec)
    known = NONE_KNOWN
    if arguments.known is not None:
        known = KnownFailures(read_known(arguments.known, spec.requirements))
    with noticing_changes(traces):
        judged = _judged(arguments, traces, spec, options, case)
        _show(arguments, spec, judged)
        reports = [result.report for result in judged if result.report is not None]
        _show_known(known, reports)
        write_files(arguments, spec, judged, known, given if case else "")
    if before is not None:
        write_run(arguments, spec, judged, before)
    if case is not None:
        evaluation.compare_expected(judged[0], case)
    if len(reports) < len(judged):
        return 2
    failed = any(_failed(report, known, strict=arguments.strict) for report in reports)
    failed |= any(result.missing for result in judged)
    if arguments.require_triggered is not None:
        silent = _never_triggered(reports, must_trigger)
        for name in silent:
            warn(f"{name} was triggered in no recording")
        failed |= bool(silent)
    return int(failed)


def _judged(
    arguments: argparse.Namespace,
    traces: Sequence[str],
    spec: Spec,
    options: evaluation.Options,
    case: Case | None,
) -> list[evaluation.Judged]:
    """Judge the recordings, except those that an interrupted run has judged, and write `--out`."""
    judge = partial(
        evaluation.judge_all,
        jobs=arguments.dask or arguments.jobs,
        writes_json=arguments.format == "json",
    )
    shards = _shards(arguments)
    kept = None
    if arguments.out is None or (len(traces) == 1 and not (arguments.shard or shards)):
        recordings = list(judge(spec, traces, options))  # no journal: nothing to resume
        if case is not None:
            recordings = [evaluation.as_known(judged, case) for judged in recordings]
    else:
        from rvmon.cli.resume import unfinished

        reading = reading_words(arguments)
        if arguments.binding is not None:
            reading.append(Path(arguments.binding).read_text("utf-8"))
        kept = unfinished(
            arguments.out,
            traces,
            spec,
            options,
            reading=reading,
            resume=arguments.resume,
            shards=shards,
        )
        left = [trace for trace in traces if trace not in kept.known]
        if kept.known:
            warn(f"{len(traces) - len(left)} of {len(traces)} recordings were evaluated before")
        recordings = list(kept.judged(traces, judge(spec, left, options)))
    if arguments.out is not None:
        write_results(arguments.out, spec, recordings)
    if arguments.shard is not None:
        warn(f"{arguments.out}: --resume instead of --shard joins the shards in this folder")
    elif kept is not None:
        kept.remove()
    return recordings


def _share(arguments: argparse.Namespace, traces: Sequence[str]) -> list[str]:
    """The recordings of this shard; `--out` is changed to the file of the shard."""
    if arguments.out is None:
        raise RvmonError("--shard writes next to the file of all verdicts: name that with --out")
    if arguments.evidence is not None:
        raise RvmonError("--evidence covers all recordings: give it to the command with --resume")
    arguments.out = str(arguments.shard.name(Path(arguments.out)))
    share: list[str] = arguments.shard.of(traces)
    if not share:
        raise RvmonError(f"shard {arguments.shard}: there are {len(traces)} recordings: use fewer")
    return share


def _shards(arguments: argparse.Namespace) -> list[Path]:
    """The journals of the shards to join; none unless `--resume` is given without `--shard`."""
    if not arguments.resume or arguments.shard is not None:
        return []
    from rvmon.cli.resume import path_of

    return [path_of(str(part)) for part in finished_shards(Path(arguments.out))]


def _refuse_places(arguments: argparse.Namespace, traces: Sequence[str], spec: Spec) -> None:
    """Refuse, before anything is judged, outputs that cannot be written."""
    for file in (arguments.junit, arguments.evidence):
        if file:
            refuse_no_file(file)
    if arguments.resume and arguments.out is None:
        raise RvmonError("--resume continues a run that writes to a file: name the file with --out")
    if arguments.out is not None:
        from rvmon.verdicts.table_file import refuse_format

        refuse_format(arguments.out)
        refuse_no_file(arguments.out)
    names = ("out", "junit", "coverage", "mcap", "evidence")
    files = [getattr(arguments, name) for name in names]
    if arguments.mcap is not None:
        from rvmon.report.verdicts_mcap import layout_path, refuse_mcap

        refuse_mcap(arguments.mcap)
        refuse_no_file(arguments.mcap)
        if len(traces) > 1:
            raise RvmonError(f"--mcap shows one recording, and there are {len(traces)}")
        files.append(layout_path(arguments.mcap))
    read = [arguments.spec, arguments.binding, arguments.known]
    refuse_over(files, [*read, *chain.from_iterable(map(files_of, traces))])
    if arguments.coverage is not None:
        from rvmon.coverage.database import Database

        # Opened now, so that a file that cannot be written is refused before the work.
        Database.open(arguments.coverage).close()
    if arguments.report and Path(arguments.report).is_file():
        raise RvmonError(f"cannot write to {arguments.report}: it is a file: name a folder")
    if arguments.report and not spec.requirements:
        name = spec.checked.name
        raise RvmonError(f"a page shows requirements, and {name} has none: add one")


def _show_warnings(spec: Spec) -> None:
    if spec.warnings:
        warn(rendered(spec.warnings))
    checked = spec.checked
    alone = [f"`{name}`" for name in checked.properties
             if name not in spec.requirements and name not in checked.covers]  # fmt: skip
    if alone:
        by = "a requirement with `monitor as written` or `monitor as cover` is"
        warn(f"properties are not evaluated on runs: {', '.join(alone)}; {by}")


def _show(arguments: argparse.Namespace, spec: Spec, judged: Sequence[evaluation.Judged]) -> None:
    for result in judged:
        if result.error:
            warn(f"error: {result.error}")
            for line in _before_lines(result.before):
                warn(f"  decided before that: {line}")
        if result.missing:
            names = ", ".join(f"`{name}`" for name in result.missing)
            message = f"{result.trace} has no column for {names}"
            warn(f"warning: {message}: requirements that read them are inconclusive")
    if arguments.format == "json":
        _show_doubts(judged)
        texts = [_json(result, spec) for result in judged]
        say_json(texts[0] if len(texts) == 1 else f"[{','.join(texts)}]")
        return
    from rvmon.report.run_text import print_reports

    reports = [result.report for result in judged if result.report is not None]
    broken = len(judged) - len(reports)
    print_reports(reports, spec.checked, counts_only=arguments.quiet, broken=broken)


def _show_known(known: KnownFailures, reports: Sequence[Report]) -> None:
    for report in reports:
        for name, why in known.expected(report).items():
            if report.verdicts[name] is Verdict.FAIL:
                warn(f"{name} in {report.trace} failed as known: {why}")
    for remark in known.remarks(reports):
        warn(f"warning: {remark}")


def _show_doubts(judged: Sequence[evaluation.Judged]) -> None:
    """Warn of doubtful input, as the text output does."""
    for result in judged:
        for health in () if result.report is None else result.report.health:
            if health.is_doubt:
                warn(f"warning: {result.trace}: `{health.name}`: {health.remark}")


def _json(judged: evaluation.Judged, spec: Spec) -> str:
    if judged.report is not None:
        return judged.text or judged.report.to_json(spec.requirements)
    from rvmon.verdicts.serialise import encode_broken

    return encode_broken(judged.trace, judged.error, judged.before)


def _before_lines(attempts: Sequence[Attempt]) -> Iterator[str]:
    """The attempts decided before a recording broke off, a line per requirement."""
    by_requirement: dict[str, list[Attempt]] = {}
    for attempt in attempts:
        by_requirement.setdefault(attempt.requirement, []).append(attempt)
    for name, decided in by_requirement.items():
        counts = Counter(attempt.verdict.value for attempt in decided)
        line = f"{name}  {', '.join(f'{count} {letter}' for letter, count in counts.items())}"
        failed = next((attempt for attempt in decided if attempt.verdict is Verdict.FAIL), None)
        if failed is not None and failed.decided is not None:
            line += (
                f"; attempt {failed.number} failed at "
                f"{format_stamped(failed.decided, failed.origin)}: "
                f"{failed.reason}"
            )
        yield line


def _failed(report: Report, known: KnownFailures, *, strict: bool) -> bool:
    open_ones = {Verdict.NOT_TRIGGERED, Verdict.INCONCLUSIVE} if strict else set()
    is_open = not open_ones.isdisjoint(report.verdicts.values())
    return bool(report.illegal or known.failures(report)) or is_open


def _never_triggered(reports: Sequence[Report], ids: tuple[str, ...] | None) -> list[str]:
    seen: dict[str, set[str]] = {}
    for report in reports:
        for name, verdict in report.verdicts.items():
            seen.setdefault(name, set()).add(verdict)
    return [name for name in ids or seen if seen.get(name, set()) <= {"NT"}]
