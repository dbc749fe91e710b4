"""Recordings that are damaged, cut, out of order or lack a column."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

from benchmarks.lossy.live import damaged, one_by_one
from benchmarks.lossy.trial import Door, Trial, Verdicts
from tests.tools.doors import Content, arrow_of, content_of, written_csv, written_json

from rvmon.errors import TraceError
from rvmon.session import Spec
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.trace import TraceProfile
from rvmon.trace.schema import Kind

_TRACES = TraceProfile(advances=False, unknowns=False)


def _judged(trial: Trial, path: Path, spec: Spec | None = None, **options: Any) -> Verdicts | None:
    try:
        return (spec or trial.spec).evaluate(path, **options).verdicts
    except TraceError:
        return None


def _content(trial: Trial) -> Content:
    return content_of(Random(trial.name), trial.case)


def _without_a_column(trial: Trial, content: Content) -> Content:
    """A recording that lacks what the lost samples spoke of."""
    gone = trial.rng.choice(trial.names)
    trial.names = [gone]
    return Content(
        {n: kind for n, kind in content.columns.items() if n.partition(".")[0] != gone},
        content.events - {gone},
        tuple(
            (t, {n: cell for n, cell in cells.items() if n.partition(".")[0] != gone})
            for t, cells in content.rows
        ),
    )


def _delayed(trial: Trial) -> Spec:
    """The specification, with a `max delay`: rows need no order then."""
    return Spec(replace(trial.case.spec, max_delay=1))


def _text(
    write: Callable[[Content, Path], Path],
    damage: Callable[[Random, bytes], bytes],
    head: int,
) -> Callable[[Iterator[Trial]], Iterator[Verdicts | None]]:
    """Rows of text of which some are unreadable, torn, in another order, or lack a column.

    Args:
        write: makes the file.
        damage: makes a row unreadable.
        head: so many lines are no rows.
    """

    @one_by_one
    def through(trial: Trial) -> Verdicts | None:
        rng, content = trial.rng, _content(trial)
        how = rng.choice(("damaged", "cut", "swapped", "in order", "lacking"))
        if how == "lacking":
            content = _without_a_column(trial, content)
            path = write(content, trial.folder)
            return _judged(trial, path, sources=content.sources, allow_missing=True)
        trial.is_whole = True
        path = write(content, trial.folder)
        lines = path.read_bytes().splitlines()
        first = next(n for n, (t, _) in enumerate(content.rows) if t == _lost_at(trial)) + head
        options = {"sources": content.sources}
        spec = trial.spec
        if how == "damaged":
            lines[first] = damage(rng, lines[first])
        elif how == "cut":
            lines[first:] = [damage(rng, lines[first])]
        else:
            rest = lines[head:]
            rng.shuffle(rest)
            if how == "swapped":
                rest = [line for line in lines[head:] if line != lines[first]] + [lines[first]]
            else:
                spec = _delayed(trial)
            lines[head:] = rest
        path.write_bytes(b"\n".join(lines) + b"\n")
        return _judged(trial, path, spec, **options)

    return through


def _lost_at(trial: Trial) -> int:
    return trial.case.samples[trial.lost.start].t


def _damaged_row(rng: Random, line: bytes) -> bytes:
    """A row of a table of which cells are missing, or hold what is none."""
    cells = line.split(b",")
    return rng.choice(
        [
            b",".join(cells[: rng.randrange(1, len(cells))]),
            line + b",1",
            b'"' + line,
            b"\xff" + line,
            b"x" + line,
        ]
    )


def _bits(rng: Random, path: Path, first: int, last: int) -> None:
    """Some bytes in a row are others, or the file ends there."""
    body = bytearray(path.read_bytes())
    place = rng.randrange(first, last)
    if rng.random() < 0.2:
        del body[place:]
    else:
        for at in range(place, min(last, place + rng.choice((1, 1, 2, 8)))):
            body[at] ^= rng.randrange(1, 256)
    path.write_bytes(body)


@one_by_one
def parquet(trial: Trial) -> Verdicts | None:
    """A file whose pages are damaged, that is cut, has rows in another order, or lacks a column."""
    from pyarrow import parquet as written

    rng, content = trial.rng, _content(trial)
    how = rng.choice(("bits", "bits", "swapped", "in order", "lacking"))
    trial.is_whole = how != "lacking"
    if how == "lacking":
        content = _without_a_column(trial, content)
    table = arrow_of(content)
    if how in ("swapped", "in order"):
        order = [*range(len(content.rows))]
        if how == "swapped":
            order.append(order.pop(rng.randrange(len(order) - 1)))
            trial.is_late = True  # rows of one stamp may well be swapped
        else:
            rng.shuffle(order)
        table = table.take(order)
    path = trial.folder / "a.parquet"
    written.write_table(table, path, row_group_size=rng.randint(1, 9), write_page_checksum=True)
    if how == "bits":
        body = path.read_bytes()
        footer = int.from_bytes(body[-8:-4], "little")
        _bits(rng, path, 4, len(body) - 8 - footer)
    spec = _delayed(trial) if how == "in order" else trial.spec
    return _judged(trial, path, spec, allow_missing=how == "lacking")


_TYPES = {Kind.BOOL: "boolean", Kind.INT: "integer", Kind.REAL: "number", Kind.LABEL: "string"}


@one_by_one
def mcap(trial: Trial) -> Verdicts | None:
    """A file of which bytes are others, that is cut, or lacks a topic."""
    rng = trial.rng
    # In sampled time messages of a topic that is not there are no positions either.
    lacking = trial.case.spec.time is not TimeModel.SAMPLED and rng.random() < 0.2
    trial.is_whole = not lacking
    gone = None
    if lacking:
        trial.names = [gone := rng.choice(trial.names)]
    path = trial.folder / "a.mcap"
    _write_mcap(trial, path, gone)
    if not lacking:
        _bits(rng, path, 0, path.stat().st_size)
    return _judged(trial, path, allow_missing=lacking)


def _write_mcap(trial: Trial, path: Path, gone: str | None) -> None:
    """Each name is a topic of JSON; chunks hold some messages each."""
    from mcap.writer import CompressionType, Writer

    spec, channels = trial.case.spec, {}
    packing = trial.rng.choice((CompressionType.NONE, CompressionType.ZSTD, CompressionType.LZ4))
    with path.open("wb") as file:
        writer: Any = Writer(
            file, chunk_size=trial.rng.choice((50, 200, 9_000)), compression=packing
        )
        writer.start()
        for name in (*spec.signals, *spec.events):
            if name == gone or (trial.case.names is not None and name not in trial.case.names):
                continue
            fields = {"data": spec.signals[name]} if name in spec.signals else {}
            kinds = {field: one.type.kind for field, one in fields.items()}
            if name in spec.events:
                kinds = {field: one.kind for field, one in spec.events[name].fields.items()}
            described = {field: {"type": _TYPES[kind]} for field, kind in kinds.items()}
            text = json.dumps({"type": "object", "properties": described}).encode()
            schema = writer.register_schema(name, "jsonschema", text)
            channels[name] = writer.register_channel(f"/{name}", "json", schema)
        for sample in trial.case.samples:
            for name, value in sample.values.items():
                for one in value if isinstance(value, tuple) else (value,):
                    said = {"data": one} if name in spec.signals else one
                    text = json.dumps({} if said is True else said).encode()
                    if name in channels:
                        writer.add_message(channels[name], sample.t, text, sample.t)
        writer.finish()


CSV = Door(
    _text(lambda content, folder: written_csv(content, folder, ""), _damaged_row, 1),
    _TRACES,
    ends=False,
)
JSON_LINES = Door(_text(written_json, damaged, 0), _TRACES, ends=False)
PARQUET = Door(parquet, _TRACES, ends=False)
MCAP = Door(mcap, _TRACES, ends=False)
