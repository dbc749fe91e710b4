"""Write and read the tests of a coverage database, with their hits."""

from __future__ import annotations

import hashlib
import sqlite3
import time
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from rvmon.coverage import UNKNOWN, Ending, Entry, Hits, Row, TestRecord
from rvmon.coverage.database_file import damaged
from rvmon.errors import CoverageError
from rvmon.verdicts import Verdict

_BYTES = 20  # bytes per item hit: four for its id, eight for the count, eight for the first instant

_TEXTS = ("campaign", "name", "strategy", "recording", "system", "error")
_COLUMNS = (
    "digest, campaign, name, strategy, recording, seed, system, verdicts, ending, error, "
    "number, seconds, recorded, expected, origin, hits"
)
_WRITE = (
    f"INSERT INTO tests ({_COLUMNS}) VALUES ({', '.join('?' * len(_COLUMNS.split(',')))}) "  # noqa: S608 - our words
    "ON CONFLICT (digest) DO UPDATE SET number = excluded.number, seconds = excluded.seconds, "
    "recorded = excluded.recorded, recording = excluded.recording "
    "WHERE (excluded.recorded, excluded.number, excluded.seconds, excluded.recording) "
    "< (recorded, number, seconds, recording)"
)
"""The earliest of several records of a test, which have equal digests, is kept."""

_READ = f"SELECT {_COLUMNS} FROM tests"  # noqa: S608 - our words


def entry_of(test: TestRecord, hits: Hits, places: Mapping[tuple[str, str], int]) -> Entry:
    """A test with its hits as an entry.

    Raises:
        CoverageError: the test hit an item that is not in the model, or a number is invalid.
    """
    flat = sorted(
        (group, item, hit.count, hit.first)
        for group, items in hits.items()
        for item, hit in items.items()
    )
    unknown = next(((group, item) for group, item, *_ in flat if (group, item) not in places), None)
    if unknown is not None:
        raise CoverageError(
            f"error: test `{test.name}` hit `{unknown[1]}` of `{unknown[0]}`, which no declared "
            "model has: declare its model first"
        )
    _refuse_nonsense(test, flat)
    clean = _storable(test)
    rows = sorted((places[group, item], count, first) for group, item, count, first in flat)
    row = Row(
        np.array([place for place, _, _ in rows], np.int32),
        np.array([count for _, count, _ in rows], np.int64),
        np.array([UNKNOWN if first is None else first for *_, first in rows], np.int64),
    )
    return Entry(_digest(clean, flat), clean, row)


def write_entries(
    database: sqlite3.Connection, entries: Iterable[Entry], ids: NDArray[np.int64]
) -> None:
    """Write tests; those already stored are not added again.

    `ids` are those of the items in the table, by index in the model.
    """
    database.executemany(_WRITE, (_stored(entry, ids) for entry in entries))


def _stored(entry: Entry, ids: NDArray[np.int64]) -> tuple[object, ...]:
    """A test in the order of the columns."""
    test = entry.record
    return (
        entry.digest, test.campaign, test.name, test.strategy, test.recording, _seed(test),
        test.system, _json(test.verdicts), test.ending, test.error, test.number,
        float(test.seconds), test.when, _json(test.expected), test.origin, _packed(entry.row, ids),
    )  # fmt: skip


def read_entries(
    database: sqlite3.Connection, path: str | Path | None, ids: NDArray[np.int64]
) -> list[Entry]:
    """The tests, in the order of their campaigns; `ids` are as for `write_entries`.

    Raises:
        CoverageError: the contents are damaged.
    """
    order = np.argsort(ids)
    entries = []
    for columns in database.execute(_READ):
        try:
            entries.append(_entry(columns, ids, order))
        except (ValueError, TypeError, zlib.error, msgspec.MsgspecError) as error:
            raise damaged(path, f"test `{columns[2]}`: {error}") from None
    starts: dict[str, int] = {}
    for entry in entries:
        campaign, when = entry.record.campaign, entry.record.when or 0
        starts[campaign] = min(when, starts.get(campaign, when))
    return sorted(
        entries,
        key=lambda entry: (
            starts[entry.record.campaign],
            entry.record.campaign,
            entry.record.number,
            entry.record.when or 0,
            entry.digest,
        ),
    )


