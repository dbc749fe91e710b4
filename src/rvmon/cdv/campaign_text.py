"""A campaign's figures for the terminal and as files, and commands as people type them."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from msgspec import structs

from rvmon.cdv.campaign_plan import Results
from rvmon.cdv.campaign_summary import NOTHING, BlockCoverage, CampaignSummary, RobotSummary
from rvmon.cdv.tables import INTERVALS, LEGEND, Presentation, RobotTables, named_tables, to_json
from rvmon.cdv.test import save
from rvmon.files import write_whole
from rvmon.report.printer import Cell, Printer, text_of
from rvmon.report.verdict_table import print_table, table_latex, tables_csv
from rvmon.texts import percent_text
from rvmon.verdicts import Verdict

_WIDEST_NAME = 12
"""A longer strategy name is split at its hyphen into two lines."""


def print_summary(
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    printer: Printer,
    foremost: Sequence[str] = (),
) -> None:
    """Print requirements, the tables of all robots, their code coverage, and directed tests.

    With `foremost`, only those requirements are shown, and everything else in short form.
    """
    for name, text in next(iter(summary.robots.values())).requirements.items():
        if not foremost or name in foremost:
            printer.line((name, "bold"), f"  {text}")
    printer.line()
    if foremost:
        for robot, figures in reversed([*summary.robots.items()]):
            _print_in_short(figures, tables[robot], foremost, printer)
        printer.sentences(LEGEND, "dim")
        printer.line()
        return
    for robot, figures in summary.robots.items():
        if figures.requirements and figures.strategies:
            _print_verdicts(tables[robot], printer)
            printer.sentences(LEGEND, "dim")
            printer.sentences(INTERVALS, "dim")
            printer.line()
        under = figures.strategies.values()
        measured = {
            ("statements", "that ran"): [strategy_summary.statements for strategy_summary in under],
            ("branches", "that were taken"): [
                strategy_summary.branches for strategy_summary in under
            ],
        }
        for (what, how), columns in measured.items():
            if any(columns):
                printer.line((f"{figures.title}: {what} of its code {how}", "bold"))
                heads = summary.kind, what, *figures.strategies
                _print_shares(heads, columns, printer)
    for figures in summary.robots.values():
        for line in _directed_lines(figures):
            printer.sentences(line)


def _print_in_short(
    figures: RobotSummary, tables: RobotTables, foremost: Sequence[str], printer: Printer
) -> None:
    for line in _directed_lines(figures):
        printer.sentences(line)
    whole = [sum(strategy.statements.values(), NOTHING) for strategy in figures.strategies.values()]
    if any(coverage.statements for coverage in whole):
        shares = zip(figures.strategies, map(_share, whole), strict=True)
        listed = ", ".join(f"{name} {share}" for name, share in shares)
        printer.sentences(f"{figures.title}: statements of its code that ran: {listed}")
    if not (figures.requirements and figures.strategies):
        return
    counts = _counts_of_all(figures)
    rest = {
        name: verdicts
        for name, verdicts in counts.items()
        if name not in foremost and not (verdicts[Verdict.FAIL] or verdicts[Verdict.INCONCLUSIVE])
    }
    shown = structs.replace(
        tables.own,
        requirements={name: "" for name in counts if name not in rest},
        notes=(),
        shows_intervals=False,
    )
    control = tables.control and structs.replace(tables.control, shows_intervals=False)
    _print_verdicts(replace(tables, own=shown, control=control), printer)
    if rest:
        passed = sum(bool(verdicts[Verdict.PASS]) for verdicts in rest.values())
        printer.sentences(
            f"{len(rest)} further requirements: {passed} passed wherever they were triggered, "
            f"{len(rest) - passed} never were; table.txt, which --out writes, has all of them.\n"
        )


def _counts_of_all(figures: RobotSummary) -> dict[str, Counter[Verdict]]:
    """Verdicts by requirement under all strategies, without those that directed tests expected."""
    counts: dict[str, Counter[Verdict]] = {name: Counter() for name in figures.requirements}
    for strategy in figures.strategies.values():
        for name, verdicts in strategy.counts.items():
            counts[name].update(verdicts)
    for answer in figures.known:
        if answer.test.mutation is None:
            for name, verdict in answer.test.expected.items():
                if answer.verdicts[name] == verdict:
                    counts[name][answer.verdicts[name]] -= 1
    return counts


def _print_verdicts(tables: RobotTables, printer: Printer) -> None:
    further = dict(tables.compared)
    if tables.control is not None and tables.control_label:
        further = {tables.control_label: tables.control, **further}
    print_table(tables.own, printer, further=further)
    if tables.remark:
        printer.sentences(tables.remark, "dim")


def _print_shares(
    heads: Sequence[str], columns: Sequence[Mapping[str, BlockCoverage]], printer: Printer
) -> None:
    """Print the covered share of each block under each strategy."""
    split = [name.rpartition("-") if len(name) > _WIDEST_NAME else ("", "", name) for name in heads]
    over = [before for before, _, _ in split] if any(sign for _, sign, _ in split) else []
    rows: list[Sequence[Cell]] = [
        (block, str(first.statements), *(_share(one[block]) for one in columns))
        for block, first in columns[0].items()
    ]
    totals = [sum(one.values(), NOTHING) for one in columns]
    foot = ["all", str(totals[0].statements), *map(_share, totals)]
    names = [name for _, _, name in split]
    printer.table(names, rows, range(1, len(heads)), over=over, foot=foot, wraps=(0,))


def _share(block: BlockCoverage) -> str:
    return percent_text(block.covered, block.statements)


def _directed_lines(figures: RobotSummary) -> Iterator[str]:
    if not figures.known:
        return
    right = sum(answer.as_expected for answer in figures.known)
    planted = sum(answer.test.mutation is not None for answer in figures.known)
    yield (
        f"{figures.title}: {right} of {len(figures.known)} directed tests ended as they should, "
        f"{planted} of them with a fault planted into the robot."
    )
    for answer in figures.known:
        if not answer.as_expected:
            yield f"  {answer.test.name}: {', '.join(answer.wrong)}"


TESTS = "tests"
TEMPLATES = "templates"
RUNS = "runs"
"""Subfolders of a campaign's folder."""


