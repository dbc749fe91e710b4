"""One random recording through every door: files, tables, frames, pairs."""

import csv
import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.recordings import parquet, places
from rvmon.session import Spec
from rvmon.testing.generate import Rng, chance
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind

NAN = float("nan")
ABSENT = "gone"
"""The text that stands for no update where a door is told so."""

Cells = dict[str, Any]
"""By the name of the column, only those that say something."""


@dataclass(frozen=True, slots=True)
class Content:
    """What a recording says, whatever holds it.

    Attributes:
        columns: kind of their cells by name: signals, events, `event.field`.
        events: the names that are events.
        rows: ticks and cells; stamps may be equal.
    """

    columns: Mapping[str, Kind]
    events: frozenset[str]
    rows: tuple[tuple[int, Cells], ...]

    @property
    def sources(self) -> frozenset[str]:
        """The names that have a column."""
        return frozenset(name.partition(".")[0] for name in self.columns)


def told(spec: Spec, trace: object, **arguments: Any) -> str:
    """The report on a recording as JSON; or the name of the error that refuses it."""
    try:
        report = spec.evaluate(trace, allow_missing=True, **arguments)
        return replace(report, trace="").to_json()
    except RvmonError as error:
        return type(error).__name__


def content_of(rng: Rng, case: Case) -> Content:
    """A random trace as rows, some of which are split or contradicted by further ones.

    Labels of which nothing is known are left out: text has no NaN.
    """
    columns = _columns(case.spec, case.names)
    rows: list[tuple[int, Cells]] = []
    for sample in case.samples:
        own: list[Cells] = [{}]
        for name, value in sample.values.items():
            if name in case.spec.signals:
                _signal(own[0], name, value, columns[name])
            else:
                _event(rng, own, name, value, columns)
        if chance(rng, 4) and own[0]:
            own.append({name: cell for name, cell in own[0].items() if name in case.spec.signals})
        rows += [(sample.t, cells) for cells in own]
    return Content(columns, frozenset(case.spec.events), tuple(rows))


def whole(content: Content) -> Content:
    """The same with a cell in every row, as columns of numbers hold it: no labels, no payloads."""
    carriers = {name.partition(".")[0] for name in content.columns if "." in name}
    columns = {
        name: kind
        for name, kind in content.columns.items()
        if kind is not Kind.LABEL and name.partition(".")[0] not in carriers
    }
    first = {Kind.BOOL: False, Kind.INT: 0, Kind.REAL: NAN}
    now: Cells = {name: first[kind] for name, kind in columns.items()}
    rows: list[tuple[int, Cells]] = []
    for t, cells in content.rows:
        for name in columns:
            cell = cells.get(name, first[columns[name]] if name in content.events else now[name])
            unknown = cell != cell and columns[name] is not Kind.REAL
            now[name] = first[columns[name]] if unknown else cell
        if not rows or t > rows[-1][0]:
            rows.append((t, dict(now)))
    return Content(columns, content.events, tuple(rows))


def _columns(spec: CheckedSpec, names: frozenset[str] | None) -> dict[str, Kind]:
    columns = {}
    for name, signal in spec.signals.items():
        if names is None or name in names:
            columns[name] = signal.type.kind
    for name, event in spec.events.items():
        if names is None or name in names:
            fields = {f"{name}.{field}": type_.kind for field, type_ in event.fields.items()}
            columns |= {name: Kind.BOOL, **fields}
    return columns


def _signal(cells: Cells, name: str, value: Value, kind: Kind) -> None:
    if value is not None and value == value:
        cells[name] = value
    elif kind is not Kind.LABEL:
        cells[name] = NAN


def _event(
    rng: Rng, own: list[Cells], name: str, value: Value, columns: Mapping[str, Kind]
) -> None:
    payloads = value if isinstance(value, tuple) else (value,)
    for place, payload in enumerate(payloads):
        if place == len(own):
            own.append({})
        cells = own[place]
        if not isinstance(payload, Mapping):
            cells[name] = NAN if payload is None else payload
            if payload is False and chance(rng, 30):  # what its fields say then is not heard
                cells |= {column: 1 for column in columns if column.startswith(f"{name}.")}
            continue
        for field, scalar in payload.items():
            cells[f"{name}.{field}"] = NAN if scalar is None else scalar
        if chance(rng, 50):
            cells[name] = True


Door = Callable[[Content, Path], tuple[Any, dict[str, Any]]]
"""Writes a content; gives what `evaluate` takes, with further arguments."""


