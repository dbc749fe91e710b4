"""The mutation report for the terminal and as a page: scores, killers, survivors as questions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from rvmon.cdv.mutation.python_mutants import HELD_OUT, THIRDS, Mutant
from rvmon.cdv.mutation.spec_mutants import SpecMutant, SpecTried, spec_scored
from rvmon.cdv.mutation.survivors import (
    TITLES,
    How,
    Missing,
    Score,
    Tried,
    missing,
    question,
    scored,
)
from rvmon.report.html import render
from rvmon.report.printer import Printer
from rvmon.texts import counted, percent_text

ALL = "all"


@dataclass(frozen=True, slots=True)
class SuiteTried:
    """A suite with the results of the mutants."""

    tests: int  # number of tests
    left_out: Mapping[str, str]  # tests that gave no result, by name, each with the reason
    tried: tuple[Tried, ...] = ()  # mutants of code
    spec_tried: tuple[SpecTried, ...] = ()  # mutants of requirements


@dataclass(frozen=True, slots=True)
class MutationReport:
    """The results of one or several suites on the mutants of a robot."""

    campaign: str  # its name
    robot: str  # its name for people
    suites: Mapping[str, SuiteTried]  # by name
    equivalent: Mapping[str, str]  # identities of equivalent mutants, each with the argument
    reading: Mapping[str, Sequence[str]]  # requirements that read each signal or event
    shows_held_out: bool = False  # whether mutants of the held-out third are shown one by one
    seconds: float = field(default=0.0, compare=False)  # wall time

    def scores(self, suite: str) -> dict[str, Score]:
        """The scores on mutants of code, for each third and for all."""
        return _by_third(self.suites[suite].tried, partial(scored, equivalent=self.equivalent))

    def spec_scores(self, suite: str) -> dict[str, Score]:
        """The scores on mutants of requirements, for each third and for all."""
        return _by_third(self.suites[suite].spec_tried, spec_scored)

    def spec_survivors(self, suite: str) -> list[SpecTried]:
        """The shown mutants of requirements that give every run its original verdict."""
        return [
            tried
            for tried in self.suites[suite].spec_tried
            if self._shows(tried) and not (tried.test or tried.proved)
        ]

    def shown(self, suite: str) -> list[Tried]:
        """The mutants of code that are shown one by one."""
        return list(filter(self._shows, self.suites[suite].tried))

    def _shows(self, one: Tried | SpecTried) -> bool:
        return self.shows_held_out or one.mutant.third != HELD_OUT

    def kills(self, suite: str) -> list[tuple[str, str, str]]:
        """The killed mutants of code and of requirements, each as name, change and killer."""
        killed: list[tuple[Mutant | SpecMutant, str]]
        killed = [(tried.mutant, killer(tried)) for tried in self.shown(suite) if tried.killed]
        killed += [
            (tried.mutant, f"{tried.test}: {tried.was}, now {tried.now}")
            for tried in self.suites[suite].spec_tried
            if tried.test and self._shows(tried)
        ]
        return [(mutant.identity, mutant.brief, what) for mutant, what in killed]

    def survivors(self, suite: str) -> dict[Missing, list[Tried]]:
        """The surviving mutants of code not declared equivalent, by what may be missing."""
        by_gap: dict[Missing, list[Tried]] = {kind: [] for kind in Missing}
        for tried in self.shown(suite):
            if not (tried.killed or tried.invalid or tried.mutant.identity in self.equivalent):
                by_gap[missing(tried)].append(tried)
        return {kind: members for kind, members in by_gap.items() if members}

    @property
    def survives(self) -> bool:
        """Whether any suite lets a mutant survive that is not declared or proved equivalent."""
        both = (scores(name)[ALL] for name in self.suites
                for scores in (self.scores, self.spec_scores))  # fmt: skip
        return any(score.killed < score.rest for score in both)

    def contradictions(self) -> list[str]:
        """Mutants that are declared equivalent but are killed, or make a run differ; in words."""
        return [
            f"{tried.mutant.identity} is declared equivalent, and {why}"
            for suite in self.suites.values()
            for tried in suite.tried
            if tried.mutant.identity in self.equivalent and (why := self._refuted(tried))
        ]

    def _refuted(self, tried: Tried) -> str:
        """Why a mutant is not equivalent to the unchanged code; empty if nothing shows it."""
        if tried.killed:
            return f"{killer(tried)} kills it"
        return question(tried, self.reading) if tried.difference is not None else ""

    def document(self) -> dict[str, object]:
        """The report as a document for JSON."""
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
            "mutants": [self._mutant(tried) for tried in self.shown(name)],
            "spec_scores": self.spec_scores(name),
            "spec_mutants": [
                _spec_mutant(tried) for tried in suite.spec_tried if self._shows(tried)
            ],
        }

    def _mutant(self, tried: Tried) -> dict[str, object]:
        mutant = tried.mutant
        document: dict[str, object] = {
            "mutant": mutant.identity,
            "third": mutant.third,
            "file": mutant.path.name,
            "line": mutant.line,
            "before": mutant.before,
            "after": mutant.after,
            "reaching": tried.reaching,
            "played": tried.played,
        }
        if tried.invalid:
            document["invalid"] = tried.invalid
        elif tried.killed:
            document["killed_by"] = tried.findings
        elif mutant.identity in self.equivalent:
            document["equivalent"] = self.equivalent[mutant.identity]
        else:
            document |= {"missing": missing(tried).value, "question": question(tried, self.reading)}
        return document


_Tried = TypeVar("_Tried", Tried, SpecTried)


def _by_third(
    tried: Sequence[_Tried], score: Callable[[Iterable[_Tried]], Score]
) -> dict[str, Score]:
    thirds = {third: score(one for one in tried if one.mutant.third == third) for third in THIRDS}
    return {**thirds, ALL: score(tried)}


def killer(tried: Tried) -> str:
    """The killer of a mutant, in words; a failing requirement is preferred."""
    finding = min(tried.findings, key=lambda each: each.how is not How.REQUIREMENT)
    what = ", ".join(finding.what)
    return f"{finding.how} ({what})" + (f" in {finding.test}" if finding.test else "")


def _spec_mutant(tried: SpecTried) -> dict[str, object]:
    document: dict[str, object] = {
        "mutant": tried.mutant.identity,
        "third": tried.mutant.third,
        "before": tried.mutant.before,
        "after": tried.mutant.after,
        "proved_equivalent": tried.proved,
    }
    if tried.was is not None and tried.now is not None:
        document["killed_by"] = {"test": tried.test, "was": tried.was.value, "now": tried.now.value}
    return document


HEAD = (
    *("suite", "third", "mutants", "equivalent", "killed", "by a requirement", "not run"),
    *("score", "score by requirements"),
)

SPEC_HEAD = ("suite", "third", "mutants", "proved equivalent", "killed", "score")

KILLS_HEAD = ("mutant", "change", "killed by")

SPEC_TITLE = (
    "No recorded run gets another verdict: is a stimulus missing, or does the requirement ask more "
    "than matters?"
)


def print_mutation(report: MutationReport, printer: Printer, *, most: int | None = None) -> None:
    """Print scores, ways of killing, and the survivors of each suite as questions.

    At most `most` survivors are listed per kind; `None`: all survivors and all killed mutants.
    """
    for title, head, rows in _score_tables(report):
        printer.line(f"Mutants of {title}")
        printer.table(head, rows, range(2, len(head)), wraps=())
        for name, suite in report.suites.items() if head is HEAD else ():
            printer.line(f"{name}: {_killers(suite)}.")
            for test, why in suite.left_out.items():
                printer.line(f"  left out: {test}: {why}")
    printer.line()
    for name in report.suites:
        for title, blocks in _survivors(report, name):
            printer.line(f"{name}: {counted(len(blocks), 'survivor')}. {title}\n")
            for block in blocks[:most]:
                printer.line("\n".join([*block, ""]))
            if most is not None and len(blocks) > most:
                printer.line(f"  … and {len(blocks) - most} more\n")
    for name in report.suites:
        if most is None and (kills := report.kills(name)):
            printer.line(f"{name}: killed")
            printer.table(KILLS_HEAD, kills, wraps=())


def _survivors(report: MutationReport, suite: str) -> Iterator[tuple[str, list[list[str]]]]:
    """The survivors by what may be missing: a heading, and the lines of each survivor."""
    for kind, survivors in report.survivors(suite).items():
        yield TITLES[kind], [list(survivor_lines(survivor, report)) for survivor in survivors]
    if spec_survivors := report.spec_survivors(suite):
        blocks = [
            [
                f"  {survivor.mutant.identity}",
                *_difference(survivor.mutant.before, survivor.mutant.after),
            ]
            for survivor in spec_survivors
        ]
        yield SPEC_TITLE, blocks


def _score_tables(
    report: MutationReport,
) -> Iterator[tuple[str, Sequence[str], list[Sequence[str]]]]:
    """Tables of scores for the code and the requirements: title, head and rows."""
    suites = report.suites.values()
    if any(suite.tried for suite in suites):
        yield "the code", HEAD, [*_score_rows(report, report.scores)]
    if any(suite.spec_tried for suite in suites):
        rows = [(*row[:5], row[-1]) for row in _score_rows(report, report.spec_scores)]
        yield "the requirements", SPEC_HEAD, [*rows]


def _score_rows(
    report: MutationReport, scores: Callable[[str], Mapping[str, Score]]
) -> Iterator[Sequence[str]]:
    for name in report.suites:
        for third, score in scores(name).items():
            counts = (score.mutants, score.equivalent, score.killed)
            more = (score.by_requirement, score.unreached)
            parts = (score.killed, score.by_requirement)
            shares = (percent_text(part, score.rest) for part in parts)
            yield (name, third, *map(str, (*counts, *more)), *shares)
            name = ""


def survivor_lines(tried: Tried, report: MutationReport) -> Iterator[str]:
    """The lines of a survivor: its place, its change and its question."""
    mutant = tried.mutant
    yield f"  {mutant.path.name}:{mutant.line}  {mutant.identity}"
    yield from _difference(mutant.before, mutant.after)
    yield f"    {question(tried, report.reading)}"


def _difference(before: str, after: str) -> Iterator[str]:
    for sign, code in (("-", before), ("+", after)):
        for line in code.splitlines():
            yield f"    {sign} {line}"


def _killers(suite: SuiteTried) -> str:
    """The number of tests, and of mutants killed in each way, as text."""
    counts = dict.fromkeys(How, 0)
    for tried in suite.tried:
        if tried.killed:
            ways = {finding.how for finding in tried.findings}
            counts[next(how for how in How if how in ways)] += 1
    kills = ", ".join(f"{count} {_HOW_TEXT[how]}" for how, count in counts.items() if count)
    invalid = sum(bool(tried.invalid) for tried in suite.tried)
    rest = f"; {invalid} cannot be planted" if invalid else ""
    return f"{counted(suite.tests, 'test')}, {kills or 'nothing killed'}{rest}"


_HOW_TEXT = {
    How.REQUIREMENT: "killed by a requirement that fails",
    How.ANSWER: "by a known answer only",
    How.CRASHED: "by a crash",
    How.HUNG: "hung",
    How.LOST: "lost",
}


def print_mutants(
    mutants: Sequence[Mutant | SpecMutant], printer: Printer, *, held_out: bool
) -> None:
    """Print the mutants one by one, without playing them."""
    shown = [mutant for mutant in mutants if held_out or mutant.third != HELD_OUT]
    rows = [("third", "mutant", "change")]
    printer.columns(rows + [(one.third, one.identity, one.brief) for one in shown])
    hidden = len(mutants) - len(shown)
    left = f", {hidden} of them held out and not listed" if hidden else ""
    printer.line(f"{len(mutants)} mutants{left}")


ABOUT = (
    "A mutant is one small fault planted in the code or in a requirement. A test kills it if the "
    "test succeeds without the mutant and fails with it; a survivor shows that something is "
    "missing. A hash of its name assigns each mutant to one of three parts. "
)


def mutation_page(report: MutationReport) -> str:
    """The report as an HTML page without scripts or further files."""
    hidden = "" if report.shows_held_out else f"Those {HELD_OUT} are counted, but not shown."
    return render(
        "mutation.html",
        title=f"Mutants: {report.campaign}",
        report=report,
        about=ABOUT + hidden,
        scores=_score_tables(report),
        titles=TITLES,
        spec_title=SPEC_TITLE,
        kills_head=KILLS_HEAD,
        question=partial(question, reading=report.reading),
        killers=_kill_rows,
        shown=partial(_shown, report),
    )


def _shown(report: MutationReport, suite: str) -> tuple[list[Tried], list[Sequence[str]]]:
    """The shown mutants of a suite that were killed, and rows of those declared equivalent."""
    tried_mutants = report.shown(suite)
    equivalent = [
        (tried.mutant.identity, tried.mutant.brief, report.equivalent[tried.mutant.identity])
        for tried in tried_mutants
        if tried.mutant.identity in report.equivalent
    ]
    return [tried for tried in tried_mutants if tried.killed], [*equivalent]


def _kill_rows(killed: Sequence[Tried]) -> list[Sequence[str]]:
    """Rows of requirements, and of other ways of killing, with their tests and numbers of mutants.

    Only the best killer of a mutant counts, in the order of `How`: requirements come first.
    """
    counts: Counter[str] = Counter()
    tests: dict[str, Counter[str]] = {}
    for tried in killed:
        best = min(tried.findings, key=lambda finding: tuple(How).index(finding.how))
        for what in best.what if best.how is How.REQUIREMENT else (best.how.value,):
            counts[what] += 1
            tests.setdefault(what, Counter())[best.test] += 1
    return [
        (
            what,
            ", ".join(
                f"{test or 'unknown'} {number}" for test, number in tests[what].most_common()
            ),
            str(count),
        )
        for what, count in counts.most_common()
    ]
