"""A campaign's files: tables in four forms, coverage, every test, the pages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from handover.campaign.documents import coverage_document, table_document, to_json
from handover.campaign.outcome import Results
from handover.campaign.summary import CampaignSummary
from handover.campaign.tables import all_tables
from handover.campaign.text import print_summary
from handover.generator.files import save
from handover.generator.model_based import save_templates
from rvmon.report.table_csv import tables_csv
from rvmon.report.table_latex import table_latex
from rvmon.writing import write_whole

TESTS = "tests"
TEMPLATES = "templates"
RUNS = "runs"
"""Folders of a campaign's folder."""

TEXT_COLUMNS = 100
"""Width of `table.txt`."""


def write_tables(folder: Path, summary: CampaignSummary) -> None:
    """Write `table.txt`, `table.csv`, `table.tex`, `table.json` and `coverage.json`."""
    tables = all_tables(summary)
    latex = "\n".join(table_latex(table) for table in tables.values())
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "table.txt", _plain_text(summary))
    write_whole(folder / "table.csv", tables_csv(tables, key="robot"))
    write_whole(folder / "table.tex", latex)
    write_whole(folder / "table.json", to_json(table_document(summary)))
    write_whole(folder / "coverage.json", to_json(coverage_document(summary)))


def write_tests(folder: Path, results: Results) -> None:
    """Write every test that was played to `tests/`, each to be replayed alone.

    Those that the model gave have their templates in `templates/`.
    """
    tests = folder / TESTS
    tests.mkdir(parents=True, exist_ok=True)
    for test in {one.job.test.name: one.job.test for one in results.outcomes}.values():
        save(test, tests)
    save_templates({one.job.test.strategy for one in results.outcomes}, folder / TEMPLATES)


def dated_files(folder: Path) -> dict[Path, int]:
    """The files in folders of a campaign's folder, each with the instant of its last change."""
    return {
        path: path.stat().st_mtime_ns
        for part in (TESTS, TEMPLATES, RUNS)
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


def _plain_text(summary: CampaignSummary) -> str:
    import io

    from rich.console import Console

    text = io.StringIO()
    print_summary(summary, Console(file=text, width=TEXT_COLUMNS, color_system=None))
    return text.getvalue()
