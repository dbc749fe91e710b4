"""The journal of a run that was interrupted, so that the next goes on from there."""

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
    """The file that keeps verdicts until all recordings are judged, next to the output file."""
    return Path(f"{out}.unfinished")


class _Entry(msgspec.Struct, frozen=True):
    """One recording that was judged, with what distinguished its file from others."""

    trace: str
    stamp: tuple[int, int]
    report: str
    missing: tuple[str, ...]
    hits: dict[str, dict[str, Hit]]
    seconds: float


class Unfinished(journal.Journal, frozen=True):
    """A run that goes on."""

    # size and time of the files of recordings when the run began, by path
    stamps: dict[str, tuple[int, int] | None] = field(default_factory=dict)
    # the recordings that were judged before, by path
    known: dict[str, Judged] = field(default_factory=dict)

    def judged(self, traces: Sequence[str], fresh: Iterable[Judged]) -> Iterator[Judged]:
        """The recordings in their order, of which those that are fresh are kept."""
        new = iter(fresh)
        for trace in traces:
            one = self.known.get(trace)
            if one is None:
                one = next(new)
                self._add(trace, one)
            yield one

    def _add(self, trace: str, judged: Judged) -> None:
        """Write down what was judged, unless it is to be tried again."""
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
    """A run whose verdicts go to a file.

    To `resume` goes on from where an earlier run was ended, if there is one: what judges, how
    (`reading`: words of the command line, files), and by which program has to be the same, and so
    has each recording. Recordings of shards may be elsewhere.
    """
    path = path_of(out)
    # A checksum of all that verdicts depend on but the recordings; the binding's file may be
    # another one since.
    words = [*reading, pickle.dumps(spec.schema.binding).hex()]
    heading = journal.checksum(to_plain(spec.checked), words, asdict(options)).encode()
    stamps = {trace: _stamp(trace) for trace in traces}
    known: dict[str, Judged] = {}
    with writing(path):
        for shard in shards:
            known |= _judged_before(_entries(shard, heading), stamps, is_moved=True)
        entries = _entries(path, heading) if resume else []
        journal.begin(path, [heading, *map(msgspec.json.encode, entries)])
    return Unfinished(path, shards, stamps, known | _judged_before(entries, stamps))


def _entries(path: Path, heading: bytes) -> list[_Entry]:
    lines = journal.entries(path)
    if lines and lines[0] != heading:
        raise RvmonError(
            f"{path} was begun with another specification, other options or another rvmon: "
            "leave out --resume to start again"
        )
    try:
        return [msgspec.json.decode(entry, type=_Entry) for entry in (lines or [])[1:]]
    except msgspec.MsgspecError:
        raise RvmonError(f"{path} is no unfinished run: leave out --resume") from None


def _judged_before(
    entries: Iterable[_Entry],
    stamps: Mapping[str, tuple[int, int] | None],
    *,
    is_moved: bool = False,
) -> dict[str, Judged]:
    """The results of an earlier run, without recordings whose file has changed since.

    `is_moved`: the files may have been those of another machine: a copy has the size of what it is
    copied from, and a time of its own; it may be missing.
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
    """Size and time of the files of a recording; `None` if there are none."""
    try:
        files = list(os.scandir(trace)) if form_of_folder(trace) else [Path(trace)]
        statuses = [file.stat() for file in [*files, *map(Path, frame_databases(trace))]]
    except (OSError, ValueError):
        return None
    # A file may be given any time of change; that of its place on the disk is the system's.
    changed = max(max(one.st_mtime_ns, one.st_ctime_ns) for one in statuses)
    return sum(one.st_size for one in statuses), changed
