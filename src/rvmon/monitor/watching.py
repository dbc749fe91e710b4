"""Finds where formulas are true, false or unknown over a recording, by the core."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from rvmon.core.plan import pack
from rvmon.logic.formula import Core
from rvmon.logic.network_plan import plan_of_all
from rvmon.logic.plan import plan_of_truths
from rvmon.monitor.compiled_spec import Kept
from rvmon.monitor.intake import Validator
from rvmon.monitor.planned import planned_as
from rvmon.readers.source import Source
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample, Scalar, Trace

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rvmon.monitor.recording import RecordingRun
    from rvmon.readers.batch import Batch


@dataclass(frozen=True, slots=True)
class Known:
    """Where a formula is decided.

    Attributes:
        true: int64[n, 2], ranges of positions, first and last, ascending: ticks, in clocked time
            ticks divided by the period, in sampled time numbers of samples.
        false: likewise.
    """

    true: NDArray[np.int64]
    false: NDArray[np.int64]


class TruthsPlan:
    """A plan that evaluates formulas over any number of recordings.

    Args:
        spec: the specification.
        formulas: may speak of the future; UNKNOWN where the recording ends too early.
        captured: the values that the formulas read as captured.
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

    Args:
        plan: of the formulas.
        names: the signals and events that have a source; `None`: all.
    """

    def __init__(self, plan: TruthsPlan, names: frozenset[str] | None) -> None:
        self._plan = plan
        self._names = names
        declared = frozenset(plan.planned.numbers)
        self._run = plan.planned.monitor(frozenset() if names is None else declared - names)
        known = None if names is None else names & declared
        self._validator = Validator(plan.spec, known, frozenset())

    def take(self, piece: Batch | Sample) -> None:
        """Take the next sample; names that the specification does not declare are skipped."""
        if not isinstance(piece, Sample):
            self._rows.take(piece)
            return
        t, values = piece.t, piece.values
        if self._run.judge(t, values, False):
            return
        read = {name: values[name] for name in self._plan.read if name in values}
        if self._run.judge(t, read, False):
            return
        if not self._run.judge(
            t, self._plan.planned.plain(t, self._validator.check(t, read)), True
        ):
            raise ValueError("the core does not take a sample that was checked")

    @cached_property
    def _rows(self) -> RecordingRun:
        from rvmon.monitor.recording import RecordingRun  # which imports NumPy

        source = Source(Trace((), self._names))
        made = RecordingRun(self._plan.spec, self._plan.planned, source, finds=False)
        made.core = self._run
        return made

    def known(self, end: int) -> list[Known]:
        """End the recording (ticks), and give where each formula is decided."""
        import numpy as np

        self._run.finish(end)
        return [
            Known(*(np.frombuffer(one, np.int64).reshape(-1, 2) for one in self._run.truths(place)))
            for place in self._plan.places
        ]


def known_truths(
    spec: CheckedSpec,
    formulas: Sequence[Core],
    samples: Iterable[Sample],
    end: int,
    names: frozenset[str] | None,
    captured: Mapping[str, Scalar],
) -> list[Known]:
    """Evaluate formulas at all positions of a recording; see `TruthsRun`.

    Args:
        spec: the specification.
        formulas: may speak of the future.
        samples: the recording, in order.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
        captured: the values that the formulas read as captured.

    Cost: one pass over the samples in C.
    """
    run = TruthsRun(TruthsPlan(spec, formulas, captured), names)
    for sample in samples:
        run.take(sample)
    return run.known(end)