def write_tables(
    folder: Path,
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    presentation: Presentation,
) -> None:
    """Write `table.txt`, `table.csv`, `table.tex` and `table.json`."""
    named = {**named_tables(tables, summary.control), **presentation.further}
    latex = "\n".join(table_latex(table) for table in named.values())
    folder.mkdir(parents=True, exist_ok=True)
    text = text_of(lambda printer: print_summary(summary, tables, printer))
    write_whole(folder / "table.txt", text)
    write_whole(folder / "table.csv", tables_csv(named))
    write_whole(folder / "table.tex", latex)
    write_whole(folder / "table.json", to_json(presentation.document(summary)))


def write_tests(folder: Path, results: Results) -> None:
    """Write every played test to `tests/`, from where each can be replayed."""
    tests = folder / TESTS
    tests.mkdir(parents=True, exist_ok=True)
    for test in {played.job.test.name: played.job.test for played in results.played}.values():
        save(test, tests)


def dated_files(folder: Path) -> dict[Path, int]:
    """The files in subfolders of a campaign's folder, each with its modification time in ns."""
    return {
        path: path.stat().st_mtime_ns
        for part in (TESTS, TEMPLATES, RUNS)
        for path in (folder / part).rglob("*")
        if path.is_file()
    }


def left_over(folder: Path, before: Mapping[Path, int]) -> str:
    """A warning that files of an earlier campaign remain next to those of this one; or empty.

    `before` is the result of `dated_files` before this campaign was written.
    """
    now = dated_files(folder)
    left = (path for path, at in before.items() if now.get(path) == at)
    counts = Counter(path.relative_to(folder).parts[0] for path in left)
    if not counts:
        return ""
    places = " and ".join(f"{count} in {folder / part}" for part, count in counts.items())
    return (
        f"files that this campaign did not write remain: {places}; playing the folder plays those "
        "too: remove them, or name a new --out"
    )


def typed(program: str, words: Iterable[object]) -> str:
    """A command as one line for a shell.

    Args:
        program: an installed program; it is named by its path if its environment is not activated.
            Empty: the Python script that was started.
        words: its arguments.

    >>> typed("handover", ["replay", "a b.json"]).endswith("handover replay 'a b.json'")
    True
    """
    if not program:
        return shlex.join(["python", os.path.relpath(sys.argv[0]), *map(str, words)])
    installed = Path(sys.executable).with_name(program)
    is_known = shutil.which(program) or not installed.exists()
    name = program if is_known else os.path.relpath(installed)
    return shlex.join([name, *map(str, words)])
