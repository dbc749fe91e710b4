"""`handover run` and `handover demo`: plan, play, show, write."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from handover.campaign.documents import table_document, to_json
from handover.campaign.execute import INTERRUPTED, execute
from handover.campaign.files import dated_files, left_over, write_tables, write_tests
from handover.campaign.model_checking import check_model
from handover.campaign.plan import plan
from handover.campaign.program import typed
from handover.campaign.strategies import STRATEGIES
from handover.campaign.summarise import summarise
from handover.campaign.summary import CampaignSummary
from handover.campaign.text import print_summary
from handover.campaign.unfinished import unfinished
from handover.campaign.write_pages import REPORT, write_pages
from rvmon.cli.progress import bar
from rvmon.errors import UnknownNameError
from rvmon.loading import load
from rvmon.report.folder import made
from rvmon.session import Spec
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Console

DEMO_STRATEGIES = tuple(STRATEGIES)
DEMO_ROBOTS = ("legacy", "correct")


def run_campaign(arguments: argparse.Namespace) -> int:
    """Run `handover run` and return its exit code."""
    robots = ("legacy" if arguments.legacy else "correct",)
    summary = _campaign(robots, _strategies(arguments.strategy), arguments)
    if arguments.format == "json":
        print(to_json(table_document(summary)).decode(), end="")
    else:
        _show(summary)
    if summary.cut_short:
        return _exit_code(summary)
    return int(arguments.strict and not _all_well(summary))


def run_demo(arguments: argparse.Namespace) -> int:
    """Run `handover demo` and return its exit code."""
    summary = _campaign(DEMO_ROBOTS, DEMO_STRATEGIES, arguments)
    _show(summary)
    if arguments.out:
        print(f"Look at {Path(arguments.out) / REPORT}")
    return _exit_code(summary)


def _exit_code(summary: CampaignSummary) -> int:
    return {"": 0, INTERRUPTED: 130}.get(summary.cut_short, 3)


def _campaign(
    robots: Sequence[str], strategies: Sequence[str], arguments: argparse.Namespace
) -> CampaignSummary:
    """Plan, load the requirements, play, count, write."""
    from rich.console import Console

    console = Console(stderr=True)
    folder = made(arguments.out) if arguments.out else None
    before = dated_files(folder) if folder is not None else {}
    with _told("generating tests", console):
        chosen = plan(
            robots,
            strategies,
            tests=arguments.tests,
            seed=arguments.seed,
            spec=Path(arguments.spec) if arguments.spec else None,
            monitors=not arguments.no_monitors,
        )
    # Wrong requirements are told before anything is played.
    specs = {robot: load(path) for robot, path in chosen.specs.items()} if chosen.monitors else {}
    planned = len(chosen.jobs())
    kept = None
    if folder is not None:
        kept = unfinished(folder, chosen, specs, _again(arguments))
        if kept.played:
            print(f"{len(kept.played)} of {planned} tests were played before", file=sys.stderr)
    with bar("tests", planned) as tell:
        results = execute(chosen, jobs=arguments.jobs, kept=kept, progress=tell)
    texts = {robot: _texts(specs.get(robot)) for robot in chosen.specs}
    checked = {}
    if "model-based" in chosen.tests and chosen.monitors:
        with _told("model checking", console):
            checked = check_model(dict.fromkeys(name for one in texts.values() for name in one))
    summary = summarise(results, texts, checked)
    if folder is not None:
        with _told("writing tables and pages", console):
            write_tables(folder, summary)
            write_tests(folder, results)
            write_pages(folder, summary, results, specs, _again(arguments))
        if remark := left_over(folder, before):
            print(remark, file=sys.stderr)
    if kept is not None and results.cut_short:
        print(f"{kept.path}: the same command plays what is left", file=sys.stderr)
    elif kept is not None:
        kept.path.unlink(missing_ok=True)
    return summary


def _told(what: str, console: Console) -> AbstractContextManager[object]:
    """Tell a person at a terminal what is being done."""
    return console.status(what) if console.is_terminal else nullcontext()


def _again(arguments: argparse.Namespace) -> str:
    """The command that runs the same campaign."""
    words = [arguments.command, "--tests", arguments.tests, "--seed", arguments.seed]
    if arguments.command == "run":
        words += ["--strategy", arguments.strategy]
        words += ["--legacy"] if arguments.legacy else []
        words += ["--spec", arguments.spec] if arguments.spec else []
        words += ["--no-monitors"] if arguments.no_monitors else []
    return typed([*words, "--out", arguments.out])


def _texts(spec: Spec | None) -> Mapping[str, str]:
    if spec is None:
        return {}
    return {name: requirement.text for name, requirement in spec.requirements.items()}


def _show(summary: CampaignSummary) -> None:
    from rich.console import Console

    console = Console(highlight=False)
    if not sys.stdout.isatty():
        console = Console(highlight=False, width=100)
    print_summary(summary, console)
    console.print(
        f"{summary.finished} tests in {summary.seconds:.1f} s: "
        f"{summary.simulated_s:,.0f} s simulated, "
        f"{summary.stepped_s:,.0f} s of them with physics, the rest at rest and jumped over."
    )
    if summary.cut_short:
        console.print(
            f"{summary.cut_short}: {summary.finished} of {summary.planned} tests were finished; "
            "the tables are partial",
            style="yellow",
        )


def _all_well(summary: CampaignSummary) -> bool:
    """No requirement failed or is open in any test, and each was triggered by one."""
    for figures in summary.robots.values():
        for name in figures.requirements:
            rows = [strategy.counts[name] for strategy in figures.strategies.values()]
            bad = sum(row[Verdict.FAIL] + row[Verdict.INCONCLUSIVE] for row in rows)
            if bad or not sum(row[Verdict.PASS] for row in rows):
                return False
    return all(one.as_expected for robot in summary.robots.values() for one in robot.known)


def _strategies(listed: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in listed.split(",") if name.strip())
    for name in names:
        if name not in STRATEGIES:
            raise UnknownNameError(f"no strategy `{name}`: there are {', '.join(STRATEGIES)}")
    if not names:
        raise UnknownNameError(f"--strategy names none: there are {', '.join(STRATEGIES)}")
    return tuple(dict.fromkeys(names))
