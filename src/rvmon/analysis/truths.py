"""Evaluates formulas over a whole recording, as sets of ticks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from functools import cached_property
from typing import TYPE_CHECKING, assert_never

import numpy as np
from msgspec import Struct, field

from rvmon.analysis.interval_sets import distinct, joined, within
from rvmon.language.checked.classify import is_end
from rvmon.language.checked.formula import Amount, Binary, Formula, Unary, UnaryOp, WindowValue
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.specification import CheckedSpec, ForEach, Requirement, TimeModel
from rvmon.language.print import format_formula
from rvmon.logic.formula import Core, Factory
from rvmon.logic.normal_form import Lowering
from rvmon.monitor.formula_truths import TruthsPlan, TruthsRun
from rvmon.recordings.held_recording import HeldRecording, samples_of
from rvmon.trace.sample import Outage, Payload, Sample, Scalar, Trace, Value, payloads_of
from rvmon.trace.schema import is_unknown
from rvmon.verdicts.attempt import Attempt

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch

    Positions = range | NDArray[np.int64] | None
    """The instants of positions, ascending; `None` if every tick is a position."""


class Truth(Struct, frozen=True):
    """The ticks at which a formula is TRUE, and those at which it is FALSE.

    Both are closed intervals int64[n, 2] as in `rvmon.analysis.interval_sets`.
    """

    true: NDArray[np.int64]
    false: NDArray[np.int64]


class Question(Struct, frozen=True, dict=True):
    """Formulas to be evaluated, with their captured values."""

    formulas: tuple[Formula, ...]  # may have future operators
    for_each: ForEach | None = None  # the `for each` clause, if they belong to an instance
    # the captured values of `let` and `for each`
    captured: Mapping[str, Scalar] = field(default_factory=dict)

    @cached_property
    def whose(self) -> tuple[object, ...]:
        """A key: questions with equal keys can be evaluated in one run."""
        return self.for_each, *self.captured.items()

    @property
    def names(self) -> frozenset[str]:
        """The signals and events that the formulas read."""
        read = {name for formula in self.formulas for name in names_read(formula)}
        return frozenset(read if self.for_each is None else {*read, self.for_each.value.event})

    @cached_property
    def texts(self) -> tuple[str, ...]:
        """The texts of the formulas; formulas with equal texts are evaluated once."""
        return tuple(map(format_formula, self.formulas))


class RecordedTruths(Struct, frozen=True):
    """The truths of formulas over a recording; after its end they are unknown.

    In clocked and sampled time, a truth value lasts from its position until the next one.
    """

    names: frozenset[str] | None  # the signals and events that had a source; `None`: all
    first: int | None  # the instant of the first sample, ticks; `None` if there is no sample
    end: int  # the last instant, ticks
    positions: Positions  # the positions of the recording
    valueless: frozenset[str]  # the signals that never had a value
    _truths: Mapping[tuple[object, ...], Mapping[str, Truth]]

    def truths(self, question: Question) -> list[Truth]:
        """The truths of the formulas of a question, in order."""
        by_text = self._truths[question.whose]
        return [by_text[text] for text in question.texts]


def look_through(
    spec: CheckedSpec,
    questions: Sequence[Question],
    pieces: Iterable[Batch | Sample],
    end: int,
    names: frozenset[str] | None = None,
    plans: Plans | None = None,
    outages: Sequence[Outage] = (),
) -> RecordedTruths:
    """Evaluate formulas over a recording, which is read once.

    Plans of earlier calls are taken from `plans`, and new ones are added. If `pieces` is a
    `HeldRecording`, its own outages replace `outages`.

    Cost: one pass in C for each `Question.whose`. Memory is linear in the number of changes of
    truth values, in sampled time in the number of samples.
    """
    groups: dict[tuple[object, ...], _Group] = {}
    for question in questions:
        if question.whose not in groups:
            groups[question.whose] = _Group(spec, question)
        groups[question.whose].add(question)
    if isinstance(pieces, HeldRecording):
        outages, pieces = pieces.outages, pieces.pieces()
    source = Trace((), names, end, outages)
    runs = [group for group in groups.values() if group.start(source, plans)]
    first: int | None = None
    instants: list[NDArray[np.int64]] = []
    valueless = set(spec.signals)
    of_instances = any(question.for_each is not None for question in questions)
    for piece in pieces:
        times = np.array([piece.t]) if isinstance(piece, Sample) else piece.times
        if first is None and len(times):
            first = int(times[0])
        if spec.time is TimeModel.SAMPLED:
            instants.append(times)
        if valueless:
            valueless -= _born(piece, valueless)
        samples = tuple(samples_of(piece)) if of_instances else ()
        for run in runs:
            run.take(piece, samples)
    positions = None if first is None else _positions(spec, first, end, instants)
    ticks = _Ticks(positions, first or 0, end)
    truths = {whose: group.truths(ticks) for whose, group in groups.items()}
    return RecordedTruths(names, first, end, positions, frozenset(valueless), truths)


class _Plan:
    """The plan of formulas that are evaluated in one run."""

    def __init__(
        self, spec: CheckedSpec, question: Question, formulas: Mapping[str, Formula]
    ) -> None:
        lowering = Lowering(Factory(), spec.period, False)
        # by text; `None` for the formula `end`, which is unknown throughout the recording
        self.cores = {
            text: None if is_end(formula) else lowering.core(formula, True)
            for text, formula in formulas.items()
        }
        # the distinct core formulas
        self.order = list(dict.fromkeys(core for core in self.cores.values() if core is not None))
        # for the core; `None` if there are no formulas to evaluate
        self.plan = TruthsPlan(spec, self.order, question.captured) if self.order else None


Plans = dict[tuple[str, ...], _Plan]
"""Plans by the texts of their formulas; only for formulas without captured values."""


class _Group:
    """Formulas that are evaluated in one run over a recording."""

    def __init__(self, spec: CheckedSpec, question: Question) -> None:
        self._spec = spec
        self._question = question
        self._formulas: dict[str, Formula] = {}
        self._plan: _Plan | None = None
        self._run: TruthsRun | None = None

    def add(self, question: Question) -> None:
        """Add the formulas of a question."""
        self._formulas.update(zip(question.texts, question.formulas, strict=True))

    def start(self, source: Trace, plans: Plans | None) -> bool:
        """Start the run; returns whether there is anything to evaluate."""
        if plans is None or self._question.for_each is not None or self._question.captured:
            plans = {}
        key = tuple(self._formulas)
        if key not in plans:
            plans[key] = _Plan(self._spec, self._question, self._formulas)
        self._plan = plans[key]
        if self._plan.plan is not None:
            self._run = TruthsRun(self._plan.plan, source)
        return self._run is not None

    def take(self, piece: Batch | Sample, samples: Sequence[Sample]) -> None:
        """Take the next piece; an instance of `for each` takes its `samples`, filtered by key."""
        if self._run is None:
            return
        each = self._question.for_each
        if each is None:
            self._run.take(piece)
            return
        for sample in _of_instance(each, self._question.captured, samples):
            self._run.take(sample)

    def truths(self, ticks: _Ticks) -> dict[str, Truth]:
        """End the run; returns the truths by text of the formula."""
        assert self._plan is not None, "it began"
        known = [] if self._run is None else self._run.known()
        truths: dict[Core | None, Truth] = {
            core: Truth(ticks.spans(one.true), ticks.spans(one.false))
            for core, one in zip(self._plan.order, known, strict=True)
        }
        if None in self._plan.cores.values():
            nowhere = np.empty((0, 2), np.int64)
            truths[None] = Truth(nowhere, nowhere)
        return {text: truths[core] for text, core in self._plan.cores.items()}


def _born(piece: Batch | Sample, valueless: Set[str]) -> set[str]:
    """The signals of `valueless` that have a value in a piece."""
    if isinstance(piece, Sample):
        values = piece.values
        return {name for name in valueless & values.keys() if not is_unknown(values[name])}
    return {name for name in valueless & piece.signals.keys() if piece.signals[name].holds_value}


def _positions(
    spec: CheckedSpec, first: int, end: int, instants: Sequence[NDArray[np.int64]]
) -> Positions:
    match spec.time:
        case TimeModel.HELD:
            return None
        case TimeModel.SAMPLED:
            return distinct(instants)
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-first // period) * period, end + 1, period)
        case _:
            assert_never(spec.time)


class _Ticks:
    """Converts ranges of positions, as the core numbers them, to sets of ticks."""

    def __init__(self, positions: Positions, first: int, end: int) -> None:
        self._positions = positions
        self._first = 0
        self._start = first
        if isinstance(positions, range):
            self._first = positions.start // positions.step
        self.end = end

    def spans(self, ranges: NDArray[np.int64]) -> NDArray[np.int64]:
        """The ticks of ranges of positions; each lasts until the tick before the next position."""
        if not len(ranges):
            return ranges
        if self._positions is not None:
            ranges = self._lasting(ranges - self._first, self._positions)
        return within(joined(ranges), self._start, self.end)

    def _lasting(
        self, ranges: NDArray[np.int64], positions: range | NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Ranges of ticks: from the first position to the tick before the one after the last."""
        ranges = ranges[(ranges[:, 1] >= 0) & (ranges[:, 0] < len(positions))]
        if not len(ranges):
            return ranges
        stops = np.minimum(ranges[:, 1], len(positions) - 1) + 1
        firsts = _at(positions, np.maximum(ranges[:, 0], 0))
        lasts = np.full(len(ranges), self.end)
        is_followed = stops < len(positions)
        lasts[is_followed] = _at(positions, stops[is_followed]) - 1
        return np.column_stack((firsts, lasts))


