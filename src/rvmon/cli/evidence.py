"""`rvmon evidence`: check an archive written by `rvmon run --evidence` or by a campaign."""

from __future__ import annotations

import argparse
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import msgspec

from rvmon import evidence
from rvmon.cli.evaluation import Judged, judge_all, spec_and_options
from rvmon.cli.options import constants_of
from rvmon.cli.output import bar, say
from rvmon.cli.run_output import rows_of
from rvmon.errors import RvmonError, TraceError
from rvmon.recordings import form_of_folder
from rvmon.recordings.places import files_of
from rvmon.report.trace_matrix import Row, rows_by_item
from rvmon.session import Spec, load
from rvmon.texts import shown_path
from rvmon.verdicts import LAW
from rvmon.verdicts.serialise import VerdictRow
from rvmon.verdicts.table_file import csv_bytes

Again = Callable[[evidence.Kept, Sequence[str], int], Iterable[VerdictRow]]
"""Evaluates the named recordings or tests of evidence again, with this number of processes."""


def run_evidence(arguments: argparse.Namespace) -> int:
    """Check an archive, print the differences, and return the exit code."""
    differ: list[str] = []
    unchecked: list[str] = []
    try:
        with evidence.opened_evidence(arguments.file) as kept:
            _verify(kept, arguments, differ, unchecked)
    except evidence.TamperedError as error:
        differ.append(str(error))
    for heading, facts in (("differs", differ), ("not checked", unchecked)):
        for one in facts:
            say(f"{heading}: {one}")
    if differ:
        say("It does not hold.")
        return 1
    say("All that could be checked holds." if unchecked else "It holds.")
    return 2 if unchecked else 0


def _verify(
    kept: evidence.Kept, arguments: argparse.Namespace, differ: list[str], unchecked: list[str]
) -> None:
    about = kept.about
    say(f"{arguments.file}: {about.name}, evaluated by rvmon {about.rvmon}, law {about.law}")
    intact = set(kept.items)
    for name, sha256 in _shown(about.recordings):
        if not is_recording(name):
            unchecked.append(f"{name} is missing")
        elif evidence.sha256_of(*map(Path, files_of(name))) != sha256:
            differ.append(f"{name} is not the recording that was evaluated")
        else:
            continue
        intact.discard(name)
    if about.law != LAW:
        unchecked.append(f"verdicts, which are of law {about.law}: this rvmon has law {LAW}")
        return
    is_same = about.programs.get("rvmon") == evidence.own_program()
    if is_same:
        _expect_derived(kept)
    else:
        unchecked.append("the matrix and the wording of reasons: another rvmon wrote them")
    again: Again = _judged_again
    if about.judging is None:
        if arguments.campaign is None:
            program = f"{' '.join(about.command[:1])} evidence {arguments.file}"
            unchecked.append(f"tests: the program that played them checks them: `{program}`")
            return
        from rvmon.cli.campaign_evidence import as_kept, played_again, programs_of

        campaign = as_kept(arguments.campaign(arguments), kept)
        again = partial(played_again, campaign)
        if not programs_of(campaign).items() <= about.programs.items():
            say(f"{campaign.name} has changed since: its tests are played as it is now")
    size = len(intact) if arguments.sample is None else min(arguments.sample, len(intact))
    chosen = random.Random(arguments.seed).sample(sorted(intact), size)  # noqa: S311 - no secret
    # Converted to CSV and back, as the stored rows were, so that both lose the same digits.
    now = rows_by_item(csv_bytes(again(kept, chosen, arguments.jobs)))
    columns = [field for field in VerdictRow._fields if is_same or field not in ("reason", "error")]
    for item in chosen:
        differ += _differences(item, kept.items[item], now.get(item, ()), columns)
    say(f"evaluated again: {size:,} of {len(kept.items):,}")


