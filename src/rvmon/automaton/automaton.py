"""The deterministic timed monitor of one formula, as integer tables."""

from __future__ import annotations

from array import array
from dataclasses import dataclass

from rvmon.automaton.letter_classes import LetterClasses
from rvmon.automaton.location import Location
from rvmon.formula.alphabet import Alphabet


@dataclass(frozen=True, slots=True, eq=False)
class Automaton:
    """Locations, clocks and edges; made once by `construct`, never changed.

    A *row* is a location with a region for each of its clocks: `bases[location]` plus, for each
    clock, the number of its cuts that its age has reached, times its stride. The edge taken from a
    row with a letter is `edges[row * classes + class_of[letter]]`. `FAILED` and `PASSED` are the
    first two locations.

    Attributes:
        alphabet: what letters are made of.
        locations: with their residuals and cuts.
        initial: the location before the position of the trigger.
        classes: the number of classes of letters.
        class_of: the class of each letter.
        bases: per location, its first row.
        strides: per location and clock.
        edges: row and class to the number of an edge; −1 where no run comes.
        targets: per edge, the location it leads to.
        sources: per edge, for each clock of its target the old clock it is, or `NOW`.
        time_values: per row, the truth if time alone has come to it.
        end_values: per row, whether the rule for the end of a trace makes the residual true there.
    """

    alphabet: Alphabet
    locations: tuple[Location, ...]
    initial: int
    classes: int
    class_of: LetterClasses
    bases: tuple[int, ...]
    strides: tuple[tuple[int, ...], ...]
    edges: array[int]
    targets: tuple[int, ...]
    sources: tuple[tuple[int, ...], ...]
    time_values: bytes
    end_values: bytes

    @property
    def clocks(self) -> int:
        """The largest number of clocks in one location."""
        return max(len(location.cuts) for location in self.locations)
