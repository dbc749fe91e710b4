"""What became of a mutant: data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from rvmon.cdv.mutation.mutant import HELD_OUT, Mutant

if TYPE_CHECKING:
    from rvmon.cdv.mutation.record import Difference, Recorded


class How(StrEnum):
    """What distinguishes a mutant from the code as it is."""

    REQUIREMENT = "requirement"
    """One fails that did not."""
    ANSWER = "known answer"
    """A verdict is not what the test expects, and was."""
    CRASHED = "crashed"
    HUNG = "hung"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Finding:
    """A test that kills a mutant.

    Attributes:
        test: its name; empty: not known, as the process was ended.
        how: it does.
        what: the requirements that fail, or are judged otherwise than expected; else the error.
    """

    test: str
    how: How
    what: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Tried:
    """A mutant, and what a suite sees of it.

    Attributes:
        mutant: the change.
        reaching: tests of the suite that run the changed line.
        played: of them so many were played.
        findings: what kills it, in the order of the suite.
        difference: the first in a run that no finding is about.
        invalid: why it cannot be planted; empty if it can.
        failing: the first test by which a requirement fails, and its run, if runs are kept.
    """

    mutant: Mutant
    reaching: int
    played: int = 0
    findings: tuple[Finding, ...] = ()
    difference: Difference | None = None
    invalid: str = ""
    failing: tuple[str, Recorded] | None = field(default=None, compare=False)

    @property
    def killed(self) -> bool:
        """Whether the suite sees the change."""
        return bool(self.findings)

    @property
    def killed_by_requirement(self) -> bool:
        """Whether a requirement fails on it: known answers and crashes do not count."""
        return any(one.how is How.REQUIREMENT for one in self.findings)


@dataclass(frozen=True, slots=True)
class Score:
    """Figures of some mutants.

    Attributes:
        mutants: all that can be planted.
        equivalent: of them so many are declared to change no behaviour, and none of them is killed.
        killed: by whatever.
        by_requirement: killed by a requirement that fails.
        unreached: so many are in lines that no test runs.
    """

    mutants: int
    equivalent: int
    killed: int
    by_requirement: int
    unreached: int

    @property
    def rest(self) -> int:
        """The mutants that are not equivalent."""
        return self.mutants - self.equivalent


def failing_runs(tried: Iterable[Tried]) -> dict[str, Recorded]:
    """The runs that were kept of mutants which are not held out, by test and mutant."""
    return {
        f"{one.failing[0]} with {one.mutant.identity}": one.failing[1]
        for one in tried
        if one.failing is not None and one.mutant.third != HELD_OUT
    }


def scored(tried: Iterable[Tried], equivalent: Iterable[str] = ()) -> Score:
    """Count.

    Args:
        tried: mutants.
        equivalent: the identities of those that are declared to change no behaviour.
    """
    counted = [one for one in tried if not one.invalid]
    known = set(equivalent)
    return Score(
        len(counted),
        sum(one.mutant.identity in known and not one.killed for one in counted),
        sum(one.killed for one in counted),
        sum(one.killed_by_requirement for one in counted),
        sum(not one.reaching for one in counted),
    )