def _shown(recordings: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The recordings with their hashes, with a progress bar."""
    with bar("recordings", len(recordings)) as show:
        for count, item in enumerate(recordings.items(), start=1):
            yield item
            show(count)


def _expect_derived(kept: evidence.Kept) -> None:
    """Check that the trace matrix follows from requirements and verdicts.

    Raises:
        TamperedError: it does not.
    """
    const = constants_of(kept.about.judging.const if kept.about.judging else ())
    specs = {robot: load(path, const=const) for robot, path in kept.specs.items()}
    try:
        derived = evidence.derived_entries(kept.about, specs, kept.items)
    except ValueError as error:
        raise evidence.TamperedError(f"an unknown verdict: {error}") from None
    if not derived.items() <= kept.entries.items():
        raise evidence.TamperedError("the matrix does not follow from requirements and verdicts")


def _judged_again(kept: evidence.Kept, chosen: Sequence[str], jobs: int) -> Iterator[VerdictRow]:
    options_kept = msgspec.structs.asdict(kept.about.judging) if kept.about.judging else {}
    options_kept |= {"spec": kept.specs[""], "binding": kept.binding, "coverage": None}
    spec, options = spec_and_options(argparse.Namespace(**options_kept))
    return rows_of_judged(list(judge_all(spec, chosen, options, jobs)))


def _differences(
    item: str, before: Sequence[Row], now: Sequence[Row], columns: Sequence[str]
) -> Iterator[str]:
    """The changes of a recording or test, one sentence per attempt."""
    was, current = _by_attempt(before), _by_attempt(now)
    for name in {**was, **current}:
        old, new = was.get(name), current.get(name)
        if old is None or new is None:
            yield f"{name} in {item} {'was not there before' if old is None else 'is gone'}"
            continue
        other = [column for column in columns if old[column] != new[column]]
        if other:
            column = "verdict" if "verdict" in other else other[0]
            yield f"{name} in {item}: {column} was {old[column]}, is {new[column]}"


def _by_attempt(rows: Sequence[Row]) -> dict[str, Row]:
    return {
        row["attempt"] or row["requirement"] or row["reason"] or row["error"]: row for row in rows
    }


def is_recording(path: str) -> bool:
    """Whether the path names existing recordings on this machine, which can be hashed."""
    try:
        return all(Path(one).is_file() or form_of_folder(one) for one in files_of(path))
    except (OSError, ValueError, TraceError):
        return False


def read_inputs(
    arguments: argparse.Namespace, traces: Sequence[str]
) -> tuple[dict[str, bytes], list[str], dict[str, str]]:
    """The result of `texts_of`, and the SHA-256 of the recordings by path.

    It is computed before and after judging, to detect changes.

    Raises:
        RvmonError: a recording does not exist or is named twice, or a file cannot be read.
    """
    hashes: dict[str, str] = {}
    for trace in traces:
        if not is_recording(trace) or shown_path(trace) in hashes:
            raise RvmonError(f"--evidence: {trace}: name existing files, each once")
        hashes[shown_path(trace)] = evidence.sha256_of(*map(Path, files_of(trace)))
    return *evidence.texts_of({"": arguments.spec}, arguments.binding), hashes


def write_run(
    arguments: argparse.Namespace,
    spec: Spec,
    judged: Sequence[Judged],
    before: tuple[dict[str, bytes], list[str], dict[str, str]],
) -> None:
    """Write the evidence of recordings.

    Raises:
        RvmonError: an input has changed since `read_inputs`, or the file cannot be written.
    """
    if read_inputs(arguments, list(before[2])) != before:
        raise RvmonError("--evidence: an input has changed meanwhile: run the command again")
    entries, (main, *binding), recordings = before
    how = msgspec.convert(arguments, evidence.Judging, from_attributes=True)
    about = evidence.About(
        name=spec.checked.name,
        packages=evidence.package_versions(),
        programs={"rvmon": evidence.own_program()},
        specs={"": main},
        recordings=recordings,
        judging=msgspec.structs.replace(how, binding=binding[0] if binding else None),
    )
    if arguments.coverage is not None:
        covered = (spec.coverage_model.model, [result.hits for result in judged])
        entries = {**entries, evidence.COVERAGE: evidence.coverage_json({"": covered})}
    evidence.write_evidence(arguments.evidence, about, entries, {"": spec}, rows_of_judged(judged))


def rows_of_judged(judged: Sequence[Judged]) -> Iterator[VerdictRow]:
    """The verdicts as rows, and a row for each illegal hit."""
    yield from rows_of(judged)
    for result in judged:
        for hit in () if result.report is None else result.report.illegal:
            yield VerdictRow(result.trace, verdict="F", reason=str(hit))
