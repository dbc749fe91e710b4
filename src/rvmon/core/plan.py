"""From the plan of requirements to the bytes that the core judges by; see plan.md."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.core.automata import Automata
from rvmon.core.part import Part
from rvmon.core.programs import Numbering
from rvmon.core.sections import Section, Sections
from rvmon.errors import RvmonError
from rvmon.plan.plan import Plan
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Packed:
    """A plan as bytes, and what its numbers stand for.

    Attributes:
        data: the bytes.
        signals: by name, what values they take; in the order of their numbers.
        events: their names; their numbers are those behind the signals.
        fields: by event and name, what values they take; in the order of their numbers.
        labels: by label, the number that it is given to the core as.
        ids: of the requirements, by number.
    """

    data: bytes
    signals: Mapping[str, Kind]
    events: tuple[str, ...]
    fields: Mapping[tuple[str, str], Kind]
    labels: Mapping[str, int]
    ids: tuple[str, ...]


def pack(plan: Plan, *, next_law: bool = False) -> Packed:
    """Pack a plan: all requirements without captured values together, each of the others apart.

    Args:
        plan: of the requirements.
        next_law: whether they are judged by the law to come.

    Raises:
        RvmonError: there is no requirement, or an expression is beyond the core.
    """
    if not plan.asked:
        raise RvmonError("the specification has no requirements: there is nothing to compile")
    sections = Sections()
    automata = Automata(sections)
    numbering = Numbering(plan.spec)
    number = {id(rule): place for place, rule in enumerate(plan.asked)}
    parts = [
        Part(sections, automata, one, numbering, [number[id(rule)] for rule in one.rules])
        for one in (plan, *plan.units)
    ]
    _subscribe(sections, plan, parts)
    fields = _fields(plan)
    sizes = (
        len(plan.signals),
        len(plan.events),
        len(fields),
        len(plan.asked),
        max(len(rule.captured) for rule in plan.asked),
    )
    return Packed(
        sections.data(plan.gap or 0, sizes, next_law=next_law),
        {name: signal.type.kind for name, signal in plan.spec.signals.items()},
        plan.events,
        fields,
        numbering.labels,
        tuple(rule.requirement.id for rule in plan.asked),
    )


def _fields(plan: Plan) -> dict[tuple[str, str], Kind]:
    """All fields of all events, with what values they take."""
    return {
        (name, field): type_.kind
        for name, event in plan.spec.events.items()
        for field, type_ in event.fields.items()
    }


def _subscribe(sections: Sections, plan: Plan, parts: list[Part]) -> None:
    """Say of each name which parts read it, and of each event which fields it has."""
    first = 0
    sections.add(Section.FIELD_FIRST, first)
    for event in plan.spec.events.values():
        first += len(event.fields)
        sections.add(Section.FIELD_FIRST, first)
    sections.add(Section.SUBSCRIPTION_FIRST, 0)
    names = [(name, [part.names.signals for part in parts]) for name in plan.signals]
    names += [(name, [part.names.events for part in parts]) for name in plan.events]
    for name, numbers in names:
        for part, local in enumerate(numbers):
            if name in local:
                sections.add(Section.SUBSCRIPTIONS, part, local[name])
        sections.add(Section.SUBSCRIPTION_FIRST, sections.count(Section.SUBSCRIPTIONS))
