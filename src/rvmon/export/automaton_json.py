"""The automaton of a requirement as JSON."""

from __future__ import annotations

from rvmon.automaton.location import FAILED, PASSED
from rvmon.errors import RvmonError
from rvmon.explain.graph import graph_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.verdict import Verdict


def automaton_json(compiled: CompiledRequirement, spec: CheckedSpec) -> dict[str, object]:
    """Locations with what is owed there, edges with their conditions; ages in ticks.

    Raises:
        RvmonError: it has no automaton.
    """
    requirement, automaton = compiled.requirement, compiled.automaton
    if automaton is None:
        raise RvmonError(f"error: {requirement.id} has no automaton: {compiled.refusal}")
    graph = graph_of(compiled, automaton, spec)
    locations = [
        {
            "name": place.name,
            "owed": place.owed,
            "clock_cuts_ns": automaton.locations[place.location].cuts,
            "verdict": {FAILED: Verdict.FAIL, PASSED: Verdict.PASS}.get(place.location),
        }
        for place in graph.places
    ]
    return {
        "requirement": requirement.id,
        "text": requirement.text,
        "locations": locations,
        "edges": [
            {
                "source": edge.source,
                "target": edge.target,
                "condition": edge.condition,
                "ages": edge.when,
                "sets": edge.sets,
            }
            for edge in graph.edges
        ],
    }
