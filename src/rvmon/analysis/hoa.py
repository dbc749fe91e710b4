"""Exports the automata of requirements: in the Hanoi Omega-Automata format, as DOT, as data.

Source: Babiak et al., The Hanoi Omega-Automata Format, CAV 2015; version 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from msgspec.structs import asdict

from rvmon.analysis.graph import (
    ANY,
    Cube,
    graph_dot,
    graph_of,
    inputs_of,
    letters_of,
    proposition_texts,
)
from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.logic.automaton import FAILED, PASSED, Automaton
from rvmon.logic.reduce import refined
from rvmon.monitor.compile import CompiledRequirement
from rvmon.texts import quoted
from rvmon.verdicts import Verdict
from rvmon.version import __version__

MOST_PROPOSITIONS = 12

START = -1  # the state at the trigger, unless it equals another state
Edges = Mapping[Cube, int]  # the target of each possible letter


def hoa(compiled: CompiledRequirement, spec: CheckedSpec) -> str:
    """The minimal LTL3 monitor of a requirement, in HOA.

    A word starts at the position of the trigger. State `P` is entered as soon as every continuation
    satisfies the requirement, `F` as soon as none does; the automaton accepts the words that reach
    `P`. The targets of letters that inputs cannot cause are chosen freely, so that labels become
    short; propositions that no label needs are not listed.

    Raises:
        RvmonError: the requirement has no automaton, has clocks, or reads too many propositions.
    """
    name, automaton = compiled.requirement.id, _automaton_of(compiled)
    if automaton.clocks:
        raise RvmonError(
            f"error: {name} has windows of time, which HOA cannot express: write `--to dot` or "
            "`--to json`"
        )
    letters = letters_of(automaton.alphabet, MOST_PROPOSITIONS)
    if not letters:
        raise RvmonError(
            f"error: {name} reads more than {MOST_PROPOSITIONS} propositions: its labels would "
            "fill pages; write `--to json`"
        )
    first, later = inputs_of(compiled, spec, letters)
    # If the trigger is impossible, a word may start with any letter.
    states = _Machine(compiled, automaton, letters, later).least(first or later)
    propositions = automaton.alphabet.propositions
    shown = [(word, [*_disjoint(edges, range(len(propositions)))]) for word, edges in states]
    read = [
        place
        for place in range(len(propositions))
        if any(cube[place] != ANY for _, edges in shown for cube, _ in edges)
    ]
    texts = proposition_texts(compiled)
    names = [quoted(texts[propositions[place]]) for place in read]
    requirement = compiled.requirement
    lines = [
        "HOA: v1",
        f"name: {quoted(': '.join(filter(None, (requirement.id, requirement.text))))}",
        f'tool: "rvmon" {quoted(__version__)}',
        f"States: {len(states)}",
        "Start: 0",
        " ".join(["AP:", str(len(names)), *names]),
        "acc-name: Buchi",
        "Acceptance: 1 Inf(0)",
        "properties: trans-labels explicit-labels state-acc complete deterministic",
        "--BODY--",
    ]
    for number, (word, edges) in enumerate(shown):
        lines.append(f"State: {number} {quoted(word)}{' {0}' if word == 'P' else ''}")
        grouped: dict[int, list[str]] = {}
        for cube, target in edges:
            grouped.setdefault(target, []).append(_label([cube[place] for place in read]))
        lines += [f"[{' | '.join(labels)}] {target}" for target, labels in grouped.items()]
    return "\n".join([*lines, "--END--", ""])


class _Machine:
    """An automaton that gives the verdict `P` or `F` as soon as all continuations agree.

    Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4),
    2011, section 3.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        automaton: Automaton,
        letters: Mapping[Cube, int],
        possible: Set[Cube],
    ) -> None:
        self.automaton, self.letters = automaton, letters
        self.edges = [self._edges(index, possible) for index in range(len(automaton.locations))]
        ends = (
            compiled.forecaster.of(location.residual, (), None) for location in automaton.locations
        )
        self.verdicts = [{True: "P", False: "F", None: "?"}[end] for end in ends]
        # Impossible letters are gone, so more states are decided than the forecaster can know.
        while ahead := {at: w for at, e in enumerate(self.edges) if (w := self._implied(at, e))}:
            for index, word in ahead.items():
                self.verdicts[index] = word
        for index, word in enumerate(self.verdicts):
            # A verdict is final, so all letters lead back to the same state.
            if word != "?":
                self.edges[index] = dict.fromkeys(possible, index)

    def _edges(self, index: int, possible: Set[Cube]) -> Edges:
        if index <= PASSED:
            return dict.fromkeys(possible, index)
        automaton = self.automaton
        row = automaton.bases[index] * automaton.classes
        return {
            cube: automaton.targets[automaton.edges[row + automaton.class_of[letter]]]
            for cube, letter in self.letters.items()
            if cube in possible
        }

    def _implied(self, index: int, edges: Edges) -> str:
        """`P` or `F` if an undecided state moves to it with every letter; else ""."""
        words = {self.verdicts[target] for target in edges.values()}
        return words.pop() if self.verdicts[index] == "?" and words in ({"P"}, {"F"}) else ""

    def least(self, first: Set[Cube]) -> list[tuple[str, Edges]]:
        """The reachable states of the minimal automaton: the verdict and the edges of each.

        The state at the trigger comes first; only letters in `first` are possible there.
        """
        edges_of = self.edges
        # All edge maps have the letters in the same order, so their targets can be compared.
        blocks = refined(
            self.verdicts, lambda at, of: tuple(of[to] for to in edges_of[at].values())
        )
        initial = self.automaton.initial
        is_open = self.verdicts[initial] == "?"
        outgoing = self._edges(initial, first) if is_open else self.edges[initial]
        word = self._implied(initial, outgoing) or self.verdicts[initial]
        edges = _renamed(outgoing, blocks)
        states = {
            block: (verdict, _renamed(its, blocks))
            for block, verdict, its in zip(blocks, self.verdicts, self.edges, strict=True)
        }
        states[START] = word, edges
        order = [*dict.fromkeys(edges.values())]
        for block in order:  # the list grows during the loop
            order += [to for to in dict.fromkeys(states[block][1].values()) if to not in order]
        alike = (
            block
            for block in order
            if states[block][0] == word and edges.items() <= states[block][1].items()
        )
        entry = next(alike, START)  # an equal later state can serve as the state at the trigger
        number = {block: n for n, block in enumerate(dict.fromkeys((entry, *order)))}
        return [(states[block][0], _renamed(states[block][1], number)) for block in number]