def doors() -> dict[str, Door]:
    """All that can be opened here, by name: Arrow, pandas and polars need their packages."""
    found: dict[str, Door] = {
        "CSV": lambda content, folder: (written_csv(content, folder, ""), {}),
        "CSV, absent cells named": lambda content, folder: (
            written_csv(content, folder, ABSENT),
            {"no_update": ABSENT},
        ),
        "JSON lines": lambda content, folder: (
            written_json(content, folder),
            {"sources": content.sources},
        ),
        "pairs": lambda content, _: (
            [(t / 1e9, values) for t, values in _lines(content)],
            {"sources": content.sources},
        ),
        "lists": lambda content, _: (_lists(content, None), {}),
        "lists, absent cells named": lambda content, _: (
            _lists(content, ABSENT),
            {"no_update": ABSENT},
        ),
        "arrays": lambda content, _: (_arrays(content), {}),
    }
    if find_spec("pyarrow"):
        found["Arrow"] = lambda content, _: (arrow_of(content), {})
        found["Arrow stream"] = lambda content, _: (_Stream(arrow_of(content)), {})
        found["Parquet"] = lambda content, folder: (_parquet(content, folder), {})
    if find_spec("pandas"):
        found["pandas"] = lambda content, _: (_pandas(content), {})
    if find_spec("polars") and find_spec("pyarrow"):
        found["polars"] = lambda content, _: (_polars(content), {})
    return found


def _lists(content: Content, absent: Any) -> dict[str, list[Any]]:
    columns = {name: [row.get(name, absent) for _, row in content.rows] for name in content.columns}
    return {"t_ns": [t for t, _ in content.rows], **columns}


def written_csv(content: Content, folder: Path, absent: str) -> Path:
    path = folder / "a.csv"
    lists = _lists(content, absent)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(lists)
        writer.writerows(zip(*lists.values(), strict=True))
    return path


def _lines(content: Content) -> Iterator[tuple[int, dict[str, Any]]]:
    """The rows by name: payloads as such."""
    for t, cells in content.rows:
        values: dict[str, Any] = {n: cell for n, cell in cells.items() if "." not in n}
        for name, cell in cells.items():
            event, _, field = name.partition(".")
            if field and cells.get(event) is not False:
                if not isinstance(values.get(event), dict):
                    values[event] = {}
                values[event][field] = cell
        yield t, values


def written_json(content: Content, folder: Path) -> Path:
    path = folder / "a.jsonl"
    lines = (json.dumps({"t_ns": t, **values}) for t, values in _lines(content))
    path.write_text("".join(f"{line}\n" for line in lines))
    return path


_TYPES = {Kind.BOOL: "?", Kind.INT: "i8", Kind.REAL: "f8", Kind.LABEL: "U16"}


def _typed(content: Content) -> Iterator[tuple[str, str, list[Any]]]:
    """Name, NumPy type and cells of each column; NaN makes numbers of whole ones and of truths."""
    for name, cells in _lists(content, None).items():
        kind = content.columns.get(name, Kind.INT)
        has_nan = any(isinstance(cell, float) and math.isnan(cell) for cell in cells)
        yield name, "f8" if has_nan else _TYPES[kind], cells


def _arrays(content: Content) -> dict[str, Any]:
    """Arrays, with masks where cells are absent."""
    found: dict[str, Any] = {}
    for name, type_, cells in _typed(content):
        absent = [cell is None for cell in cells]
        array = np.array(["" if type_ == "U16" else 0] * len(cells), type_)
        for row, cell in enumerate(cells):
            if cell is not None:
                array[row] = cell
        found[name] = np.ma.array(array, mask=absent) if any(absent) else array
    return found


def arrow_of(content: Content) -> Any:
    import pyarrow

    types = {
        "?": pyarrow.bool_(),
        "i8": pyarrow.int64(),
        "f8": pyarrow.float64(),
        "U16": pyarrow.string(),
    }
    columns = {}
    for name, type_, cells in _typed(content):
        if type_ == "f8":
            cells = [None if cell is None else float(cell) for cell in cells]
        columns[name] = pyarrow.array(cells, types[type_], from_pandas=False)
    return pyarrow.table(columns)


@dataclass(frozen=True, slots=True)
class _Stream:
    """Something that gives itself out as an Arrow table, and is none."""

    table: Any

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self.table.__arrow_c_stream__(requested_schema)


def _parquet(content: Content, folder: Path) -> Path:
    from pyarrow import parquet

    path = folder / "a.parquet"
    parquet.write_table(arrow_of(content), path)
    return path


def _pandas(content: Content) -> Any:
    """A frame with types that tell what is missing from NaN."""
    import pandas

    nullable = {"?": "boolean", "i8": "Int64", "f8": object, "U16": "string"}
    return pandas.DataFrame(
        {
            name: pandas.Series(cells, dtype=nullable[type_])
            for name, type_, cells in _typed(content)
        }
    )


def _polars(content: Content) -> Any:
    import polars

    return polars.from_arrow(arrow_of(content))


@contextmanager
def in_pieces(size: int) -> Iterator[None]:
    """Files are read in pieces of so many bytes, however short they are."""
    kept = places.BLOCK, parquet.ROWS
    places.BLOCK, parquet.ROWS = size, 5
    try:
        yield
    finally:
        places.BLOCK, parquet.ROWS = kept
