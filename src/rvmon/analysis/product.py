"""The product of several requirements' automata: whether attempts of all can pass together.

The time since the first trigger is divided into cells by the bounds of all windows. For each clock
the search knows the cell in which it was started, and so its age up to the widths of two cells.
This is an over-approximation: a cell allows any number of steps, and clocks started in the same
cell are not compared. So a negative answer is a proof.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import cache
from itertools import product

from rvmon.analysis.combinations import Letters, Table, Truths
from rvmon.analysis.vacuity import Regions, Subject, automaton_letter
from rvmon.language.checked.specification import CheckedSpec, EndPolicy, TimeModel
from rvmon.logic.automaton import FAILED, NOW, PASSED, Automaton, row_of
from rvmon.logic.clock_regions import region_bounds

MOST_STATES = 4000  # the most states of a search; with more, nothing is decided
FOREVER = 1 << 63

Spot = tuple[int, Regions, tuple[int, ...]]
"""The state of one attempt: location, least regions of its clocks, cells in which they started."""

State = tuple[int, tuple[Spot | None, ...]]
"""The present cell, and the state of each attempt; `None` before its trigger."""

Letter = tuple[tuple[int, bool], ...]
"""A joint letter: per requirement, the class of the letter, and whether its trigger is true."""


class Together:
    """Answers reachability queries on products of requirements; caches letters."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self._letters = Letters(spec)
        self._table = cache(self._tabled)
        self._joint = cache(self._joined)

    def letters(self, subjects: Sequence[Subject]) -> frozenset[Letter] | None:
        """The joint letters of requirements; `None` if there are too many."""
        return self._joint(*subjects)

    def _joined(self, *subjects: Subject) -> frozenset[Letter] | None:
        return self._letters.joint([*map(self._table, subjects)])

    def _tabled(self, subject: Subject) -> Table[tuple[int, bool]] | None:
        propositions = _automaton(subject).alphabet.propositions
        trigger = [] if subject.trigger is None else [subject.trigger]
        return self._letters.table([*propositions, *trigger], _view(subject))

    def can_start(self, subjects: Sequence[Subject]) -> bool | None:
        """Whether all triggers can be true at one instant; `None` if not decided."""
        letters = self.letters(subjects)
        if letters is None:
            return None
        return any(all(holds for _, holds in letter) for letter in letters)

    def can_reach(
        self,
        subjects: Sequence[Subject],
        offsets: Sequence[int],
        passing: Collection[int],
        failing: Collection[int] = (),
    ) -> bool | None:
        """Whether a run exists in which some attempts pass and some fail.

        Args:
            subjects: the requirements, each with one attempt.
            offsets: the ticks from the first trigger to the trigger of each attempt.
            passing: the indices of the attempts that must pass.
            failing: the indices of the attempts that must fail.

        Returns:
            `False` is certain, `True` is not; `None` if the search was given up.

        Source: emptiness of a product of timed automata, after Alur and Dill 1994.
        """
        letters = self.letters(subjects)
        if letters is None:
            return None
        search = _Search(self.spec, subjects, offsets, letters, passing, failing)
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


def _view(subject: Subject) -> Callable[[Truths], tuple[int, bool]]:
    """Maps a valuation of a requirement to the class of its letter, and whether it triggers."""
    automaton, triggered = _automaton(subject), subject.trigger is not None

    def view(truths: Truths) -> tuple[int, bool]:
        letter = truths[:-1] if triggered else truths
        return automaton_letter(automaton, letter), triggered and truths[-1]

    return view


def _automaton(subject: Subject) -> Automaton:
    assert subject.automaton is not None, "only requirements with an automaton come here"
    return subject.automaton