def _at(positions: range | NDArray[np.int64], places: NDArray[np.int64]) -> NDArray[np.int64]:
    if isinstance(positions, range):
        return positions.start + positions.step * places
    return positions[places]


def _of_instance(
    each: ForEach, captured: Mapping[str, Scalar], samples: Iterable[Sample]
) -> Iterator[Sample]:
    """The samples for one instance, without occurrences of its event that have another key.

    An occurrence with an unknown key is an unknown occurrence for every instance.
    """
    event, key_of_instance = each.value.event, captured[each.name]
    for sample in samples:
        if event not in sample.values:
            yield sample
            continue
        values: dict[str, Value] = {**sample.values}
        seen: list[Payload | None] = []
        for payload in payloads_of(values.pop(event)):
            key = None if payload is None else payload.get(each.value.field)
            if key is None or key != key:
                seen.append(None)
            elif key == key_of_instance:
                seen.append(payload)
        if seen:
            values[event] = _reported(seen)
        yield Sample(sample.t, values)


def _reported(seen: Sequence[Payload | None]) -> Value:
    """Occurrences as a value in a sample; an unknown one beside others has unknown fields."""
    if all(payload is None for payload in seen):
        return None
    return tuple({} if one is None else one for one in seen)


def subformulas(formula: Formula, depth: int) -> Iterator[tuple[int, Formula]]:
    """A formula and its subformulas with their depths; a negated atom is not split."""
    yield depth, formula
    match formula:
        case (
            Amount(of=WindowValue(value=None, operand=operand))
            | Unary(op=UnaryOp.NOT, operand=Amount(of=WindowValue(value=None, operand=operand)))
            | Unary(operand=Unary() | Binary() as operand)
        ):
            yield from subformulas(operand, depth + 1)
        case Unary(op=op, operand=operand) if op is not UnaryOp.NOT:
            yield from subformulas(operand, depth + 1)
        case Binary(left=left, right=right):
            yield from subformulas(left, depth + 1)
            yield from subformulas(right, depth + 1)
        case _:
            pass


def parts_of(requirement: Requirement, attempt: Attempt) -> Question:
    """The trigger, the consequent and all their subformulas, for an attempt."""
    wholes = (requirement.trigger, requirement.consequent)
    formulas = tuple(formula for whole in wholes for _, formula in subformulas(whole, 0))
    return Question(formulas, requirement.for_each, attempt.captured)


def truths_of_parts(
    requirement: Requirement, attempt: Attempt, seen: RecordedTruths
) -> dict[int, Truth]:
    """The truths of trigger, consequent and their subformulas, by `id()` of the formula."""
    question = parts_of(requirement, attempt)
    pairs = zip(question.formulas, seen.truths(question), strict=True)
    return {id(formula): truth for formula, truth in pairs}
