"""The journal of `rvmon run`, from which `--resume` continues an interrupted run."""

from __future__ import annotations

import os
import pickle
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import msgspec
from msgspec import field
from msgspec.structs import asdict

from rvmon.cli.evaluation import Judged, Options
from rvmon.coverage import Hit
from rvmon.errors import RvmonError, writing
from rvmon.execute import journal
from rvmon.language.checked.serialise import to_plain
from rvmon.recordings import form_of_folder, frame_databases
from rvmon.session import Spec
from rvmon.verdicts.report import Report


def path_of(out: str) -> Path:
    """The journal of a run, next to its output file; it exists until all recordings are judged."""
    return Path(f"{out}.unfinished")


class _Entry(msgspec.Struct, frozen=True):
    """One judged recording, with the stamp of its file."""

    trace: str
    stamp: tuple[int, int]  # size and time, as from `_stamp`
    report: str
    missing: tuple[str, ...]
    hits: dict[str, dict[str, Hit]]
    seconds: float


class Unfinished(journal.Journal, frozen=True):
    """A run that is not finished, with its journal."""

    # size and time of each recording's files when the run started, by path
    stamps: dict[str, tuple[int, int] | None] = field(default_factory=dict)
    # the recordings judged by an earlier run, by path
    known: dict[str, Judged] = field(default_factory=dict)

    def judged(self, traces: Sequence[str], fresh: Iterable[Judged]) -> Iterator[Judged]:
        """All results in the order of `traces`; those from `fresh` are written to the journal."""
        new = iter(fresh)
        for trace in traces:
            one = self.known.get(trace)
            if one is None:
                one = next(new)
                self._add(trace, one)
            yield one

    def _add(self, trace: str, judged: Judged) -> None:
        """Append a result to the journal, unless it has an error and should be tried again."""
        stamp = self.stamps[trace]
        if judged.report is None or stamp is None:
            return
        hits = {group: dict(items) for group, items in judged.hits.items()}
        entry = _Entry(trace, stamp, judged.report.to_json(), judged.missing, hits, judged.seconds)
        with writing(self.path):
            self.keep(entry)


def unfinished(
    out: str,
    traces: Sequence[str],
    spec: Spec,
    options: Options,
    *,
    reading: Sequence[str],
    resume: bool,
    shards: Sequence[Path] = (),
) -> Unfinished:
    """Start the journal of a run that writes its verdicts to a file, or continue an earlier one.

    Results of an earlier run are used only if specification, options, `reading` and rvmon are the
    same, and the recording has not changed.

    Args:
        out: path of the output file.
        traces: paths of the recordings.
        spec: the specification.
        options: how to judge.
        reading: words of the command line, and texts of files, that affect how recordings are read.
        resume: whether to continue an interrupted run if there is one.
        shards: journals of shards to join; their recordings need not be on this machine.

    Raises:
        RvmonError: a journal belongs to another run, or a file cannot be read or written.
    """
    path = path_of(out)
    # A checksum of all that verdicts depend on, except the recordings. It includes the binding
    # itself, as its file may have changed.
    words = [*reading, pickle.dumps(spec.schema.binding).hex()]
    heading = journal.checksum(to_plain(spec.checked), words, asdict(options)).encode()
    stamps = {trace: _stamp(trace) for trace in traces}
    known: dict[str, Judged] = {}
    with writing(path):
        for shard in shards:
            known |= _judged_before(_entries(shard, heading), stamps, is_moved=True)
        entries = _entries(path, heading) if resume else []
        journal.create(path, [heading, *map(msgspec.json.encode, entries)])
    return Unfinished(path, shards, stamps, known | _judged_before(entries, stamps))


def _entries(path: Path, heading: bytes) -> list[_Entry]:
    lines = journal.entries(path)
    if lines and lines[0] != heading:
        raise RvmonError(
            f"{path} was started with another specification, other options or another rvmon: "
            "leave out --resume to start again"
        )
    try:
        return [msgspec.json.decode(entry, type=_Entry) for entry in (lines or [])[1:]]
    except msgspec.MsgspecError:
        raise RvmonError(f"{path} is not an unfinished run: leave out --resume") from None


def _judged_before(
    entries: Iterable[_Entry],
    stamps: Mapping[str, tuple[int, int] | None],
    *,
    is_moved: bool = False,
) -> dict[str, Judged]:
    """The results of an earlier run, without recordings whose file has changed since.

    `is_moved`: the recordings may have been on another machine. Then only the size has to agree, as
    a copy has another time, and the file may be missing here.
    """

    def is_same(entry: _Entry) -> bool:
        now = stamps[entry.trace]
        return now == entry.stamp or (is_moved and (now is None or now[0] == entry.stamp[0]))

    return {
        entry.trace: _judged(entry) for entry in entries if entry.trace in stamps and is_same(entry)
    }


def _judged(entry: _Entry) -> Judged:
    report = Report.from_json(entry.report)
    return Judged(
        report.trace, report, missing=entry.missing, hits=entry.hits, seconds=entry.seconds
    )


def _stamp(trace: str) -> tuple[int, int] | None:
    """Total size and latest time of a recording's files; `None` if they cannot be read."""
    try:
        files = list(os.scandir(trace)) if form_of_folder(trace) else [Path(trace)]
        statuses = [file.stat() for file in [*files, *map(Path, frame_databases(trace))]]
    except (OSError, ValueError):
        return None
    # A program can set the mtime to any value, but not the ctime.
    changed = max(max(one.st_mtime_ns, one.st_ctime_ns) for one in statuses)
    return sum(one.st_size for one in statuses), changed
