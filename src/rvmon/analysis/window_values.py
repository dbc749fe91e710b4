"""Evaluates windows of the past, such as `count(e, 10 s)`, at given instants of a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from msgspec.structs import replace

from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import (
    Amount,
    Compare,
    Constant,
    Interval,
    SignalValue,
    Unary,
    UnaryOp,
    WindowValue,
    windows_in,
)
from rvmon.language.checked.specification import Capture, CheckedSpec, Mode, Requirement, TimeModel
from rvmon.language.checked.window_measures import Dimension
from rvmon.language.print import format_formula
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.packed_plan import planned_core
from rvmon.recordings.source import Source
from rvmon.trace.sample import Scalar, Trace

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch
    from rvmon.trace.sample import Sample
    from rvmon.verdicts.attempt import Blame

WindowRequest = tuple[int, WindowValue]  # an instant in ticks, and the window to be evaluated there


def windows_blamed(spec: CheckedSpec, requirement: Requirement, blame: Blame) -> list[WindowValue]:
    """The windows of the blamed subformula whose values are worth showing.

    There are none for a requirement with `for each` or `let`. In held time, windows that move
    between samples are left out, because they fail exactly when they reach their limit.
    """
    if requirement.captured:
        return []
    parts = list(subformulas(requirement.consequent))
    failed = [part for part in parts if format_formula(part) == blame.subformula] or parts
    windows: dict[WindowValue, None] = {}
    for subformula in subformulas(failed[0]):
        match subformula:
            case Amount(of=window):
                windows[window] = None
            case Compare(left=left, right=right):
                windows |= dict.fromkeys(windows_in(left, right))
    is_held = spec.time is TimeModel.HELD
    return [
        window
        for window in windows
        if not (is_held and window.moves) and unit_of(spec, window) is not None
    ]


def unit_of(spec: CheckedSpec, window: WindowValue) -> str | None:
    """The unit of a window's value; "" for none, `None` if it is not known."""
    match window.measured.dimension, window.value:
        case Dimension.PLAIN, _:
            return ""
        case Dimension.SAME, SignalValue(name=name) if name in spec.signals:
            return spec.signals[name].type.unit
        case _:
            return None


class WindowValues:
    """Evaluates windows while a recording is read.

    Each window is captured by a requirement of its own that is triggered at the instant.
    """

    def __init__(
        self, spec: CheckedSpec, requests: Sequence[WindowRequest], origin: int, recording: Trace
    ) -> None:
        from rvmon.monitor.evaluate import RecordingRun  # imports NumPy

        self._requests = requests
        requirements = {
            str(place): _captured_at(str(place), t - origin, window)
            for place, (t, window) in enumerate(requests)
        }
        # The samples of a recording are in order, so `max delay` would only hold them back.
        captured = replace(
            spec, requirements=requirements, properties={}, covers={}, max_delay=None
        )
        planned = planned_core(compile_spec(captured))
        self._run = RecordingRun(captured, planned, Source(recording), finds=False)

    def take(self, piece: Batch | Sample) -> None:
        """Take the next piece of the recording."""
        self._run.take(piece)

    def values(self) -> Mapping[WindowRequest, Scalar]:
        """End the recording; returns the values that are known."""
        return {
            self._requests[int(attempt.requirement)]: value
            for attempt in self._run.report().attempts
            if (value := attempt.captured["it"]) is not None
        }


def _captured_at(name: str, since_origin: int, window: WindowValue) -> Requirement:
    """A requirement that captures a window at the first position from an instant on."""
    # `once` of true, so long ago or longer, becomes true at that instant and stays true.
    reached = Unary(UnaryOp.ONCE, Constant(True), Interval(since_origin))
    return Requirement(name, Mode.UPON, reached, Constant(True), captures=(Capture("it", window),))
