"""A campaign's files: tables in four forms, coverage, every test, the pages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from rvmon.cdv.documents import coverage_document, to_json
from rvmon.cdv.files import save
from rvmon.cdv.outcome import Results
from rvmon.cdv.presentation import Presentation
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.tables import RobotTables, named_tables
from rvmon.cdv.text import print_summary
from rvmon.report.table import table_latex, tables_csv
from rvmon.writing import write_whole

TESTS = "tests"
TEMPLATES = "templates"
RUNS = "runs"
SMALLEST = "smallest"
"""Folders of a campaign's folder."""

TEXT_COLUMNS = 100
"""Width of `table.txt`."""


def write_tables(
    folder: Path,
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    presentation: Presentation,
) -> None:
    """Write `table.txt`, `table.csv`, `table.tex`, `table.json` and `coverage.json`."""
    named = {**named_tables(tables, summary.control), **presentation.further}
    latex = "\n".join(table_latex(table) for table in named.values())
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "table.txt", _plain_text(summary, tables))
    write_whole(folder / "table.csv", tables_csv(named, key="robot"))
    write_whole(folder / "table.tex", latex)
    write_whole(folder / "table.json", to_json(presentation.document(summary)))
    write_whole(folder / "coverage.json", to_json(coverage_document(summary)))


def write_tests(folder: Path, results: Results) -> None:
    """Write every test that was played to `tests/`, each to be replayed alone."""
    tests = folder / TESTS
    tests.mkdir(parents=True, exist_ok=True)
    for test in {one.job.test.name: one.job.test for one in results.played}.values():
        save(test, tests)


def dated_files(folder: Path) -> dict[Path, int]:
    """The files in folders of a campaign's folder, each with the instant of its last change."""
    return {
        path: path.stat().st_mtime_ns
        for part in (TESTS, TEMPLATES, RUNS, SMALLEST)
        for path in (folder / part).rglob("*")
        if path.is_file()
    }


def left_over(folder: Path, before: Mapping[Path, int]) -> str:
    """Say which files of an earlier campaign lie beside those of this one; empty if none does.

    Args:
        folder: of the campaign, which is written.
        before: what `dated_files` found there before.
    """
    now = dated_files(folder)
    counts = Counter(
        path.relative_to(folder).parts[0] for path, at in before.items() if now.get(path) == at
    )
    if not counts:
        return ""
    places = " and ".join(f"{count} in {folder / part}" for part, count in counts.items())
    return (
        f"files that this campaign did not write stay: {places}; remove them, or name a new --out"
    )


def _plain_text(summary: CampaignSummary, tables: Mapping[str, RobotTables]) -> str:
    import io

    from rvmon.report.terminal import Terminal

    text = io.StringIO()
    print_summary(summary, tables, Terminal(file=text, width=TEXT_COLUMNS, color_system=None))
    return text.getvalue()
