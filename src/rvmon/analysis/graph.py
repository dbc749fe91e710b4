"""Turns an automaton into a readable graph: places, and edges with conditions in words."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from itertools import product
from math import prod

from msgspec import Struct

from rvmon.analysis.combinations import combinations_of
from rvmon.language.checked.formula import Binary, BinaryOp, Constant
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.language.print import format_duration, format_formula
from rvmon.logic.alphabet import Alphabet
from rvmon.logic.automaton import FAILED, NOW, PASSED, Automaton, row_of
from rvmon.logic.formula import Core, Literal, Sense
from rvmon.logic.state_formula import FALSE, TRUE, Shown, State
from rvmon.monitor.compile import CompiledRequirement
from rvmon.texts import quoted

Cube = tuple[int, ...]  # a partial valuation: per proposition 1, 0 or `ANY`

ANY = -1


def cubes_of(vectors: Iterable[Cube], never: Collection[Cube] = ()) -> tuple[Cube, ...]:
    """Prime cubes that cover the vectors; those in `never` do not occur and may be covered or not.

    Source: Quine 1952, McCluskey 1956; the choice of primes is greedy.

    >>> cubes_of([(0, 0), (0, 1), (1, 1)])
    ((0, -1), (-1, 1))
    """
    wanted = set(vectors)
    primes = _primes(wanted | {*never})
    missing = set(wanted)
    chosen: list[Cube] = []
    while missing:
        best = max(primes, key=lambda cube: (sum(_covers(cube, one) for one in missing), cube))
        chosen.append(best)
        missing = {one for one in missing if not _covers(best, one)}
    return tuple(sorted(chosen, key=lambda cube: (cube.count(ANY), cube[::-1])))


def _primes(vectors: set[Cube]) -> list[Cube]:
    primes: list[Cube] = []
    level = set(vectors)
    # Each round merges cubes that differ in one literal; those that merge with none are prime.
    while level:
        merged: set[Cube] = set()
        used: set[Cube] = set()
        for cube in level:
            for place, truth in enumerate(cube):
                other = (*cube[:place], 1 - truth, *cube[place + 1 :])
                if truth != ANY and other in level:
                    merged.add((*cube[:place], ANY, *cube[place + 1 :]))
                    used |= {cube, other}
        primes += sorted(level - used)
        level = merged
    return primes


def _covers(cube: Cube, vector: Cube) -> bool:
    return all(literal in (ANY, truth) for literal, truth in zip(cube, vector, strict=True))


MOST_PROPOSITIONS = 8
"""The most propositions for which conditions are spelled out; of more, cases are counted."""

CLOCKS = "xyzuvwabcd"


class Place(Struct, frozen=True):
    """A location."""

    name: str  # `start`, `A`, `B`, …, `P` or `F`
    required: str  # the residual in words; "" for `P` and `F`
    location: int  # its index in the automaton


class Edge(Struct, frozen=True):
    """An edge."""

    source: str  # name of its source place
    target: str  # name of its target place
    condition: str  # the condition on the input; "" if there is none
    ages: str  # the guard on the clocks; "" if there is none
    sets: str  # the clocks that are started or renamed, as text


class Graph(Struct, frozen=True):
    """An automaton to be drawn; the first place is where an attempt starts."""

    places: tuple[Place, ...]
    edges: tuple[Edge, ...]


def graph_of(compiled: CompiledRequirement, automaton: Automaton, spec: CheckedSpec) -> Graph:
    """The graph of an automaton.

    Letters with unknown propositions, and impossible combinations, are left out.
    """
    names = _names(automaton)
    places = tuple(
        Place(names[index], _required(compiled, automaton, index), index)
        for index in sorted(names, key=lambda index: (index <= PASSED, index != automaton.initial))
    )
    reader = _Reader(compiled, automaton, spec)
    edges = [
        Edge(names[index], names[target], condition, when, sets)
        for index in range(PASSED + 1, len(automaton.locations))
        for target, condition, when, sets in reader.edges(index)
    ]
    return Graph(places, tuple(edges))


def _names(automaton: Automaton) -> dict[int, str]:
    names = {FAILED: "F", PASSED: "P", automaton.initial: "start"}
    letters = [chr(code) for code in range(ord("A"), ord("Z") + 1) if chr(code) not in "FP"]
    rest = [index for index in range(len(automaton.locations)) if index not in names]
    for number, index in enumerate(rest):
        names[index] = letters[number] if number < len(letters) else f"L{index}"
    return names


def _required(compiled: CompiledRequirement, automaton: Automaton, index: int) -> str:
    location = automaton.locations[index]
    if index <= PASSED:
        return ""
    if index == automaton.initial:
        return "the trigger"
    clauses = []
    in_order = sorted(
        sorted((clock, node.id, node) for node, clock in c) for c in location.residual
    )
    for ordered in in_order:
        texts = [_obligation(compiled, node) for _, _, node in ordered]
        clauses.append(" and ".join(dict.fromkeys(texts)))
    return ", or ".join(dict.fromkeys(clauses))


def _obligation(compiled: CompiledRequirement, node: Core) -> str:
    requirement = compiled.requirement
    if requirement.mode is not Mode.WHENEVER or node is not compiled.obligation.required:
        return compiled.words.text(node)
    required = format_formula(requirement.consequent)
    if always(requirement):
        return f"always {required if ' ' not in required else f'({required})'}"
    return f"{required}, as long as {format_formula(requirement.trigger)}"


def always(requirement: Requirement) -> bool:
    """Whether the consequent is required at every instant."""
    return isinstance(requirement.trigger, Constant) and requirement.trigger.value


class _Reader:
    """Puts the edges of an automaton into words."""

    def __init__(
        self, compiled: CompiledRequirement, automaton: Automaton, spec: CheckedSpec
    ) -> None:
        self.automaton = automaton
        self.texts = proposition_texts(compiled)
        self.propositions = automaton.alphabet.propositions
        self.letters = letters_of(automaton.alphabet, MOST_PROPOSITIONS)
        self.first, self.later = inputs_of(compiled, spec, self.letters)

    def edges(self, index: int) -> Iterator[tuple[int, str, str, str]]:
        """The edges of a location: target, condition on the input, guard, and clock assignments."""
        automaton = self.automaton
        cuts = automaton.locations[index].cuts
        possible = self.first if index == automaton.initial else self.later
        never = self.letters.keys() - possible
        rows_of: dict[tuple[int, tuple[int, ...], tuple[Cube, ...]], list[tuple[int, ...]]] = {}
        for regions in product(*(range(len(clock_cuts) + 1) for clock_cuts in cuts)):
            row = row_of(automaton, index, regions)
            groups: dict[tuple[int, tuple[int, ...]], list[Cube]] = {}
            for cube in sorted(possible, reverse=True):
                letter = self.letters[cube]
                edge = automaton.edges[row * automaton.classes + automaton.class_of[letter]]
                if edge >= 0:
                    key = (automaton.targets[edge], automaton.sources[edge])
                    groups.setdefault(key, []).append(cube)
            for (target, sources), letters in groups.items():
                edge_key = target, sources, cubes_of(letters, never)
                rows_of.setdefault(edge_key, []).append(regions)
        for (target, sources, cubes), rows in rows_of.items():
            yield target, self._condition(cubes), _when(rows, cuts), _sets(sources)

    def _condition(self, cubes: Sequence[Cube]) -> str:
        if len(self.propositions) > MOST_PROPOSITIONS:
            return f"for {len(cubes)} combinations of inputs"
        texts = [self._cube(cube) for cube in cubes]
        return " or ".join(texts) if all(texts) else ""

    def _cube(self, cube: Cube) -> str:
        parts = [
            self.texts[state] if truth == 1 else _negated(self.texts[state])
            for state, truth in zip(self.propositions, cube, strict=True)
            if truth != ANY
        ]
        return " and ".join(parts if len(parts) == 1 else map(_bracketed, parts))


def letters_of(alphabet: Alphabet, most: int) -> Mapping[Cube, int]:
    """The letters without unknowns, by valuation; empty for more than `most` propositions."""
    if len(alphabet.propositions) > most:
        return {}
    digits = [(weights[FALSE], weights[TRUE]) for weights in alphabet.pessimistic]
    return {
        truths: sum(weights[truth] for weights, truth in zip(digits, truths, strict=True))
        for truths in product((1, 0), repeat=len(digits))
    }


def inputs_of(
    compiled: CompiledRequirement, spec: CheckedSpec, letters: Mapping[Cube, int]
) -> tuple[Set[Cube], Set[Cube]]:
    """The possible valuations among `letters`: at the trigger, and at any position."""
    trigger, width = compiled.obligation.trigger, len(compiled.alphabet.propositions)
    states = [*compiled.alphabet.propositions, *([] if trigger is None else [trigger])]
    vectors = combinations_of(spec, states)
    if vectors is None:
        return letters.keys(), letters.keys()
    starting = {vector for vector in vectors if len(vector) == width or vector[-1]}
    first, later = (
        {tuple(map(int, v[:width])) for v in valuations} for valuations in (starting, vectors)
    )
    return first & letters.keys(), later & letters.keys()


def proposition_texts(compiled: CompiledRequirement) -> dict[State, str]:
    """The text of each proposition in the language."""
    texts: dict[State, str] = {}
    requirement = compiled.requirement
    for node, origin in compiled.obligation.origins.items():
        if isinstance(node, Literal):
            negative = origin.positive is (node.sense is not Sense.TRUE)
            formula = origin.formula
            episode = requirement.mode is Mode.WHENEVER and not always(requirement)
            if formula is requirement.consequent and episode:
                # An episode requires the whole implication at each of its positions.
                formula = Binary(BinaryOp.IMPLIES, requirement.trigger, formula)
            text = format_formula(formula)
            texts.setdefault(node.proposition, _negated(text) if negative else text)
    for number, state in enumerate(compiled.alphabet.propositions, 1):
        if isinstance(state.leaf, Shown):
            texts[state] = format_formula(state.leaf)
        texts.setdefault(state, f"proposition {number}")
    return texts


def _bracketed(text: str) -> str:
    """An operand of a conjunction, in brackets if it contains a connective."""
    loose = any(f" {word} " in text for word in ("or", "and", "->", "<->", "xor"))
    return f"({text})" if loose and not text.startswith(("not (", "(")) else text


def _negated(text: str) -> str:
    plain = " " not in text or (text.endswith(")") and text.count("(") == 1 and " " not in text[:2])
    if text.startswith("not "):
        return text.removeprefix("not ").strip("()")
    return f"not {text}" if plain else f"not ({text})"


def _when(rows: Sequence[tuple[int, ...]], cuts: tuple[tuple[int, ...], ...]) -> str:
    """The guard of some rows: one conjunction if they form a box, else one per row."""
    spans = [sorted({row[clock] for row in rows}) for clock in range(len(cuts))]
    is_box = prod(map(len, spans)) == len(rows)
    boxes = [spans] if is_box else [[[region] for region in row] for row in rows]
    texts = [" and ".join(filter(None, map(_between, CLOCKS, box, cuts))) for box in boxes]
    return " or ".join(filter(None, dict.fromkeys(texts)))


def _between(clock: str, span: Sequence[int], cuts: tuple[int, ...]) -> str:
    """The guard on one clock for a span of its regions."""
    low = cuts[span[0] - 1] if span[0] else None
    high = cuts[span[-1]] - 1 if span[-1] < len(cuts) else None
    bounds = [] if low is None else [_least(clock, low)]
    bounds += [] if high is None else [f"{clock} ≤ {format_duration(high)}"]
    return ", ".join(bounds)


def _least(clock: str, low: int) -> str:
    """The guard for ages from `low` on; a tick above a round duration is written as `>` of it."""
    if len(format_duration(low - 1)) < len(format_duration(low)):
        return f"{clock} > {format_duration(low - 1)}"
    return f"{clock} ≥ {format_duration(low)}"


def _sets(sources: tuple[int, ...]) -> str:
    parts = []
    for clock, source in zip(CLOCKS, sources, strict=False):
        if source == NOW:
            parts.append(f"{clock} := 0")
        elif CLOCKS[source] != clock:
            parts.append(f"{clock} := {CLOCKS[source]}")
    return ", ".join(parts)


WIDTH = 80
ENDS = {"P": "✓ P", "F": "✗ F"}


def graph_lines(graph: Graph) -> list[str]:
    """The graph as lines of text: each place with its residual, and below it its edges."""
    lines: list[str] = []
    for place in graph.places:
        edges = [edge for edge in graph.edges if edge.source == place.name]
        if edges:
            lines += [*_heading(place), *_steps(edges)]
    return lines


def _heading(place: Place) -> list[str]:
    if place.name == "start":
        return ["  start, at the trigger"]
    text = f"required: {place.required}"
    return textwrap.wrap(text, WIDTH, initial_indent=f"  {place.name}  ", subsequent_indent=" " * 6)


def _steps(edges: list[Edge]) -> Iterator[str]:
    for index, edge in enumerate(edges):
        last = index == len(edges) - 1
        target = ENDS.get(edge.target, edge.target)
        text = f"{label_of(edge)} ─▶ {target}" + (f"   ({edge.sets})" if edge.sets else "")
        yield from textwrap.wrap(
            text,
            WIDTH,
            initial_indent=f"     {'└' if last else '├'}─ ",
            subsequent_indent=f"     {' ' if last else '│'}     ",
        )


def label_of(edge: Edge) -> str:
    """The condition of an edge in one line."""
    return ", ".join(filter(None, (edge.ages, edge.condition))) or "anything"


def graph_dot(graph: Graph, title: str) -> str:
    """The automaton as DOT, for Graphviz."""
    lines = [f"digraph {quoted(title)} {{", "  rankdir=LR;", '  node [fontname="sans-serif"];']
    for place in graph.places:
        shape = "doublecircle" if place.name in ENDS else "box"
        text = place.name if place.name in ENDS else f"{place.name}\n{place.required}"
        lines.append(f"  {quoted(place.name)} [shape={shape}, label={quoted(text)}];")
    for edge in graph.edges:
        text = "\n".join(filter(None, (label_of(edge), edge.sets)))
        lines.append(f"  {quoted(edge.source)} -> {quoted(edge.target)} [label={quoted(text)}];")
    return "\n".join([*lines, "}"]) + "\n"
