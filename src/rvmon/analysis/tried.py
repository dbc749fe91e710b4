"""What leaves are where something is tried, found by the core."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.formula.core import Sense
from rvmon.formula.factory import Factory
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Leaf
from rvmon.monitor.core.watching import Positions, known_truths
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample, Value


def truths_tried(
    spec: CheckedSpec, leaves: Sequence[Leaf], tried: Sequence[Mapping[str, Value]]
) -> list[tuple[int, ...]]:
    r"""The truths of leaves for each of some choices of values.

    Args:
        spec: declares what is read.
        leaves: of present values: signals, events and comparisons of these.
        tried: in each is all that the leaves read.

    Cost: one pass in C.

    >>> from rvmon import loads
    >>> from rvmon.spec.checked.formula import SignalAtom
    >>> spec = loads("signal p : bool\nrequirement R\n always p").checked
    >>> truths_tried(spec, [SignalAtom("p")], [{"p": True}, {"p": None}, {"p": False}])
    [(2,), (1,), (0,)]
    """
    if not leaves or not tried:
        return [()] * len(tried)
    factory = Factory()
    cores = [factory.literal(factory.leaf(leaf), Sense.TRUE) for leaf in leaves]
    # One position each: of the clock, of samples, or a tick.
    gap = spec.gap or 1
    samples = [Sample(place * gap, values) for place, values in enumerate(tried)]
    found = known_truths(spec, cores, samples, samples[-1].t, None, {})
    columns = [_column(one.true, one.false, len(tried)) for one in found]
    return list(zip(*columns, strict=True))


def _column(true: Positions, false: Positions, count: int) -> list[int]:
    """Truths by position."""
    column = [UNKNOWN] * count
    for truth, ranges in (TRUE, true), (FALSE, false):
        for first, last in ranges:
            for place in range(max(first, 0), min(last, count - 1) + 1):
                column[place] = truth
    return column
