"""The evidence of recordings: all that verdicts depend on, kept (`rvmon run --evidence`)."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from rvmon.cli.judging import Judged
from rvmon.cli.run_output import rows_of
from rvmon.errors import RvmonError, TraceError
from rvmon.evidence import (
    COVERAGE,
    About,
    Judging,
    coverage_json,
    own_program,
    package_versions,
    sha256_of,
    texts_of,
    write_evidence,
)
from rvmon.recordings.found import files_of
from rvmon.recordings.messages.forms import form_of_folder
from rvmon.session import Spec
from rvmon.texts import shown_path
from rvmon.verdicts.rows import VerdictRow


def is_recording(path: str) -> bool:
    """Whether there is a file, a folder that is a recording, or several: else it has no hash."""
    try:
        return all(Path(one).is_file() or form_of_folder(one) for one in files_of(path))
    except (OSError, ValueError, TraceError):
        return False


def begun(
    arguments: argparse.Namespace, traces: Sequence[str]
) -> tuple[dict[str, bytes], list[str], dict[str, str]]:
    """The inputs on which verdicts depend, before anything is judged, and after.

    Returns:
        What `texts_of` returns, and the SHA-256 of the recordings by path.

    Raises:
        RvmonError: evidence cannot be kept of it.
    """
    found: dict[str, str] = {}
    for trace in traces:
        if not is_recording(trace) or shown_path(trace) in found:
            raise RvmonError(f"--evidence: {trace}: name files that are there, each once")
        found[shown_path(trace)] = sha256_of(*map(Path, files_of(trace)))
    return *texts_of({"": arguments.spec}, arguments.binding), found


def write_run(
    arguments: argparse.Namespace,
    spec: Spec,
    judged: Sequence[Judged],
    before: tuple[dict[str, bytes], list[str], dict[str, str]],
) -> None:
    """Write the evidence of recordings.

    Args:
        arguments: of `rvmon run`.
        spec: the specification that judged.
        judged: the recordings.
        before: the result of `begun` before these were judged.

    Raises:
        RvmonError: it cannot be written, or what was judged has changed meanwhile.
    """
    if begun(arguments, list(before[2])) != before:
        raise RvmonError("--evidence: an input has changed meanwhile: run it again")
    entries, (main, *binding), recordings = before
    how = msgspec.convert(arguments, Judging, from_attributes=True)
    about = About(
        name=spec.checked.name,
        packages=package_versions(),
        programs={"rvmon": own_program()},
        specs={"": main},
        recordings=recordings,
        judging=msgspec.structs.replace(how, binding=binding[0] if binding else None),
    )
    if arguments.coverage is not None:
        covered = (spec.coverage_model.model, [result.hits for result in judged])
        entries = {**entries, COVERAGE: coverage_json({"": covered})}
    write_evidence(arguments.evidence, about, entries, {"": spec}, rows_of_judged(judged))


def rows_of_judged(judged: Sequence[Judged]) -> Iterator[VerdictRow]:
    """The verdicts, and what was hit of coverpoints and must not be."""
    yield from rows_of(judged)
    for result in judged:
        for hit in () if result.report is None else result.report.illegal:
            yield VerdictRow(result.trace, verdict="F", reason=str(hit))
