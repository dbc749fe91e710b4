"""Finds where formulas are true, false or unknown over a recording, using the core."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from msgspec import Struct

from rvmon.core.pack import pack
from rvmon.language.checked.specification import CheckedSpec
from rvmon.logic.formula import Core
from rvmon.logic.network_plan import plan_of_all
from rvmon.logic.plan import plan_of_truths
from rvmon.monitor.compiled_spec import Kept
from rvmon.monitor.packed_plan import planned_as
from rvmon.recordings.source import Source
from rvmon.trace.sample import Sample, Scalar, Trace

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch


class Known(Struct, frozen=True):
    """The positions at which a formula is decided."""

    # int64[n, 2], ranges of positions (first, last), ascending. Positions are ticks in held time,
    # ticks divided by the period in clocked time, and sample numbers in sampled time
    true: NDArray[np.int64]
    false: NDArray[np.int64]  # the same for FALSE


class TruthsPlan:
    """A plan that evaluates formulas over any number of recordings.

    The formulas may have future operators, and are UNKNOWN where the recording ends too early.
    `captured` holds the captured values that they read, by name.
    """

    def __init__(
        self, spec: CheckedSpec, formulas: Sequence[Core], captured: Mapping[str, Scalar]
    ) -> None:
        plan = plan_of_truths(spec, formulas, captured)
        self.spec = spec
        self.planned = planned_as(spec, (), Kept(pack(plan).data))
        self.read = plan.graph.by_name
        places = plan_of_all(formulas, plan.gap).places
        self.places = [places[core] for core in formulas]


class TruthsRun:
    """Evaluates formulas while a recording is read.

    `recording` supplies names, end and outages; its samples are passed to `take`.
    """

    def __init__(self, plan: TruthsPlan, recording: Trace) -> None:
        from rvmon.monitor.evaluate import RecordingRun  # imports NumPy

        self._plan = plan
        self._run = RecordingRun(plan.spec, plan.planned, Source(recording), finds=False)

    def take(self, piece: Batch | Sample) -> None:
        """Take the next piece of the recording; names that no formula reads are skipped."""
        if isinstance(piece, Sample):
            values = piece.values
            piece = Sample(
                piece.t, {name: values[name] for name in self._plan.read if name in values}
            )
        self._run.take(piece)

    def known(self) -> list[Known]:
        """End the recording; returns, per formula, where it is decided."""
        import numpy as np

        self._run.finish()
        truths = self._run.core.truths
        return [
            Known(*(np.frombuffer(truth, np.int64).reshape(-1, 2) for truth in truths(place)))
            for place in self._plan.places
        ]


def known_truths(
    spec: CheckedSpec, formulas: Sequence[Core], samples: Iterable[Sample], end: int
) -> list[Known]:
    """Evaluate formulas at all positions of a recording; see `TruthsRun`.

    The formulas may have future operators but read no captured values. `end` is the last instant,
    ticks.

    Cost: one pass over the samples in C.
    """
    run = TruthsRun(TruthsPlan(spec, formulas, {}), Trace((), None, end))
    for sample in samples:
        run.take(sample)
    return run.known()
