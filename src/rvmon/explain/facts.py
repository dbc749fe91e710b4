"""What judging a requirement takes: its automaton, size, horizon, memory."""

from __future__ import annotations

from rvmon.automaton.automaton import Automaton
from rvmon.formula.horizon import horizon
from rvmon.formula.state import StateOp
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.graph import graph_of
from rvmon.spec.print.printer import format_duration

Facts = dict[str, str]


def facts_of(compiled: CompiledRequirement) -> Facts:
    """By heading, one line each."""
    automaton = compiled.automaton
    facts = {
        "judged by": _judge(compiled, automaton),
        "decided": _decided(compiled),
        "memory": _memory(compiled, automaton),
    }
    one = compiled.requirement
    facts |= {"looks back": _past(compiled), "source": one.source, "rationale": one.rationale}
    facts |= {"severity": one.severity, "tags": ", ".join(one.tags)}
    return {heading: fact for heading, fact in facts.items() if fact}


def _judge(compiled: CompiledRequirement, automaton: Automaton | None) -> str:
    if automaton is None:
        return f"delay network: as an automaton it would have {compiled.refusal}"
    clocks = automaton.clocks
    return (
        f"automaton of {_counted(len(automaton.locations), 'location')}, "
        f"{_counted(clocks, 'clock')}, {_counted(automaton.classes, 'class', 'classes')} of inputs"
    )


def _decided(compiled: CompiledRequirement) -> str:
    reach = horizon(compiled.obligation.owed)
    if reach is None:
        return "no bound: it may stay open until the recording ends"
    return f"{format_duration(reach)} after its trigger at the latest" if reach else "at once"


def _memory(compiled: CompiledRequirement, automaton: Automaton | None) -> str:
    if automaton is None:
        reach = horizon(compiled.obligation.owed)
        span = "while an attempt is open" if reach is None else f"over {format_duration(reach)}"
        return f"where its parts are known to hold or not, a stretch per change, {span}"
    stamps = f", {_counted(automaton.clocks, 'time stamp')}" if automaton.clocks else ""
    return f"per open attempt its location{stamps}"


def _past(compiled: CompiledRequirement) -> str:
    """How far its past operators look."""
    trigger = compiled.obligation.trigger
    states = [*compiled.alphabet.propositions, *([] if trigger is None else [trigger])]
    nodes = graph_of(states).nodes
    since = [node for node in nodes if node.op is StateOp.SINCE]
    if not since:
        steps = any(node.op is StateOp.PREVIOUS for node in nodes)
        return "to the position before" if steps else ""
    bounds = [node.high for node in since if node.high is not None]
    if len(bounds) < len(since):
        return "over all that was"
    return f"over the last {format_duration(sum(bounds) if len(bounds) > 1 else bounds[0])} at most"


def _counted(count: int, noun: str, plural: str = "") -> str:
    return f"{count} {noun if count == 1 else plural or noun + 's'}"
