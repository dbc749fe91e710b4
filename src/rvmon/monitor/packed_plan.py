"""Packed plans, with the tables for reading samples and decoding attempts."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from msgspec import Struct

from rvmon import native
from rvmon.core.sections import packed
from rvmon.errors import TraceError
from rvmon.language.checked.specification import CheckedSpec, Type
from rvmon.monitor.compiled_spec import Kept, Place
from rvmon.trace.sample import Payload, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.trace.time import format_ticks
from rvmon.verdicts.attempt import DECISIONS, VERDICTS, Attempt

if TYPE_CHECKING:
    from rvmon.core.sections import Packed
    from rvmon.logic.plan import Plan
    from rvmon.monitor.compile import CompiledRequirement
    from rvmon.monitor.compiled_spec import CompiledSpec
    from rvmon.monitor.notes import Note, NotesReader


class CapturedValues:
    """Decodes the captured values of attempts."""

    def __init__(self, spec: CheckedSpec, ids: Sequence[str], labels: Mapping[str, int]) -> None:
        # per requirement, by name the kind of each captured value; `None` for a number, which
        # carries its own kind
        self._kinds = [
            {name: spec.kind_of(value, one) for name, value in one.captured.items()}
            for one in map(spec.requirements.__getitem__, ids)
        ]
        self._labels = {number: label for label, number in labels.items()}

    def of(self, requirement: int, numbers: Sequence[float | None]) -> dict[str, Scalar]:
        """The captured values of an attempt by name; `None` is unknown. Surplus ones are ignored.

        `requirement` is its number.
        """
        kinds = self._kinds[requirement].items()
        return {
            name: self._value(number, kind)
            for (name, kind), number in zip(kinds, numbers, strict=False)
        }

    def _value(self, number: float | None, kind: Kind | None) -> Scalar:
        if number is None:
            return None
        if kind is Kind.BOOL:
            return bool(number)
        return self._labels[int(number)] if kind is Kind.LABEL else number


_KINDS = (Kind.BOOL, Kind.INT, Kind.REAL, Kind.LABEL)  # kinds by their numbers in `module_intake.h`

Noted = tuple[Sequence[float | None] | None, bytes, bytes | None, Any, bytes | None]
"""The data an attempt keeps for its details: captured values, note, truth values at the decision,
the letters but for their last piece, and that piece; see `module_notes.h`."""


class PlannedCore(Struct, frozen=True):
    """A packed plan, from which runs of the core are made."""

    packed: Packed  # the plan as bytes, with the names of its numbers
    captured: CapturedValues
    numbers: dict[str, int]  # by name, its number: signals first, then events
    # per signal, event and field: for a label type the number of each label, for an event the
    # number of each field, else `None`
    words: tuple[Mapping[str, int] | None, ...]
    kinds: bytes  # per signal, event and field, the kind of its values; meaningless for events
    # a byte per signal and event: for an event, whether only one payload of it can be judged at one
    # instant; for a signal, whether an unknown value is no update
    limits: bytes
    # the events of which only one payload can be judged at one instant
    single_payloads: frozenset[str]
    # by signal and event, the ids of the requirements that read it
    readers: Mapping[str, tuple[str, ...]]
    # the specification, to explain attempts; `None` for a plan without requirements
    compiled: CompiledSpec | None

    @property
    def _specification(self) -> CompiledSpec:
        if self.compiled is None:
            raise ValueError("a plan without requirements has no attempts")
        return self.compiled

    def monitor(
        self,
        absent: frozenset[str],
        slow_step: Callable[[float, Mapping[str, Any]], Sequence[Any]] | None = None,
        slow_step_ns: Callable[[int, Mapping[str, Any]], Sequence[Any]] | None = None,
        many: Callable[[Any], Sequence[Attempt]] | None = None,
    ) -> native.Monitor:
        """Start a run.

        Args:
            absent: the names without a source.
            slow_step: takes samples, stamped in seconds, that are not a `dict` of plain values.
            slow_step_ns: the same for stamps in ticks.
            many: makes a lazy sequence from raw records, if thousands are decided at once; see
                `rvmon.monitor.records.recorded`.
        """
        coming, is_absent = self.numbers, bytes(len(self.numbers))
        if absent:
            coming = {name: number for name, number in coming.items() if name not in absent}
            is_absent = bytes(name in absent for name in self.numbers)
        attempts = (Attempt, self.packed.ids, VERDICTS, DECISIONS, self._details, many)
        return native.Monitor(
            self.packed.data, (coming, self.words, self.kinds, self.limits), is_absent,
            (slow_step, slow_step_ns), attempts,
        )  # fmt: skip

    def plain(self, t: int, values: Mapping[str, Value]) -> dict[str, Value]:
        """A validated sample in the types that the core takes.

        Raises:
            TraceError: a whole number is too large.
        """
        # The core accepts only exact `str`, no subclasses such as members of an enumeration.
        return {str.__str__(name): self._plain(name, value, t) for name, value in values.items()}

    def _plain(self, name: str, value: Value, t: int) -> Value:
        if isinstance(value, tuple):
            return tuple(self._payload(name, payload, t) for payload in value)
        if isinstance(value, Mapping):
            return self._payload(name, value, t)
        kind = self.packed.signals.get(name)
        return value if kind is None else _number(name, value, kind, t)

    def _payload(self, event: str, payload: Payload, t: int) -> Payload:
        kinds = self.packed.fields
        return {
            str.__str__(field): _number(f"{event}.{field}", value, kinds[event, field], t)
            for field, value in payload.items()
        }

    def instance(self, attempt: Attempt) -> object:
        """A key of the instance an attempt belongs to; with `let`, each attempt is an instance."""
        requirement = self._specification.checked.requirements[attempt.requirement]
        if requirement.captures:
            return attempt.requirement, attempt.in_doubt, attempt.number
        each = None if requirement.for_each is None else attempt.captured[requirement.for_each.name]
        return attempt.requirement, attempt.in_doubt, each

    def _details(self, attempt: Attempt, noted: Noted, name: str) -> Mapping[str, Any]:
        """See `details`; called from C."""
        captured, *parts = noted

        def note() -> Note:
            from rvmon.monitor.notes import note_of

            return note_of(*parts)

        return self.details(attempt, captured, note, name)

    def details(
        self,
        attempt: Attempt,
        captured: Sequence[float | None] | None,
        note: Callable[[], Note],
        name: str,
    ) -> Mapping[str, Any]:
        """The lazily computed field `name` of an attempt, and others that come with it.

        `note` returns the core's note about the attempt.
        """
        number = self.packed.numbers[attempt.requirement]
        values = {} if captured is None else self.captured.of(number, captured)
        if name == "captured":
            return {"captured": values}
        details = self._reader.details(attempt, note(), name)
        details.update(captured=values, robustness=None, _noted=None)
        return details

    @property
    def _reader(self) -> NotesReader:
        """Explains attempts by their notes."""
        compiled = self._specification
        key = "notes reader", self.packed.data  # not the ids: bytes cache their hash, tuples do not
        reader = compiled.forms.get(key)
        if reader is None:
            # Imported on use: most attempts are never explained.
            from rvmon.monitor.notes import NotesReader

            reader = compiled.forms[key] = NotesReader(compiled, self.packed.ids)
        return cast("NotesReader", reader)


def planned_core(
    compiled: CompiledSpec,
    only: Collection[str] | None = None,
    *,
    traced: Collection[str] = (),
    measured: bool = False,
) -> PlannedCore:
    """The packed plan of some requirements; made once per specification and options.

    `traced` are the ids of those whose paths through their automata are recorded, for coverage;
    `measured`: whether it measures robustness.

    Raises:
        RvmonError: a requirement exceeds the limits of the core.
    """
    spec = compiled.checked
    ids = tuple(
        requirement for requirement in spec.requirements if only is None or requirement in only
    )
    how = ids, tuple(id_ for id_ in ids if id_ in traced), measured
    key = "core", *how
    planned = compiled.forms.get(key)
    if not isinstance(planned, PlannedCore):
        place = Place(compiled, *how) if compiled.is_kept else None
        planned = None if place is None else _checked(compiled, ids, place.read())
        if planned is None:
            # Imported on use: with a cached plan the compiler is not needed.
            from rvmon.monitor.requirement_plans import plan_alone

            plan = plan_alone(compiled, ids, traced=how[1], measured=measured)
            kept = kept_of(plan, compiled.chosen(ids))
            planned = planned_as(spec, ids, kept, compiled)
            if place is not None:
                place.write(kept)
        compiled.forms[key] = planned
    return planned


def kept_of(plan: Plan, chosen: Sequence[CompiledRequirement]) -> Kept:
    """Pack a plan; `chosen` are its requirements."""
    from rvmon.core.pack import pack

    single = frozenset().union(*(compiled.single_payloads for compiled in chosen))
    readers: dict[str, tuple[str, ...]] = {}
    for compiled in chosen:
        for name in compiled.reads:
            readers[name] = (*readers.get(name, ()), compiled.requirement.id)
    return Kept(pack(plan).data, single, readers)


def _checked(
    compiled: CompiledSpec, ids: tuple[str, ...], before: Kept | None
) -> PlannedCore | None:
    """A plan from the cache; `None` if there is none or the core refuses it."""
    if before is None:
        return None
    # The core checks the bounds and the hash of a plan when it loads it, so a damaged entry is
    # refused here and made again.
    planned = planned_as(compiled.checked, ids, before, compiled)
    try:
        planned.monitor(frozenset())
    except ValueError:
        return None
    return planned


def planned_as(
    spec: CheckedSpec, ids: tuple[str, ...], kept: Kept, compiled: CompiledSpec | None = None
) -> PlannedCore:
    """A packed plan, with the tables that follow from its specification."""
    plan = packed(spec, ids, kept.data)

    def labels(type_: Type) -> Mapping[str, int] | None:
        if type_.kind is not Kind.LABEL:
            return None
        return {label: plan.labels[label] for label in type_.labels}

    names = (*plan.signals, *plan.events)
    ignoring = spec.ignoring
    payloads = [spec.events[name].fields for name in plan.events]
    types = [type_ for payload in payloads for type_ in payload.values()]
    kinds = [*plan.signals.values(), *(Kind.BOOL for _ in payloads), *plan.fields.values()]
    return PlannedCore(
        plan,
        CapturedValues(spec, ids, plan.labels),
        {name: number for number, name in enumerate(names)},
        (
            *(labels(spec.signals[name].type) for name in plan.signals),
            *({field: place for place, field in enumerate(payload)} for payload in payloads),
            *map(labels, types),
        ),
        bytes(map(_KINDS.index, kinds)),
        # One byte serves both: events are never `ignoring`, signals never `single`.
        bytes(name in kept.single or name in ignoring for name in names),
        kept.single,
        kept.readers,
        compiled,
    )


_LEAST, _MOST = -(1 << 63), (1 << 63) - 1


def _number(name: str, value: Scalar, kind: Kind, t: int) -> Scalar:
    """A value as the core takes it: integers of 64 bits; for `real`, larger ones as doubles.

    Raises:
        TraceError: the value has no such representation.
    """
    if not isinstance(value, int) or _LEAST <= value <= _MOST:
        return value
    try:
        if kind is Kind.REAL:
            return float(value)
    except OverflowError:
        pass
    limit = "a double" if kind is Kind.REAL else "64 bits"
    raise TraceError(f"sample at {format_ticks(t)}: `{name}` is a number too large for {limit}")