class _Search:
    def __init__(
        self,
        spec: CheckedSpec,
        subjects: Sequence[Subject],
        offsets: Sequence[int],
        letters: frozenset[Letter],
        passing: Collection[int],
        failing: Collection[int],
    ) -> None:
        self.passing = passing
        self.failing = failing
        self.subjects = subjects
        self.offsets = offsets
        self.letters = letters
        self.automata = [_automaton(subject) for subject in subjects]
        # 0 and 1 make the instant of the first trigger a cell of its own.
        cuts = {0, 1}
        for automaton, offset in zip(self.automata, offsets, strict=True):
            cuts |= {offset, offset + 1} | {offset + cut for cut in _cuts(automaton)}
        self.starts = sorted(cuts)
        self.dense = spec.time is TimeModel.HELD
        self._classes = cache(self._classes_at)

    def after(self, state: State) -> Iterator[State]:
        """The states one step later from which the goal can still be reached."""
        cell, spots = state
        for later in self._cells(cell):
            for classes in self._classes(later):
                ways = []
                for index, spot in enumerate(spots):
                    kept = [
                        reached
                        for reached in self._moves(index, spot, later, classes[index])
                        if not self._is_lost(index, reached)
                    ]
                    if not kept:
                        break
                    ways.append(kept)
                else:
                    for chosen in product(*ways):
                        yield later, chosen

    def _classes_at(self, cell: int) -> frozenset[tuple[int, ...]]:
        """The possible joint classes of a cell, in which requirements that start are triggered."""
        starting = [i for i, at in enumerate(self.offsets) if at == self.starts[cell]]
        return frozenset(
            tuple(class_ for class_, _ in letter)
            for letter in self.letters
            if all(letter[index][1] for index in starting)
        )

    def _is_lost(self, index: int, spot: Spot | None) -> bool:
        lost = [FAILED] if index in self.passing else [PASSED] if index in self.failing else []
        return spot is not None and spot[0] in lost

    def _cells(self, cell: int) -> Sequence[int]:
        """The cells in which the next step may lie."""
        last = len(self.starts) - 1
        if cell < 0:
            return (0,)
        width = self.starts[cell + 1] - self.starts[cell] if cell < last else 2
        # A cell of one tick has no second position.
        first = cell if width > 1 else cell + 1
        # In held time every tick is a position, so no cell can be skipped.
        if self.dense:
            return range(first, min(cell + 1, last) + 1)
        # A run may have no sample in a cell, so the step may skip cells, but not one in which a
        # requirement is triggered.
        ends = [i for i, at in enumerate(self.starts) if at in self.offsets and i > cell]
        return range(first, min([*ends, last]) + 1)

    def _moves(
        self, index: int, spot: Spot | None, cell: int, class_: int
    ) -> Iterator[Spot | None]:
        """The possible states of one attempt after a step in a cell."""
        automaton, age = self.automata[index], self.starts[cell] - self.offsets[index]
        if age < 0:  # not triggered yet
            yield None
            return
        if spot is None:
            spot = (automaton.initial, (), ())
        location, _, began = spot
        if location <= PASSED:
            yield spot
            return
        for at in self._regions(index, spot, cell):
            row = row_of(automaton, location, at)
            edge = automaton.edges[row * automaton.classes + class_]
            if edge >= 0:
                since = [cell if s == NOW else began[s] for s in automaton.sources[edge]]
                kept = _after_edge(automaton, location, at, edge)
                yield automaton.targets[edge], kept, tuple(since)

    def _regions(self, index: int, spot: Spot, cell: int) -> Iterator[Regions]:
        """The possible regions of an attempt's clocks in a cell."""
        location, regions, began = spot
        cuts = self.automata[index].locations[location].cuts
        ranges = []
        for clock_cuts, region, start in zip(cuts, regions, began, strict=True):
            youngest = max(self.starts[cell] - self._last(start), 0)
            oldest = self._last(cell) - self.starts[start]
            low = max(bisect_right(clock_cuts, youngest), region)
            ranges.append(range(low, max(bisect_right(clock_cuts, oldest), low) + 1))
        yield from product(*ranges)

    def _last(self, cell: int) -> int:
        """The last tick of a cell."""
        return self.starts[cell + 1] - 1 if cell + 1 < len(self.starts) else FOREVER

    def is_reached(self, state: State) -> bool:
        """Whether the goal is met if the run ends here; all attempts must have been triggered."""
        cell, spots = state
        if any(spot is None for spot in spots):
            return False
        at = [spot for spot in spots if spot is not None]
        return all(self._passes(i, at[i], cell) for i in self.passing) and all(
            at[i][0] == FAILED for i in self.failing
        )

    def _passes(self, index: int, spot: Spot, cell: int) -> bool:
        location = spot[0]
        if location <= PASSED:
            return location == PASSED
        policy = self.subjects[index].requirement.at_end
        if policy is not EndPolicy.DEFAULT:
            return policy in (EndPolicy.WEAK, EndPolicy.PASS)
        automaton = self.automata[index]
        return any(
            automaton.end_values[row_of(automaton, location, at)]
            for at in self._regions(index, spot, cell)
        )


def _cuts(automaton: Automaton) -> set[int]:
    """The ages at which windows open and close; also their sums, if clocks are restarted."""
    cuts = automaton.cuts
    row = automaton.bases[automaton.initial] * automaton.classes
    first = set(automaton.edges[row : row + automaton.classes])
    later = (sources for edge, sources in enumerate(automaton.sources) if edge not in first)
    restarts = any(NOW in sources for sources in later)
    return cuts | {a + b for a in cuts for b in cuts} if restarts else cuts


def _after_edge(automaton: Automaton, location: int, regions: Regions, edge: int) -> Regions:
    """The least possible regions after an edge, relative to the cuts of the target location."""
    ours = automaton.locations[location].cuts
    theirs = automaton.locations[automaton.targets[edge]].cuts
    least = []
    for source, cuts in zip(automaton.sources[edge], theirs, strict=True):
        age = 0 if source == NOW else region_bounds(ours[source], regions[source])[0]
        least.append(bisect_right(cuts, age))
    return tuple(least)