def _renamed(edges: Edges, names: Sequence[int] | Mapping[int, int]) -> Edges:
    return {cube: names[target] for cube, target in edges.items()}


def _disjoint(edges: Edges, places: Sequence[int]) -> Iterator[tuple[Cube, int]]:
    """Conditions for the targets, exactly one of which holds for each letter.

    They are made by a split on one proposition after the other, without those that do not matter.

    Source: don't-cares of diagrams after Coudert and Madre 1990; here the first match is taken.
    """
    if len({*edges.values()}) == 1:
        yield (ANY,) * len(next(iter(edges))), next(iter(edges.values()))
        return
    place, *rest = places
    halves = [{cube: to for cube, to in edges.items() if cube[place] == one} for one in (0, 1)]
    without = [{_with(cube, place, ANY): to for cube, to in half.items()} for half in halves]
    if all(without[1].get(cube, to) == to for cube, to in without[0].items()):
        yield from _disjoint({**without[0], **without[1]}, rest)
        return
    for truth, half in enumerate(without):
        yield from ((_with(cube, place, truth), to) for cube, to in _disjoint(half, rest))


def _with(cube: Cube, place: int, truth: int) -> Cube:
    return (*cube[:place], truth, *cube[place + 1 :])


def _label(cube: Sequence[int]) -> str:
    parts = [f"{'' if truth else '!'}{at}" for at, truth in enumerate(cube) if truth != ANY]
    return "&".join(parts) or "t"


def automaton_dot(compiled: CompiledRequirement, spec: CheckedSpec) -> str:
    """The automaton of a requirement as DOT, for Graphviz."""
    graph = graph_of(compiled, _automaton_of(compiled), spec)
    return graph_dot(graph, compiled.requirement.id)


def automaton_json(compiled: CompiledRequirement, spec: CheckedSpec) -> dict[str, object]:
    """The automaton as data: locations with obligations, edges with conditions; ages in ticks."""
    requirement, automaton = compiled.requirement, _automaton_of(compiled)
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
        "edges": [*map(asdict, graph.edges)],
    }


def _automaton_of(compiled: CompiledRequirement) -> Automaton:
    if compiled.automaton is None:
        name = compiled.requirement.id
        raise RvmonError(f"error: {name} has no automaton: {compiled.refusal}")
    return compiled.automaton
