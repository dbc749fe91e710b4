"""What is odd about rows that come as columns: as `rvmon.readers.rows.Rows` notes it of samples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.alternation import Alternations
from rvmon.readers.batch import NO_UPDATE, UNKNOWN, YES, Batch, Cells
from rvmon.readers.coalesce import Conflicts

if TYPE_CHECKING:
    from numpy.typing import NDArray


def without_ignored(batch: Batch, ignoring: frozenset[str]) -> Batch:
    """The rows without NaN and null of signals of which these are no update."""
    own = {name: batch.signals[name] for name in ignoring & batch.signals.keys()}
    changed = {}
    for name, cells in own.items():
        unknown = unknown_in(cells)
        if unknown is not None:
            says = np.full(len(batch.times), YES, np.uint8) if cells.says is None else cells.says
            changed[name] = replace(cells, says=np.where(unknown, np.uint8(NO_UPDATE), says))
    return replace(batch, signals={**batch.signals, **changed}) if changed else batch


def unknown_in(cells: Cells) -> NDArray[np.bool_] | None:
    """The rows that say that it is unknown, by NaN or otherwise; `None`: there is none."""
    found = None if cells.says is None else cells.says == UNKNOWN
    if holds_nan(cells.values):
        nan = np.isnan(cells.values)
        if cells.says is not None:
            nan &= cells.says == YES
        found = nan if found is None else found | nan
    return found if found is not None and found.any() else None


def holds_nan(values: NDArray[Any]) -> bool:
    """Whether some number is NaN."""
    if values.dtype.kind != "f":
        return False
    # Mostly one sum shows that there is none; that of infinities may be NaN, too.
    with np.errstate(invalid="ignore", over="ignore"):
        return bool(np.isnan(np.add.reduce(values)) and np.isnan(values).any())


def note_batch(batch: Batch, alternations: Alternations, conflicts: Conflicts) -> None:
    """Note how unknown values alternate with known ones, and where there are two of one instant."""
    some_again = bool((batch.times[1:] == batch.times[:-1]).any())
    for name, cells in batch.signals.items():
        if some_again:
            _note_conflicts(batch, name, cells, conflicts)
        said = last_said(batch, cells) if some_again else _said(cells)
        _note(alternations, name, unknown_in(cells), said, len(batch.times))
    for name, one in batch.events.items():
        bare = one.says != NO_UPDATE
        for field, cells in one.fields.items():
            said = _said(cells)
            bare &= cells.says == NO_UPDATE if cells.says is not None else np.False_
            _note(alternations, f"{name}.{field}", unknown_in(cells), said, len(batch.times))
        _note(alternations, name, one.says == UNKNOWN, bare, len(batch.times))


def _note(
    alternations: Alternations,
    name: str,
    unknown: NDArray[np.bool_] | None,
    said: NDArray[Any] | None,
    count: int,
) -> None:
    """Note what some rows say, of all if `said` is `None`."""
    if unknown is not None:
        looked_at = unknown if said is None else unknown[said]
        if looked_at.any():
            alternations.note_column(name, looked_at)
            return
        count = len(looked_at)
    elif said is not None:
        count = int(said.sum()) if said.dtype.kind == "b" else len(said)
    if count:
        alternations.note_known(name, count)


def _said(cells: Cells) -> NDArray[Any] | None:
    """Which rows say something; `None`: all."""
    return None if cells.says is None else cells.says != NO_UPDATE


def last_said(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    """The rows that say something, the last of each instant."""
    rows = _rows_said(batch, cells)
    times = batch.times[rows]
    return rows[np.append(times[1:] != times[:-1], True)] if len(rows) else rows


def _note_conflicts(batch: Batch, name: str, cells: Cells, conflicts: Conflicts) -> None:
    """Count where neighbours of one instant say different things of a signal."""
    rows = _rows_said(batch, cells)
    times, values = batch.times[rows], cells.values[rows]
    differs = values[1:] != values[:-1]
    if cells.says is not None:
        none = cells.says[rows] == UNKNOWN
        differs = (differs & ~(none[1:] & none[:-1])) | (none[1:] != none[:-1])
    found = np.flatnonzero((times[1:] == times[:-1]) & differs)
    if len(found):
        conflicts.add(name, int(times[found[0]]), len(found))


def _rows_said(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    if cells.says is None:
        return np.arange(len(batch.times))
    return np.flatnonzero(cells.says != NO_UPDATE)


def unknown_rows(
    batch: Batch, cells: Cells, *, is_signal: bool
) -> Iterator[tuple[bool, NDArray[np.int64]]]:
    """The instants at which NaN (true), or null, is the last that is said of a signal, or field."""
    unknown = unknown_in(cells)
    if unknown is None:
        return
    rows = last_said(batch, cells) if is_signal else _rows_said(batch, cells)
    rows = rows[unknown[rows]]
    for is_nan in (True, False):
        null = np.zeros(len(rows), bool) if cells.says is None else cells.says[rows] == UNKNOWN
        own = batch.times[rows[~null if is_nan else null]]
        if len(own):
            yield is_nan, own
