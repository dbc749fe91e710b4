"""The rows of columns at which something becomes another: the rest need not be judged."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from rvmon.formula.state import Leaf, Unborn
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError, compared
from rvmon.monitor.columns.reading import first_known
from rvmon.monitor.inputs.health import holds_nan
from rvmon.plan.graph import Graph
from rvmon.plan.leaves import reads
from rvmon.spec.checked.formula import Compare, Probe, ProbeAtom, SignalAtom
from rvmon.spec.checked.specification import CheckedSpec

if TYPE_CHECKING:
    from numpy.typing import NDArray


def rows_that_matter(
    graph: Graph,
    spec: CheckedSpec,
    columns: Columns,
    times: NDArray[np.int64],
    start: int,
    stop: int,
) -> NDArray[np.intp]:
    """The rows of a chunk at which a state formula may become another, in held or clocked time.

    Args:
        graph: of the formulas.
        spec: declares what they read.
        columns: by name; the row before the chunk is looked at, if there is one.
        times: int64[n] ticks, of all rows of the columns.
        start: the first row of the chunk.
        stop: behind its last row.

    Returns:
        intp[m], ascending; with the first row of all.
    """
    before = max(start - 1, 0)
    matters = np.zeros(stop - before, bool)
    own = {name: column[before:stop] for name, column in columns.items()}
    matters[0] |= start == 0
    if any(holds_nan(own[name]) for name in spec.ignoring & own.keys()):
        # What such a row leaves as it was, the row alone does not say.
        matters[:] = True
    for name in own.keys() & spec.signals.keys():
        # A birth may change what is made of a value that stays unknown.
        birth = first_known(own[name])
        if birth < len(matters):
            matters[birth] = True
    for place, own_reads in graph.reads.items():
        leaf = graph.nodes[place].leaf
        if leaf is None or not own_reads.names & own.keys():
            continue
        if own_reads.momentary:
            matters |= _may_occur(leaf, own, spec)
            continue
        truth = _truth(leaf, own)
        if truth is None:
            matters[:] = True
            break
        matters[1:] |= truth[1:] != truth[:-1]
    bounds = [spec.signals[name].stale_after for name in own if name in spec.signals]
    shortest = min((bound for bound in bounds if bound is not None), default=None)
    if shortest is not None:
        matters |= _refreshing(times[before:stop], shortest)
    for column in own.values():
        if column.dtype.kind == "f":
            # From when to when a signal was not known is reported, whatever is made of it.
            lost = np.isnan(column)
            matters[1:] |= lost[1:] != lost[:-1]
    if before < start:
        matters[0] = False
    return np.flatnonzero(matters) + before


def _refreshing(times: NDArray[np.int64], bound: int) -> NDArray[np.bool_]:
    """Rows without which a signal would seem stale that is not, or fresh that is not.

    The first and the last row of each half of the bound: two of them that follow each other are
    further apart than the bound only if the recording has no row between.
    """
    if bound < 2:
        return np.ones(len(times), bool)
    turns = np.diff(times // (bound // 2)) != 0
    # The last row of a piece is taken, as its first one is: there is no other to compare with.
    return np.concatenate(([True], turns)) | np.concatenate((turns, [True]))


def _may_occur(leaf: Leaf, columns: Columns, spec: CheckedSpec) -> NDArray[np.bool_]:
    """The rows at which a leaf that speaks of one position may be true."""
    length = len(next(iter(columns.values())))
    if isinstance(leaf, ProbeAtom) and leaf.probe is not Probe.KNOWN:
        return np.ones(length, bool)
    events = [columns[name] for name in reads(leaf).names & columns.keys() & spec.events.keys()]
    return reduce(np.logical_or, events, np.zeros(length, bool))


def _truth(leaf: Leaf, columns: Columns) -> NDArray[np.int8] | None:
    """0, 1 (unknown) or 2 per row; `None` if the leaf looks at more than the row."""
    match leaf:
        case SignalAtom(name=name):
            return columns[name].astype(np.int8)
        case ProbeAtom(probe=Probe.KNOWN, name=name):
            values = columns[name]
            known: NDArray[np.int8] = (values == values).astype(np.int8)
            return known
        case Unborn(signals=signals) if not any(moved for _, moved in signals):
            return np.zeros(len(next(iter(columns.values()))), np.int8)
        case Compare():
            try:
                truth = compared(leaf, columns, len(next(iter(columns.values()))))
            except NotByColumnsError:
                return None
            made: NDArray[np.int8] = truth.must.astype(np.int8) + truth.may
            return made
        case _:
            return None
