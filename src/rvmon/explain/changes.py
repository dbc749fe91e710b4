"""The few samples of a recording at which state formulas can become other than they were."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence

from rvmon.plan.graph import Graph
from rvmon.readers.blocks import Block, up_to
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample


def changes_in_blocks(
    blocks: Iterable[Block], graphs: Sequence[Graph], spec: CheckedSpec, end: int
) -> list[list[Sample]]:
    """The samples that matter to each of some graphs, with all that this reads.

    Args:
        blocks: of one recording, in order; they are read once.
        graphs: of formulas of which present values are all that counts.
        spec: declares what they read; not in sampled time.
        end: the last instant that is looked at, ticks.

    Cost: memory grows with what is given, not with the recording.
    """
    from rvmon.monitor.columns.row_changes import rows_that_matter  # which imports NumPy

    found: list[list[Sample]] = [[] for _ in graphs]
    for block in blocks:
        own = up_to(end, block)
        if not len(own.times):
            break
        for graph, samples in zip(graphs, found, strict=True):
            columns = {name: own.columns[name] for name in graph.by_name if name in own.columns}
            rows = rows_that_matter(graph, spec, columns, own.times, 0, len(own.times))
            lists = [column[rows].tolist() for column in columns.values()]
            samples += (
                Sample(t, dict(zip(columns, values, strict=True)))
                for t, *values in zip(own.times[rows].tolist(), *lists, strict=True)
            )
        if len(own.times) < len(block.times):
            break
    return found


def changes_in_samples(
    samples: Iterable[Sample], read: Sequence[Container[str]], events: Container[str]
) -> list[list[Sample]]:
    """For each choice of names the samples that report of one of them what was not reported before.

    The first sample is always given. Another value than the one before is new, and an event is.

    Args:
        samples: of one recording, in order; they are read once.
        read: the choices; what is reported of other names is left out.
        events: the names of events.

    >>> found = [Sample(t, {"p": t > 2, "q": t}) for t in range(5)]
    >>> [(one.t, dict(one.values)) for one in changes_in_samples(found, [{"p"}], ())[0]]
    [(0, {'p': False}), (3, {'p': True})]
    """
    held: dict[str, object] = {}
    found: list[list[Sample]] = [[] for _ in read]
    for sample in samples:
        new = {}
        for name, value in sample.values.items():
            differs = value is not False
            if name not in events:
                differs = name not in held or bool(value != held[name])
                held[name] = value
            if differs:
                new[name] = value
        for names, own in zip(read, found, strict=True):
            changed = {name: value for name, value in new.items() if name in names}
            if changed or not own:
                own.append(Sample(sample.t, changed))
    return found
