"""Random tables: rows of what a specification reads, for the core as blocks and as samples."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from tests.tools.forms import Compiler, column_of

from rvmon import native
from rvmon.language.checked.specification import CheckedSpec
from rvmon.monitor.packed_plan import DECISIONS, PlannedCore, planned_core
from rvmon.monitor.records import NUMBER, RECORD
from rvmon.recordings.coalesce import Conflicts, coalesce, updates_in
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.trace.sample import Sample, Value
from rvmon.verdicts.attempt import Attempt, Decision

TRACES = 4
"""So many random traces of a specification say which values and steps of time matter to it."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows in order of time, of which some have one instant."""

    rows: Sequence[Sample]
    cuts: Sequence[int]
    end: int
    names: frozenset[str]


def random_table(rng: random.Random, spec: CheckedSpec, single: frozenset[str], most: int) -> Table:
    """A table of up to so many rows."""
    values: dict[str, list[Value]] = defaultdict(list)
    steps: list[int] = [1]
    for _ in range(TRACES):
        case = random_trace(rng, spec, TraceProfile())
        for sample in case.samples:
            for name, value in sample.values.items():
                values[name] += value if isinstance(value, tuple) else [value]
        steps += [then.t - now.t for now, then in pairwise(case.samples)]
    names = [name for name in (*spec.signals, *spec.events) if values[name] and rng.random() < 0.95]
    columns = {
        name: _column(rng, values[name], most, is_event=name in spec.events) for name in names
    }
    rows = [*_rows(rng, columns, steps, single, rng.randrange(most))]
    cuts = sorted(rng.sample(range(1, max(len(rows), 2)), min(len(rows) // 2, rng.randrange(4))))
    last = rows[-1].t if rows else 0
    return Table(rows, cuts, last + rng.choice([0, *steps]), frozenset(names))


def _rows(
    rng: random.Random,
    columns: Mapping[str, Sequence[Value | type[_Nothing]]],
    steps: Sequence[int],
    single: frozenset[str],
    count: int,
) -> Iterator[Sample]:
    doubled = rng.choice([0.0, 0.0, 0.02, 0.5])
    slow = rng.choice([1, 1, 7])
    t = rng.choice([0, 0, -5, 1000])
    carried: set[str] = set()
    for row in range(count):
        if row and rng.random() >= doubled:
            t += max(rng.choice(steps) // slow, 1)
            carried = set()
        said = {name: column[row] for name, column in columns.items()}
        own: dict[str, Value] = {
            name: value for name, value in said.items() if not isinstance(value, type)
        }
        payloads = {name for name, value in own.items() if isinstance(value, Mapping)}
        for name in payloads & carried & single:
            del own[name]
        carried |= payloads
        yield Sample(t, own)


class _Nothing:
    """A row that says nothing of a name."""


def _column(
    rng: random.Random, values: Sequence[Value], count: int, *, is_event: bool
) -> Sequence[Value | type[_Nothing]]:
    """What the rows say of a name: seldom anything new, always something new, or anything."""
    gaps = rng.choice([0.0, 0.0, 0.3, 0.95])
    news = rng.choice([0.01, 0.1, 0.5, 1.0])
    seldom = rng.choice([0.01, 0.1, 0.5]) if is_event else 1.0
    now = rng.choice(values)
    found: list[Value | type[_Nothing]] = []
    for _ in range(count):
        if rng.random() < news:
            now = rng.choice(values)
        occurs = not is_event or rng.random() < seldom
        found.append(_Nothing if rng.random() < gaps else now if occurs else False)
    return found


def rows_differ(planned: PlannedCore, spec: CheckedSpec, table: Table) -> str:
    """How blocks are judged otherwise than the samples that they hold; empty if they are not."""
    absent = frozenset(planned.numbers) - table.names
    by_rows, by_steps = planned.monitor(absent), planned.monitor(absent)
    looked_at = ["records", "counts", "times", "open"]
    if spec.period is None:  # a sample that changes nothing may have a tick looked at in vain
        looked_at.append("next_due")
    ended = [0, *table.cuts, len(table.rows)]
    for start, stop in pairwise(ended):
        rows = table.rows[start:stop]
        # What is of one instant is in one block.
        while stop < len(table.rows) and rows and table.rows[stop].t == rows[-1].t:
            rows = [*rows, table.rows[stop]]
            stop += 1
        while start and rows and table.rows[start - 1].t == rows[0].t:
            rows = rows[1:]
            start += 1
        _feed(planned, by_rows, rows)
        told = (Sample(one.t, updates_in(one.values, spec.ignoring)) for one in rows)
        for sample in coalesce(told, spec.events, Conflicts()):
            if not by_steps.judge(sample.t, planned.plain(sample.t, sample.values), True):
                return f"the sample at {sample.t} was not taken"
        if found := _differs(by_rows, by_steps, looked_at):
            return f"{found}, by row {stop}"
    for one in (by_rows, by_steps):
        one.finish(table.end)
    return _differs(by_rows, by_steps, looked_at)


def _feed(planned: PlannedCore, run: native.Monitor, rows: Sequence[Sample]) -> None:
    names = dict.fromkeys(name for row in rows for name in row.values)
    columns = tuple(column_of(planned, name, rows) for name in names)
    taken = run.rows(np.array([row.t for row in rows], np.int64), columns)
    if taken < len(rows):
        raise ValueError(f"row {taken} was not taken")


def _differs(one: native.Monitor, other: native.Monitor, looked_at: Sequence[str]) -> str:
    for what in looked_at:
        found = [getattr(run, what)() for run in (one, other)]
        if what == "records":
            found = [sorted(map(str, _records(*own[:2]))) for own in found]
        elif what == "open":
            found = [sorted(own, key=by_number) for own in found]
        if found[0] != found[1]:
            return f"{what}: {found[0]!r} by rows, {found[1]!r} by samples"
    return ""


def by_number(attempt: Attempt) -> tuple[str, bool, int]:
    return attempt.requirement, attempt.in_doubt, attempt.number


def _records(records: bytes, numbers: bytes) -> Iterator[Any]:
    """Records with what they captured, less what means nothing.

    That is where captured values stand, when an open attempt was decided, and which number a value
    is that is unknown.
    """
    made = np.frombuffer(records, RECORD)
    captured = np.frombuffer(numbers, NUMBER).reshape(len(made), -1 if len(made) else 0)
    for record, values in zip(made, captured, strict=True):
        found = dict(zip(RECORD.names or (), record.tolist(), strict=True))
        if found["decision"] == _OPEN:
            del found["decided"]
        found["captured"] = found["captured"] < 0 or [
            (kind, kind and bits) for kind, bits in values.tolist()
        ]
        yield sorted(found.items())


_OPEN = DECISIONS.index(Decision.OPEN)


def planned_for(spec: CheckedSpec, compiler: Compiler) -> PlannedCore:
    """The packed plan of a specification."""
    return planned_core(compiler(spec))
