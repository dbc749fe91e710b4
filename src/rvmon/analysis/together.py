"""Attempts of several requirements side by side: whether they can all end well.

One clock measures the time since the first trigger; its ages are cut into cells by the windows of
all. More is taken to be possible than is: windows that open later than the trigger may lie
anywhere, a cell takes any number of steps. So what is found impossible is so.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.analysis.letters import combinations_of
from rvmon.analysis.possible import automaton_letter
from rvmon.analysis.subject import Subject
from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import FAILED, NOW, PASSED
from rvmon.spec.checked import CheckedSpec, EndPolicy, TimeModel

MOST_STATES = 4000

Spot = tuple[int, tuple[int, ...]]
"""Where one attempt is: its location, and the regions of its clocks."""

State = tuple[int, tuple[Spot | None, ...]]
"""The cell, and each attempt; `None` before its trigger."""


@dataclass(frozen=True, slots=True)
class Aim:
    """What is looked for.

    Attributes:
        well: the attempts, by their place, that shall end well.
        failed: those that shall have failed; of the others nothing is asked.
    """

    well: frozenset[int]
    failed: frozenset[int] = frozenset()


def can_reach(
    spec: CheckedSpec, subjects: Sequence[Subject], offsets: Sequence[int], aim: Aim
) -> bool | None:
    """Whether attempts can come to what is looked for.

    Args:
        spec: declares the names.
        subjects: with automata and triggers.
        offsets: of their triggers, ticks after the first.
        aim: what is looked for, if the run ended there.

    Returns:
        `False` if it surely cannot be, `True` if it may, `None` if that was too much to find out.

    Source: emptiness of a product of timed automata, after Alur and Dill 1994.
    """
    letters = _letters(spec, subjects)
    if letters is None:
        return None
    search = _Search(spec, subjects, offsets, letters, aim)
    waiting: list[State] = [(-1, tuple(None for _ in subjects))]
    seen = set(waiting)
    while waiting:
        for state in search.after(waiting.pop()):
            if state in seen:
                continue
            if search.is_reached(state):
                return True
            seen.add(state)
            if len(seen) > MOST_STATES:
                return None
            waiting.append(state)
    return False


@dataclass(frozen=True, slots=True)
class _Letter:
    """One joint letter: the class for each automaton, and whether each trigger holds."""

    classes: tuple[int, ...]
    triggers: tuple[bool, ...]


def _letters(spec: CheckedSpec, subjects: Sequence[Subject]) -> frozenset[_Letter] | None:
    automata = [_automaton(subject) for subject in subjects]
    states = [p for automaton in automata for p in automaton.alphabet.propositions]
    triggers = [subject.trigger for subject in subjects if subject.trigger is not None]
    found = combinations_of(spec, [*states, *triggers])
    if found is None:
        return None
    made = set()
    for vector in found.vectors:
        classes = []
        start = 0
        for automaton in automata:
            stop = start + len(automaton.alphabet.propositions)
            classes.append(automaton_letter(automaton, vector[start:stop]))
            start = stop
        made.add(_Letter(tuple(classes), vector[start:]))
    return frozenset(made)


def _automaton(subject: Subject) -> Automaton:
    assert subject.automaton is not None, "only requirements with an automaton come here"  # noqa: S101
    return subject.automaton


def keeps_its_clock(automaton: Automaton) -> bool:
    """Whether all its windows are counted from the trigger."""
    for row in range(automaton.bases[automaton.initial]):
        if _restarts(automaton, row):
            return False
    size = len(automaton.edges) // automaton.classes
    after = automaton.bases[automaton.initial] + 1
    return not any(_restarts(automaton, row) for row in range(after, size))


def _restarts(automaton: Automaton, row: int) -> bool:
    edges = automaton.edges[row * automaton.classes : (row + 1) * automaton.classes]
    return any(edge >= 0 and NOW in automaton.sources[edge] for edge in edges)


class _Search:
    def __init__(
        self,
        spec: CheckedSpec,
        subjects: Sequence[Subject],
        offsets: Sequence[int],
        letters: frozenset[_Letter],
        aim: Aim,
    ) -> None:
        self.aim = aim
        self.subjects = subjects
        self.offsets = offsets
        self.letters = letters
        self.automata = [_automaton(subject) for subject in subjects]
        self.tied = [keeps_its_clock(automaton) for automaton in self.automata]
        cuts = {0, 1}
        for automaton, offset in zip(self.automata, offsets, strict=True):
            cuts |= {offset, offset + 1}
            for location in automaton.locations:
                cuts |= {offset + cut for clock in location.cuts for cut in clock}
        self.starts = sorted(cuts)
        self.dense = spec.time is TimeModel.HELD

    def after(self, state: State) -> Iterator[State]:
        """The states one step later from which the aim is not lost."""
        cell, spots = state
        for later in self._cells(cell):
            for letter in self.letters:
                ways = []
                for index, spot in enumerate(spots):
                    ways.append(list(self._moves(index, spot, later, letter)))
                for chosen in product(*ways):
                    if not any(self._is_lost(i, spot) for i, spot in enumerate(chosen)):
                        yield later, chosen

    def _is_lost(self, index: int, spot: Spot | None) -> bool:
        if spot is None:
            return False
        return spot[0] == (FAILED if index in self.aim.well else PASSED) and (
            index in self.aim.well or index in self.aim.failed
        )

    def _cells(self, cell: int) -> Sequence[int]:
        """The cells in which the next step may lie."""
        last = len(self.starts) - 1
        if cell < 0:
            return (0,)
        width = self.starts[cell + 1] - self.starts[cell] if cell < last else 2
        first = cell if width > 1 else cell + 1
        if self.dense:
            return range(first, min(cell + 1, last) + 1)
        ends = [i for i, at in enumerate(self.starts) if at in self.offsets and i > cell]
        return range(first, min([*ends, last]) + 1)

    def _moves(
        self, index: int, spot: Spot | None, cell: int, letter: _Letter
    ) -> Iterator[Spot | None]:
        """Where one attempt can be after a step in a cell."""
        automaton, age = self.automata[index], self.starts[cell] - self.offsets[index]
        if age < 0:
            yield None
            return
        if spot is None:
            if not letter.triggers[index]:
                return
            spot = (automaton.initial, ())
        location, regions = spot
        if location <= PASSED:
            yield spot
            return
        for at in self._regions(index, location, regions, age):
            row = automaton.bases[location] + sum(map(int.__mul__, at, automaton.strides[location]))
            edge = automaton.edges[row * automaton.classes + letter.classes[index]]
            if edge >= 0:
                kept = tuple(0 if s == NOW else at[s] for s in automaton.sources[edge])
                yield automaton.targets[edge], kept

    def _regions(
        self, index: int, location: int, regions: tuple[int, ...], age: int
    ) -> Iterator[tuple[int, ...]]:
        cuts = self.automata[index].locations[location].cuts
        if self.tied[index]:
            yield tuple(bisect_right(own, age) for own in cuts)
            return
        yield from product(*(range(r, len(own) + 1) for r, own in zip(regions, cuts, strict=True)))

    def is_reached(self, state: State) -> bool:
        """Whether the aim is reached if the run ends here, all attempts having been triggered."""
        cell, spots = state
        if any(spot is None for spot in spots):
            return False
        at = [spot for spot in spots if spot is not None]
        return all(self._well(i, *at[i], cell) for i in self.aim.well) and all(
            at[i][0] == FAILED for i in self.aim.failed
        )

    def _well(self, index: int, location: int, regions: tuple[int, ...], cell: int) -> bool:
        if location <= PASSED:
            return location == PASSED
        policy = self.subjects[index].requirement.at_end
        if policy is not EndPolicy.DEFAULT:
            return policy in (EndPolicy.WEAK, EndPolicy.PASS)
        automaton, age = self.automata[index], self.starts[cell] - self.offsets[index]
        return any(
            automaton.end_values[
                automaton.bases[location] + sum(map(int.__mul__, at, automaton.strides[location]))
            ]
            for at in self._regions(index, location, regions, age)
        )
