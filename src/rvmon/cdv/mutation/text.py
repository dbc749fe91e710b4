"""Mutants for the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.cdv.mutation.mutant import HELD_OUT, Mutant
from rvmon.cdv.mutation.question import TITLES, question
from rvmon.cdv.mutation.report import MutationReport, SuiteTried
from rvmon.cdv.mutation.tried import How, Tried
from rvmon.report.percent import percent_text
from rvmon.report.plain_table import plain_table

HEAD = (
    *("suite", "third", "mutants", "equivalent", "killed", "by a requirement", "not run"),
    *("score", "by a requirement"),
)


def report_text(report: MutationReport, *, most: int | None = None) -> str:
    """Scores, what killed, and the survivors of each suite as questions.

    Args:
        report: what is shown.
        most: survivors of each kind that are listed; `None`: all.
    """
    lines = [plain_table([HEAD, *score_rows(report)])]
    for name, suite in report.suites.items():
        lines += [f"{name}: {_killers(suite)}.", *_left_out(suite), ""]
    for name in report.suites:
        for kind, survivors in report.survivors(name).items():
            lines += [f"{name}: {len(survivors)} survive. {TITLES[kind]}", ""]
            for one in survivors[:most]:
                lines += [*survivor_lines(one, report), ""]
            if most is not None and len(survivors) > most:
                lines += [f"… and {len(survivors) - most} more", ""]
    return "\n".join(lines).rstrip("\n") + "\n"


def score_rows(report: MutationReport) -> Iterator[tuple[str, ...]]:
    """The scores of each suite, of each third and of all."""
    for name in report.suites:
        for third, score in report.scores(name).items():
            yield (
                *(name, third, str(score.mutants), str(score.equivalent), str(score.killed)),
                *(str(score.by_requirement), str(score.unreached)),
                *(percent_text(part, score.rest) for part in (score.killed, score.by_requirement)),
            )
            name = ""


def survivor_lines(one: Tried, report: MutationReport) -> Iterator[str]:
    """A survivor: its place, the change, the question."""
    mutant = one.mutant
    yield f"  {mutant.path.name}:{mutant.line}  {mutant.identity}"
    yield from (f"    {line}" for line in change_lines(mutant))
    yield f"    {question(one, report.reading)}"


def change_lines(mutant: Mutant) -> Iterator[str]:
    """The change as lines of a difference."""
    for sign, code in (("-", mutant.before), ("+", mutant.after)):
        for line in code.splitlines():
            yield f"{sign} {line}"


def _killers(suite: SuiteTried) -> str:
    """How many are killed by what first comes of: a requirement, an answer, a crash and so on."""
    counts = dict.fromkeys(How, 0)
    for one in suite.tried:
        if one.killed:
            found = {finding.how for finding in one.findings}
            counts[next(how for how in How if how in found)] += 1
    told = ", ".join(f"{count} {_SAID[how]}" for how, count in counts.items() if count)
    invalid = sum(bool(one.invalid) for one in suite.tried)
    rest = f"; {invalid} cannot be planted" if invalid else ""
    return f"{suite.tests} tests, {told or 'nothing killed'}{rest}"


_SAID = {
    How.REQUIREMENT: "killed by a requirement that fails",
    How.ANSWER: "by a known answer only",
    How.CRASHED: "by a crash",
    How.HUNG: "hung",
    How.LOST: "lost",
}


def _left_out(suite: SuiteTried) -> Iterator[str]:
    for name, why in suite.left_out.items():
        yield f"  left out: {name}: {why}"


def list_text(mutants: list[Mutant], *, held_out: bool) -> str:
    """The mutants one by one, without playing them."""
    shown = [one for one in mutants if held_out or one.third != HELD_OUT]
    rows = [("third", "line", "mutant", "change")]
    for one in shown:
        change = f"{one.before.splitlines()[0]} => {one.after.splitlines()[0]}"
        rows.append((one.third, str(one.line), one.identity, change))
    hidden = len(mutants) - len(shown)
    told = f"{len(mutants)} mutants" + (f", {hidden} of them held out and not shown" * bool(hidden))
    return plain_table(rows) + f"{told}\n"