def _digest(test: TestRecord, flat: list[tuple[str, str, int, int | None]]) -> str:
    """The identity of a test: everything but where and when it was recorded, and its duration."""
    content = (
        test.campaign, test.name, test.strategy, _seed(test), test.system, test.verdicts,
        test.ending, test.error, test.expected, flat,
    )  # fmt: skip
    return hashlib.sha256(msgspec.json.encode(content, order="deterministic")).hexdigest()


def _seed(test: TestRecord) -> str | None:
    """The seed as text, as it may be larger than the numbers of SQLite."""
    return None if test.seed is None else str(test.seed)


def _storable(test: TestRecord) -> TestRecord:
    """The record in a form that can be stored: with the current time by default, and valid text."""
    return replace(
        test,
        **{name: _text(getattr(test, name)) for name in _TEXTS},
        verdicts={name: Verdict(verdict) for name, verdict in test.verdicts.items()},
        ending=Ending(test.ending),
        when=time.time_ns() if test.when is None else test.when,
        expected={name: _text(reason) for name, reason in test.expected.items()},
    )


def _json(texts: Mapping[str, str]) -> str:
    return msgspec.json.encode(texts, order="deterministic").decode()


def _text(name: str) -> str:
    """A text in valid Unicode: names of files may have undecodable bytes (lone surrogates)."""
    return name if name.isascii() else name.encode("utf-8", "backslashreplace").decode()


def _refuse_nonsense(test: TestRecord, flat: list[tuple[str, str, int, int | None]]) -> None:
    if not 0 <= test.seconds < float("inf"):
        raise CoverageError(
            f"error: test `{test.name}` took {test.seconds} s: give seconds, at least 0"
        )
    for group, item, count, _ in flat:
        if count < 1:
            raise CoverageError(
                f"error: test `{test.name}` hit `{item}` of `{group}` {count} times: leave out "
                "what it did not hit"
            )


def _packed(row: Row, ids: NDArray[np.int64]) -> bytes:
    """The columns of a row, concatenated and compressed."""
    own = ids[row.items]
    order = np.argsort(own)
    columns = (own.astype("<i4"), row.counts.astype("<i8"), row.firsts.astype("<i8"))
    return zlib.compress(b"".join(column[order].tobytes() for column in columns), 1)


def _entry(columns: tuple[Any, ...], ids: NDArray[np.int64], order: NDArray[np.intp]) -> Entry:
    digest, campaign, name, strategy, recording, seed, system, verdicts, *rest = columns
    ending, error, number, seconds, recorded, expected, origin, hits = rest
    record = TestRecord(
        str(name), str(campaign), str(strategy), str(recording),
        None if seed is None else int(seed), str(system),
        msgspec.json.decode(verdicts, type=dict[str, Verdict]), Ending(ending), str(error),
        int(number), float(seconds), int(recorded),
        msgspec.json.decode(expected, type=dict[str, str]), int(origin),
    )  # fmt: skip
    return Entry(str(digest), record, _unpacked(hits, ids, order))


def _unpacked(hits: bytes, ids: NDArray[np.int64], order: NDArray[np.intp]) -> Row:
    """Undo `_packed`; decompression is bounded by the number of items.

    Raises:
        ValueError: the data are damaged.
    """
    unpacking = zlib.decompressobj()
    body = unpacking.decompress(hits, _BYTES * len(ids) + 1)
    count, rest = divmod(len(body), _BYTES)
    if rest or not unpacking.eof:
        raise ValueError("its hits are cut off, or too many")
    own = np.frombuffer(body, "<i4", count)
    counts = np.frombuffer(body, "<i8", count, 4 * count)
    firsts = np.frombuffer(body, "<i8", count, 12 * count)
    if count and (own[-1] > ids[order[-1]] or np.any(np.diff(own) <= 0) or np.any(counts < 1)):
        raise ValueError("its hits make no sense")
    places = order[np.searchsorted(ids, own, sorter=order)]
    if np.any(ids[places] != own):
        raise ValueError("it hit an item that does not exist")
    sort = np.argsort(places)
    return Row(places[sort].astype(np.int32), counts[sort], firsts[sort])
