"""From the plan of requirements to the bytes that the core judges by; see native/plan/plan.md."""

from __future__ import annotations

from rvmon.core.automata import Automata
from rvmon.core.packed import Numbering, Packed, packed
from rvmon.core.part import Part
from rvmon.core.sections import Section, Sections
from rvmon.logic.plan import Plan


def pack(plan: Plan) -> Packed:
    """Pack a plan: all requirements without captured values together, each of the others apart.

    Args:
        plan: of the requirements.

    Raises:
        RvmonError: an expression is beyond the core.
    """
    sections = Sections()
    automata = Automata(sections)
    numbering = Numbering(plan.spec)
    number = {id(rule): place for place, rule in enumerate(plan.asked)}
    parts = [
        Part(sections, automata, one, numbering, [number[id(rule)] for rule in one.rules])
        for one in (plan, *plan.units)
    ]
    _subscribe(sections, plan, parts)
    sizes = (
        len(plan.signals),
        len(plan.events),
        sum(len(event.fields) for event in plan.spec.events.values()),
        len(plan.asked),
        max((len(rule.captured) for rule in plan.asked), default=0),
    )
    ids = tuple(rule.requirement.id for rule in plan.asked)
    return packed(plan.spec, ids, sections.data(plan.gap or 0, sizes))


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
