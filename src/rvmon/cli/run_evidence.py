"""Evidence of recordings: what was judged, by what, with which verdicts."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

import msgspec

from rvmon.cli.beside import spec_and_options
from rvmon.cli.judging import Judged, judge_all
from rvmon.cli.run_files import rows_of
from rvmon.diagnostics.shown import shown_path
from rvmon.errors import RvmonError
from rvmon.evidence.about import (
    About,
    Judging,
    Stamp,
    own_program,
    package_versions,
    stamp_of,
)
from rvmon.evidence.keep import COVERAGE, Kept, Texts, coverage_json, texts_of, write_evidence
from rvmon.session import Spec
from rvmon.verdict.rows import VerdictRow

Begun = tuple[Texts, dict[str, Stamp]]
"""What verdicts depend on: requirements, and recordings by path."""


def begun(arguments: argparse.Namespace, traces: Sequence[str]) -> Begun:
    """What verdicts depend on, before anything is judged, and after.

    Args:
        arguments: of `rvmon run`.
        traces: paths of the recordings.

    Raises:
        RvmonError: evidence cannot be kept of it.
    """
    found: dict[str, Stamp] = {}
    for trace in traces:
        try:
            stamp = stamp_of(trace)
        except (OSError, ValueError):
            stamp = None
        if stamp is None or shown_path(trace) in found:
            why = "it is named twice" if stamp is not None else "it is no file that can be read"
            raise RvmonError(f"--evidence: {trace}: {why}: name files, each once")
        found[shown_path(trace)] = stamp
    return texts_of({"": arguments.spec}, arguments.binding), found


def write_run(
    arguments: argparse.Namespace,
    spec: Spec,
    judged: Sequence[Judged],
    before: Begun,
) -> None:
    """Write the evidence of recordings.

    Args:
        arguments: of `rvmon run`.
        spec: that judged.
        judged: the recordings.
        before: what `begun` gave before these were judged.

    Raises:
        RvmonError: it cannot be written, or what was judged has changed meanwhile.
    """
    if begun(arguments, list(before[1])) != before:
        raise RvmonError("--evidence: what was judged has changed meanwhile: run it again")
    texts, recordings = before
    how = msgspec.convert(arguments, Judging, from_attributes=True)
    about = About(
        name=spec.checked.name,
        packages=dict(package_versions()),
        programs={"rvmon": own_program()},
        specs=texts.specs,
        recordings=recordings,
        judging=msgspec.structs.replace(how, binding=texts.binding),
    )
    entries = dict(texts.entries)
    if arguments.coverage is not None:
        covered = (spec.coverage_model.model, [one.hits for one in judged])
        entries[COVERAGE] = coverage_json({"": covered})
    write_evidence(arguments.evidence, about, entries, {"": spec}, _rows(judged))


def _rows(judged: Sequence[Judged]) -> Iterator[VerdictRow]:
    """The verdicts, and what was hit and must not be."""
    yield from rows_of(judged)
    for one in judged:
        for hit in () if one.report is None else one.report.illegal:
            yield VerdictRow(one.trace, verdict="F", reason=str(hit))


def judged_again(kept: Kept, chosen: Sequence[str], jobs: int) -> Iterator[VerdictRow]:
    """Judge recordings of evidence again, as they were judged.

    Args:
        kept: the evidence.
        chosen: paths.
        jobs: processes.
    """
    told = {} if kept.about.judging is None else msgspec.structs.asdict(kept.about.judging)
    told |= {"spec": str(kept.specs[""]), "binding": kept.binding, "coverage": None}
    spec, options = spec_and_options(argparse.Namespace(**told))
    yield from _rows(list(judge_all(spec, chosen, options, jobs)))
