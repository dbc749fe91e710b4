"""Where formulas are true in a recording, found by the core."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from struct import iter_unpack

from rvmon.core.plan import pack
from rvmon.dataflow.network_plan import plan_of_all
from rvmon.formula.core import Core
from rvmon.monitor.core.packed_cache import Kept
from rvmon.monitor.core.planned import planned_as
from rvmon.monitor.inputs.validate import Validator
from rvmon.plan.planning import plan_of_truths
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample, Scalar

Positions = tuple[tuple[int, int], ...]
"""Ranges of positions, first and last, ascending: ticks, in clocked time ticks divided by the
period, in sampled time numbers of samples."""


@dataclass(frozen=True, slots=True)
class Known:
    """Where a formula is known in a recording.

    Attributes:
        true: surely.
        false: surely.
    """

    true: Positions
    false: Positions


def known_truths(
    spec: CheckedSpec,
    formulas: Sequence[Core],
    samples: Iterable[Sample],
    end: int,
    names: frozenset[str] | None,
    captured: Mapping[str, Scalar],
) -> list[Known]:
    """Where formulas are known, at all positions of a recording.

    Args:
        spec: the specification.
        formulas: may speak of the future; what the recording ends too early for is not known.
        samples: the recording, in order; what the specification does not declare is passed over.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
        captured: the values that the formulas read as captured.

    Cost: one pass over the samples in C.
    """
    plan = plan_of_truths(spec, formulas, captured)
    planned = planned_as(spec, (), Kept(pack(plan).data, frozenset(), {}))
    declared = frozenset(planned.numbers)
    run = planned.monitor(frozenset() if names is None else declared - names)
    validator = Validator(spec, None if names is None else names & declared, frozenset())
    for sample in samples:
        t, values = sample.t, sample.values
        if run.judge(t, values, False):
            continue
        read = {name: values[name] for name in plan.graph.by_name if name in values}
        if run.judge(t, read, False):
            continue
        if not run.judge(t, planned.plain(t, validator.check(t, read)), True):
            raise ValueError("the core does not take a sample that was checked")
    run.finish(end)
    places = plan_of_all(formulas, plan.gap).places
    return [Known(*(tuple(_ranges(one)) for one in run.truths(places[core]))) for core in formulas]


def _ranges(data: bytes) -> Iterator[tuple[int, int]]:
    return iter_unpack("=qq", data)
