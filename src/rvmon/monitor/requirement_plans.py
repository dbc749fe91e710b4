"""Chooses how the core judges each requirement, and combines the requirements into a plan."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from functools import cache

from msgspec.structs import replace

from rvmon.language.checked.names_read import requirement_ids
from rvmon.logic.alphabet import Alphabet, alphabet_of
from rvmon.logic.automaton import Automaton
from rvmon.logic.construct import Budget, construct
from rvmon.logic.formula import Core, Factory, Literal
from rvmon.logic.network_plan import plan_of as network_of
from rvmon.logic.plan import Plan, PlannedRule, plan_in_units
from rvmon.logic.state_formula import State
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec


def planned_rule(compiled: CompiledRequirement, *, measured: bool = False) -> PlannedRule:
    """A requirement as the core judges it, with its automaton if it has one."""
    required, alphabet, automaton = compiled.obligation.required, compiled.alphabet, compiled.shaped
    # Robustness is measured from `figured` below; of these attempts, only their starts matter.
    if measured and compiled.counts_alone:
        required, alphabet, automaton = _nothing_required()
    obligation = compiled.obligation
    captures = bool(compiled.requirement.captures)

    def doubt_rule(other: CompiledRequirement | None) -> PlannedRule | None:
        return None if other is None else planned_rule(other, measured=measured)

    figured = compiled.measured_required if measured else None
    read = [] if figured is None else [core for _, core in network_of(figured, compiled.gap).leaves]
    return PlannedRule(
        compiled.requirement, obligation.trigger, required, alphabet, automaton,
        compiled.scatters(automaton), obligation.again, obligation.unborn, obligation.determined,
        hidden=doubt_rule(compiled.hidden), doubted=doubt_rule(compiled.doubted),
        noted=() if measured else tuple(leaf for leaf, _ in compiled.leaves),
        running=obligation.running if captures else None,
        blurs=_blurs(compiled) if captures else None, blurs_anywhere=obligation.doubt is not None,
        captures_known=obligation.captures_known, measured=figured,
        also_read=tuple(core.proposition for core in read if isinstance(core, Literal)),
    )  # fmt: skip


def _stepped(rule: PlannedRule) -> PlannedRule:
    hidden, doubted = (
        None if part is None else _stepped(part) for part in (rule.hidden, rule.doubted)
    )
    return replace(rule, hidden=hidden, doubted=doubted, stepped=True)


@cache
def _nothing_required() -> tuple[Core, Alphabet, Automaton]:
    """The obligation of attempts that are only counted."""
    factory = Factory()
    required = factory.constant(True)
    alphabet = alphabet_of(required)
    return required, alphabet, construct(factory.next(required), alphabet, Budget())


def _blurs(compiled: CompiledRequirement) -> State | None:
    """A state that is UNKNOWN where an attempt may have begun with other captured values."""
    obligation = compiled.obligation
    # An ordinary `upon` attempt begins at a single, certain position.
    return obligation.doubt or (None if compiled.ordinary is None else obligation.trigger)


def plan_alone(
    compiled: CompiledSpec,
    only: Iterable[str] | None = None,
    *,
    traced: Collection[str] = (),
    stepped: bool = False,
    measured: bool = False,
) -> Plan:
    """The plan for a run of the core.

    `traced` and `measured` are those of `planned_core`. `stepped`: use no chains, so that each
    attempt is stepped on its own.

    Raises:
        UnknownNameError: there is no such requirement.
        RvmonError: a requirement exceeds the limits of the core; the message says which and why.
    """
    ids = requirement_ids(compiled.checked, only)
    rules = []
    for one in compiled.chosen(ids):
        if one.requirement.id in traced:  # uses the automaton shown to users: its edges are counted
            rule = replace(planned_rule(one), automaton=one.automaton, stepped=True, traced=True)
        else:
            rule = planned_rule(one, measured=measured)
        rules.append(rule)
    if stepped:
        rules = [_stepped(rule) for rule in rules]
    return plan_in_units(compiled.checked, rules)
