"""The outcome of closing a campaign: as data, as a JSON document, and as text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rvmon.cdv.campaign_plan import Played
from rvmon.coverage import Group
from rvmon.coverage.holes import Goal, Hole
from rvmon.report.coverage_summary import name_of
from rvmon.report.printer import Cell, Printer
from rvmon.report.wording import first_of, wrapped
from rvmon.texts import counted, percent_text, share_text


@dataclass(frozen=True, slots=True)
class Added:
    """A played test and what it added."""

    played: Played  # the test with its outcome
    origin: str  # how it was made, in words
    goals: Sequence[Goal]  # the goals that it is the first to meet
    met: int  # number of goals met by it and all tests before


@dataclass(frozen=True, slots=True)
class Choice:
    """A choice of tests, and how many mutants they kill."""

    # How many of the tests meet each goal. `None`: the margin, with further tests that kill
    # mutants; 0: the choice is all played tests.
    times: int | None
    tests: int  # number of tests
    killed: int  # number of killed mutants, without those held out
    held_out: int  # number of killed mutants among those held out


@dataclass(frozen=True, slots=True)
class Trade:
    """The trade-off between the size of a suite and the faults that it finds."""

    mutants: int  # number of mutants that influence the choice of tests
    held_out: int  # number of mutants that do not
    choices: Sequence[Choice]  # the smallest first


@dataclass(frozen=True, slots=True)
class Closed:
    """The result of closing a campaign."""

    tests: Sequence[Added]  # the played tests, in order
    # The smallest known set of these that meets the same goals with the requested margin, and one
    # test for each way in which a test went wrong.
    suite: Sequence[Played]
    # Names of the tests in the smallest known set, by the number of tests that meet each goal.
    choices: Mapping[int, Sequence[str]]
    fewest: int  # lower bound of the size of a set with the margin; its size if proved smallest
    goals: int  # number of goals, without those that cannot be met
    share: float  # covered share of the model without its unreachable items, from 0 to 1
    proved: Mapping[Goal, str]  # goals proved unreachable, each with the query that proves it
    argued: Mapping[Goal, str]  # goals declared unreachable by the campaign, each with its reason
    open: Mapping[Goal, Hole]  # the goals that are not met, described
    wrong: Mapping[Goal, str]  # unreachable goals that were hit, each with the name of the test
    groups: Sequence[Group]  # coverage groups beyond those of the campaign
    seconds: float  # wall time
    ended: str  # why it ended with open goals; empty if none is open
    trade: Trade | None = None  # how many mutants the choices kill; `None`: not tried

    @property
    def sizes(self) -> dict[int, int]:
        """The sizes of `choices`, by the number of tests that meet each goal."""
        return {times: len(names) for times, names in self.choices.items()}

    @property
    def needed(self) -> int:
        """The number of tests of the suite that are needed to meet the goals."""
        return self.sizes[max(self.sizes)]

    @property
    def met(self) -> int:
        """The number of goals that were met."""
        return self.goals - len(self.open)

    @property
    def proofs(self) -> dict[Goal, str]:
        """The goals that the model proves unreachable, each with the reason in words."""
        return {goal: f"the model proves it: {query}" for goal, query in self.proved.items()}


def closed_document(closed: Closed) -> dict[str, object]:
    """The content of `closing.json`; a goal is a pair of group and item.

    The seed determines everything but `seconds`, unless `Budget.seconds` ended the search.
    """
    return {
        "goals": closed.goals,
        "met": closed.met,
        "share": closed.share,
        "ended": closed.ended,
        "tests": [
            {
                "name": test.played.job.test.name,
                "made": test.origin,
                "ending": test.played.outcome.ending,
                "verdicts": test.played.outcome.verdicts,
                "added": test.goals,
                "met": test.met,
            }
            for test in closed.tests
        ],
        "suite": [played.job.test.name for played in closed.suite],
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


SHOWN = 3
"""The most goals named per test."""


def print_closed(closed: Closed, printer: Printer) -> None:
    """Print what each test added, which goals are open and why, and the size of the suite."""
    useful = [test for test in closed.tests if test.goals]
    if useful:
        _print_useful(useful, closed, printer)
    if idle := len(closed.tests) - len(useful):
        printer.line(f"{counted(idle, 'further test')} added nothing.")
    printer.line()
    _print_reasons("cannot be met: the model proves it:", _by_text(closed.proved), printer)
    _print_reasons("cannot be met, by the campaign's argument:", _by_text(closed.argued), printer)
    if closed.wrong:
        printer.line(("declared unreachable, but met:", "bold red"))
        for goal, test in closed.wrong.items():
            printer.line(wrapped(f"{name_of(goal)}, by {test}", printer.width))
    if closed.open:
        printer.line((f"{counted(len(closed.open), 'open goal')}:", "bold"))
        for goal, hole in closed.open.items():
            printer.line(wrapped(name_of(goal), printer.width))
            printer.line((wrapped(f"  {hole}", printer.width), "dim"))
        group, item = next(iter(closed.open))
        printer.line("List what no test can show in `Closing.unreachable`, with the reason:")
        printer.line(f'  cdv.Unreachable({group!r}, {item!r}, "…")')
    style = "bold red" if closed.wrong else "yellow" if closed.open else "bold green"
    left = f"; {closed.ended}" if closed.ended else ""
    printer.sentences(
        f"{share_text(closed.share)} covered: {closed.met} of {closed.goals} goals met by "
        f"{counted(len(closed.tests), 'test')} in {closed.seconds:.1f} s{left}.",
        style,
    )
    printer.sentences(_suite_text(closed))
    if closed.trade is not None:
        _print_trade(closed.trade, printer)


def _suite_text(closed: Closed) -> str:
    fewest = "no fewer would do"
    if closed.fewest < closed.needed:
        fewest = f"no smaller choice was found; at least {closed.fewest} are needed"
    *fewer, margin = closed.sizes
    text = f"The suite: {closed.needed} of them cover the same"
    if fewer:
        text += f", each goal by {margin} tests where so many were found"
    text += f", {fewest}"
    for one in fewer:
        text += f"; {closed.sizes[one]} would do with {counted(one, 'test')} for each"
    if kept := len(closed.suite) - closed.needed:
        why = "what went wrong" if closed.trade is None else "what went wrong, or kills a mutant"
        text += f"; {kept} more are kept for {why}"
    return f"{text}."


def _print_trade(trade: Trade, printer: Printer) -> None:
    title = f"Killed mutants of the code ({trade.mutants + trade.held_out} in all)"
    printer.line((title, "bold"))
    heads = ["by", "tests", f"of {trade.mutants} used to choose", f"of {trade.held_out} held out"]
    rows = [
        (_choice_text(choice.times), *map(str, (choice.tests, choice.killed, choice.held_out)))
        for choice in trade.choices
    ]
    printer.table(heads, rows, right=(1, 2, 3), wraps=(0,))


def _choice_text(times: int | None) -> str:
    if times is None:
        return "the suite, with what kills more"
    return f"each goal by {counted(times, 'test')}" if times else "all that were played"


def _print_useful(useful: Sequence[Added], closed: Closed, printer: Printer) -> None:
    rows: list[tuple[Cell, ...]] = []
    for added in useful:
        name, count = added.played.job.test.name, str(len(added.goals))
        rows.append((name, count, percent_text(added.met, closed.goals), added.origin))
        rows.append(("", "", "", first_of([*map(name_of, added.goals)], SHOWN)))
    printer.table(["test", "new", "share", "made from, and what it added"], rows, right=(1, 2))


def _by_text(reasons: Mapping[Goal, str]) -> dict[str, list[Goal]]:
    goals_by_text: dict[str, list[Goal]] = {}
    for goal, text in reasons.items():
        goals_by_text.setdefault(text, []).append(goal)
    return goals_by_text


def _print_reasons(heading: str, reasons: Mapping[str, Sequence[Goal]], printer: Printer) -> None:
    if not reasons:
        return
    printer.line((heading, "bold"))
    for text, goals in reasons.items():
        printer.line(wrapped(f"{text}: {', '.join(map(name_of, goals))}", printer.width))
    printer.line()
