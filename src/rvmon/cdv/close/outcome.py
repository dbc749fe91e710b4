"""What came of closing a campaign: data, and a document of it for programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rvmon.cdv.plan import Played
from rvmon.coverage.holes import Goal, Hole
from rvmon.coverage.model import Group


@dataclass(frozen=True, slots=True)
class Added:
    """A test and what it was good for.

    Attributes:
        played: the test with its outcome.
        origin: how it was made, in words.
        goals: what was met with it for the first time.
        met: how many goals were met with it and those before.
    """

    played: Played
    origin: str
    goals: Sequence[Goal]
    met: int


@dataclass(frozen=True, slots=True)
class Choice:
    """Tests that were chosen in some way, and how many mutants they kill.

    Attributes:
        times: each goal is shown by so many of them; `None`: by the margin, and they are chosen by
            mutants as well; 0: they are all that were played.
        tests: how many.
        killed: of the mutants that choose.
        held_out: of those that do not.
    """

    times: int | None
    tests: int
    killed: int
    held_out: int


@dataclass(frozen=True, slots=True)
class Trade:
    """What choices of tests cost, in faults that they do not see.

    Attributes:
        mutants: of the code, that choose.
        held_out: that do not.
        choices: from the smallest on.
    """

    mutants: int
    held_out: int
    choices: Sequence[Choice]


@dataclass(frozen=True, slots=True)
class Closed:
    """A campaign whose holes were looked for.

    Attributes:
        tests: that were played, in order.
        suite: of these the fewest known that meet as much with the margin that was asked for, and
            one for all that went wrong.
        choices: the names of those that meet as much, by how many show each goal, up to the margin.
        fewest: no suite of that margin has fewer; its size if it is known to be the smallest.
        goals: how many there are, without those that cannot be met.
        share: of the coverage model that is covered, from 0 to 1, without what cannot be.
        proved: goals that cannot be met, each with the query that the model answers so.
        argued: those of which the campaign says so, each with its reason.
        open: what no test met, in words.
        wrong: goals that cannot be met, as it is declared, and that a test met, with its name.
        groups: what was measured beside what the campaign measures.
        seconds: that it took.
        ended: why it ended with open goals; empty if there is none.
        trade: what the suite sees of mutants, if it was chosen by them as well.
    """

    tests: Sequence[Added]
    suite: Sequence[Played]
    choices: Mapping[int, Sequence[str]]
    fewest: int
    goals: int
    share: float
    proved: Mapping[Goal, str]
    argued: Mapping[Goal, str]
    open: Mapping[Goal, Hole]
    wrong: Mapping[Goal, str]
    groups: Sequence[Group]
    seconds: float
    ended: str
    trade: Trade | None = None

    @property
    def sizes(self) -> dict[int, int]:
        """How many tests meet as much, by how many show each goal, up to the margin."""
        return {times: len(names) for times, names in self.choices.items()}

    @property
    def needed(self) -> int:
        """How many tests of the suite there are for what they meet."""
        return self.sizes[max(self.sizes)]

    @property
    def met(self) -> int:
        """How many goals were met."""
        return self.goals - len(self.open)

    @property
    def proofs(self) -> dict[Goal, str]:
        """Why goals cannot be met of which the model says so, in words."""
        return {goal: f"the model proves it: {query}" for goal, query in self.proved.items()}


def closed_document(closed: Closed) -> dict[str, object]:
    """The content of `closing.json`; a goal is a pair of group and item.

    All of it but `seconds` follows from the seed, unless seconds ended it.
    """
    return {
        "goals": closed.goals,
        "met": closed.met,
        "share": closed.share,
        "ended": closed.ended,
        "tests": [
            {
                "name": one.played.job.test.name,
                "made": one.origin,
                "ending": one.played.outcome.ending,
                "verdicts": one.played.outcome.verdicts,
                "added": one.goals,
                "met": one.met,
            }
            for one in closed.tests
        ],
        "suite": [one.job.test.name for one in closed.suite],
        "sizes": closed.sizes,
        "at_least": closed.fewest,
        "trade": closed.trade,
        "open": [{"goal": goal, "hole": hole} for goal, hole in closed.open.items()],
        "proved": _texts(closed.proved),
        "argued": _texts(closed.argued),
        "wrong": _texts(closed.wrong),
        "seconds": round(closed.seconds, 2),
    }


def _texts(texts: Mapping[Goal, str]) -> Iterable[object]:
    return [{"goal": goal, "text": text} for goal, text in texts.items()]
