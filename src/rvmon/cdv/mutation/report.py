"""What is shown of mutants: scores of suites, what kills each, survivors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.cdv.mutation.mutant import HELD_OUT, THIRDS
from rvmon.cdv.mutation.spec_mutants import SpecTried, spec_scored
from rvmon.cdv.mutation.tried import Missing, Score, Tried, missing, question, scored

ALL = "all"


@dataclass(frozen=True, slots=True)
class SuiteTried:
    """A suite, and what it sees.

    Attributes:
        tests: how many there are.
        left_out: tests of no use here, and why.
        tried: the mutants of the code.
        spec_tried: the mutants of the requirements.
    """

    tests: int
    left_out: Mapping[str, str]
    tried: tuple[Tried, ...] = ()
    spec_tried: tuple[SpecTried, ...] = ()


@dataclass(frozen=True, slots=True)
class MutationReport:
    """Mutants of a robot's code under some suites.

    Attributes:
        campaign: its name.
        robot: what people call it.
        suites: by name.
        equivalent: the identities of mutants that change no behaviour, each with the argument.
        reading: the requirements that read a signal or event.
        shows_held_out: whether single mutants of the third that is held out are shown.
        seconds: wall time.
    """

    campaign: str
    robot: str
    suites: Mapping[str, SuiteTried]
    equivalent: Mapping[str, str]
    reading: Mapping[str, Sequence[str]]
    shows_held_out: bool = False
    seconds: float = field(default=0.0, compare=False)

    def scores(self, suite: str) -> dict[str, Score]:
        """The score of each third, and of all."""
        tried = self.suites[suite].tried
        thirds = {
            third: scored((one for one in tried if one.mutant.third == third), self.equivalent)
            for third in THIRDS
        }
        return {**thirds, ALL: scored(tried, self.equivalent)}

    def spec_scores(self, suite: str) -> dict[str, Score]:
        """The score on mutants of the requirements; what is equivalent is proved to be."""
        tried = self.suites[suite].spec_tried
        thirds = {
            third: spec_scored(one for one in tried if one.mutant.third == third)
            for third in THIRDS
        }
        return {**thirds, ALL: spec_scored(tried)}

    def spec_survivors(self, suite: str) -> list[SpecTried]:
        """The mutants of requirements that are shown, and that no run tells apart."""
        return [
            one
            for one in self.suites[suite].spec_tried
            if not (one.test or one.proved)
            and (self.shows_held_out or one.mutant.third != HELD_OUT)
        ]

    def shown(self, suite: str) -> list[Tried]:
        """The mutants that are shown one by one."""
        tried = self.suites[suite].tried
        return [one for one in tried if self.shows_held_out or one.mutant.third != HELD_OUT]

    def kills(self, suite: str) -> list[tuple[str, str, str]]:
        """Those of them that are killed, and the mutants of requirements: name, change, by what."""
        code = [one for one in self.shown(suite) if one.killed]
        spec = [
            one
            for one in self.suites[suite].spec_tried
            if one.test and (self.shows_held_out or one.mutant.third != HELD_OUT)
        ]
        return [(one.mutant.identity, one.mutant.brief, killer(one)) for one in code] + [
            (one.mutant.identity, one.mutant.brief, f"{one.test}: {one.was}, now {one.now}")
            for one in spec
        ]

    def survivors(self, suite: str) -> dict[Missing, list[Tried]]:
        """Those of them that survive and are not known to be equivalent, by what may be missing."""
        found: dict[Missing, list[Tried]] = {kind: [] for kind in Missing}
        for one in self.shown(suite):
            if not (one.killed or one.invalid or one.mutant.identity in self.equivalent):
                found[missing(one)].append(one)
        return {kind: members for kind, members in found.items() if members}

    @property
    def survives(self) -> bool:
        """Whether a suite does not see a mutant that is not known to be equivalent."""
        scores = (
            one[ALL] for name in self.suites for one in (self.scores(name), self.spec_scores(name))
        )
        return any(one.killed < one.rest for one in scores)

    def contradictions(self) -> list[str]:
        """Mutants that are declared equivalent, and are killed, or make a run differ."""
        return [
            f"{one.mutant.identity} is declared equivalent, and {why}"
            for suite in self.suites.values()
            for one in suite.tried
            if one.mutant.identity in self.equivalent and (why := self._refuted(one))
        ]

    def _refuted(self, one: Tried) -> str:
        """What distinguishes a mutant from the code as it is; empty: nothing does."""
        if one.killed:
            return f"{killer(one)} kills it"
        return question(one, self.reading) if one.difference is not None else ""

    def document(self) -> dict[str, object]:
        """All of it as data."""
        return {
            "campaign": self.campaign,
            "robot": self.robot,
            "suites": {name: self._suite(name) for name in self.suites},
            "seconds": round(self.seconds, 2),
        }

    def _suite(self, name: str) -> dict[str, object]:
        suite = self.suites[name]
        return {
            "tests": suite.tests,
            "left_out": suite.left_out,
            "scores": self.scores(name),
            "mutants": [self._mutant(one) for one in self.shown(name)],
            "spec_scores": self.spec_scores(name),
            "spec_mutants": [
                _spec_mutant(one)
                for one in suite.spec_tried
                if self.shows_held_out or one.mutant.third != HELD_OUT
            ],
        }

    def _mutant(self, one: Tried) -> dict[str, object]:
        mutant = one.mutant
        document: dict[str, object] = {
            "mutant": mutant.identity,
            "third": mutant.third,
            "file": mutant.path.name,
            "line": mutant.line,
            "before": mutant.before,
            "after": mutant.after,
            "reaching": one.reaching,
            "played": one.played,
        }
        if one.invalid:
            document["invalid"] = one.invalid
        elif one.killed:
            document["killed_by"] = one.findings
        elif mutant.identity in self.equivalent:
            document["equivalent"] = self.equivalent[mutant.identity]
        else:
            document |= {"missing": missing(one).value, "question": question(one, self.reading)}
        return document


def killer(one: Tried) -> str:
    """What kills a mutant, in words: a requirement that fails before anything else."""
    found = next((each for each in one.findings if each.how == "requirement"), one.findings[0])
    what = ", ".join(found.what)
    return f"{found.how} ({what})" + (f" in {found.test}" if found.test else "")


def _spec_mutant(one: SpecTried) -> dict[str, object]:
    document: dict[str, object] = {
        "mutant": one.mutant.identity,
        "third": one.mutant.third,
        "before": one.mutant.before,
        "after": one.mutant.after,
        "proved_equivalent": one.proved,
    }
    if one.was is not None and one.now is not None:
        document["killed_by"] = {"test": one.test, "was": one.was.value, "now": one.now.value}
    return document
