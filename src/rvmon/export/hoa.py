"""Untimed requirements as automata in the Hanoi Omega-Automata format.

Source: Babiak et al., The Hanoi Omega-Automata Format, CAV 2015; version 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rvmon import __version__
from rvmon.analysis.graph import graph_of, proposition_texts, quoted
from rvmon.errors import RvmonError
from rvmon.logic.automaton import FAILED, PASSED, Automaton
from rvmon.logic.forecast import ltl3_monitor
from rvmon.logic.state_formula import FALSE, TRUE
from rvmon.monitor.compile import CompiledRequirement
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.verdict import Verdict

MOST_PROPOSITIONS = 12

Cube = tuple[bool | None, ...]
"""Per proposition whether it has to be true; `None`: no matter."""


def hoa(compiled: CompiledRequirement) -> str:
    """The least LTL3 monitor of a requirement.

    A word begins at the position of the trigger. State `P` is entered when every continuation
    fulfils what is owed, `F` when none does; the automaton accepts the words that come to `P`.

    Args:
        compiled: a requirement without windows of time.

    Raises:
        RvmonError: it has windows, no automaton, or too many propositions.
    """
    name, automaton = compiled.requirement.id, compiled.automaton
    if automaton is None:
        raise RvmonError(f"error: {name} has no automaton: {compiled.refusal}")
    if automaton.clocks:
        raise RvmonError(
            f"error: {name} has windows of time, which HOA cannot express: write `--to dot` or "
            "`--to json`"
        )
    if len(automaton.alphabet.propositions) > MOST_PROPOSITIONS:
        raise RvmonError(
            f"error: {name} reads more than {MOST_PROPOSITIONS} propositions: its labels would "
            "fill pages; write `--to json`"
        )
    return _Writer(compiled, ltl3_monitor(automaton, compiled.forecaster)).text()


class _Writer:
    def __init__(self, compiled: CompiledRequirement, automaton: Automaton) -> None:
        self.compiled = compiled
        self.automaton = automaton
        self.letters = automaton.alphabet.pessimistic
        self.order = [automaton.initial]
        for state in self.order:  # it grows on the way
            found = dict.fromkeys(target for target, _ in self.edges(state))
            self.order += [target for target in found if target not in self.order]

    def text(self) -> str:
        texts = proposition_texts(self.compiled)
        names = [quoted(texts[state]) for state in self.automaton.alphabet.propositions]
        requirement = self.compiled.requirement
        number = {state: place for place, state in enumerate(self.order)}
        lines = [
            "HOA: v1",
            f"name: {quoted(': '.join(filter(None, (requirement.id, requirement.text))))}",
            f'tool: "rvmon" {quoted(__version__)}',
            f"States: {len(self.order)}",
            "Start: 0",
            " ".join(["AP:", str(len(names)), *names]),
            "acc-name: Buchi",
            "Acceptance: 1 Inf(0)",
            "properties: trans-labels explicit-labels state-acc complete deterministic",
            "--BODY--",
        ]
        for state in self.order:
            word = {FAILED: ' "F"', PASSED: ' "P" {0}'}.get(state, ' "?"')
            lines.append(f"State: {number[state]}{word}")
            grouped: dict[int, list[Cube]] = {}
            for target, cube in self.edges(state):
                grouped.setdefault(target, []).append(cube)
            lines += [f"[{_label(cubes)}] {number[to]}" for to, cubes in grouped.items()]
        return "\n".join([*lines, "--END--", ""])

    def edges(self, state: int) -> Iterator[tuple[int, Cube]]:
        """The targets of a state, each with disjoint conditions."""
        if state <= PASSED:
            yield state, (None,) * len(self.letters)
            return
        yield from self._below(state, len(self.letters) - 1, 0)

    def _below(self, state: int, place: int, letter: int) -> Sequence[tuple[int, Cube]]:
        """The same for letters of which the propositions behind `place` are settled."""
        if place < 0:
            automaton = self.automaton
            row = automaton.bases[state] * automaton.classes
            edge = automaton.edges[row + automaton.class_of[letter]]
            return [(automaton.targets[edge], ())]
        weights = self.letters[place]
        lacking = self._below(state, place - 1, letter + weights[FALSE])
        having = self._below(state, place - 1, letter + weights[TRUE])
        if lacking == having:
            return [(target, (*cube, None)) for target, cube in lacking]
        return [
            *((target, (*cube, False)) for target, cube in lacking),
            *((target, (*cube, True)) for target, cube in having),
        ]


def _label(cubes: Sequence[Cube]) -> str:
    return " | ".join(_conjunction(cube) for cube in cubes)


def _conjunction(cube: Cube) -> str:
    parts = [
        str(place) if wanted else f"!{place}"
        for place, wanted in enumerate(cube)
        if wanted is not None
    ]
    return "&".join(parts) or "t"


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
            "required": place.required,
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
