"""Run a campaign: plan, play, show, write."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_page import choose_examples
from rvmon.cdv.campaign_plan import Plan, Results, plan, plan_of_folder
from rvmon.cdv.campaign_text import (
    dated_files,
    left_over,
    print_summary,
    typed,
    write_tables,
    write_tests,
)
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.gate import CampaignJudgement, RobotRequirement, judge_campaign
from rvmon.cdv.play import INTERRUPTED, execute
from rvmon.cdv.replay_pages import write_pages
from rvmon.cdv.resume import unfinished
from rvmon.cdv.sequential_test import Decision
from rvmon.cdv.summarise import summarise
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.tables import RobotTables, to_json
from rvmon.cdv.test import TestError
from rvmon.cli.campaign_evidence import begun, write_campaign
from rvmon.cli.output import bar, busy, say_json, warn
from rvmon.errors import RvmonError
from rvmon.report.folder import output_folder
from rvmon.report.terminal import Terminal
from rvmon.session import Spec


@dataclass(frozen=True, slots=True)
class Conducted:
    """A campaign that was run."""

    results: Results
    summary: CampaignSummary
    tables: Mapping[str, RobotTables]

    @property
    def interrupted(self) -> bool:
        """Whether a person ended it before all was played."""
        return self.results.cut_short == INTERRUPTED

    def judged(self, *, strict: bool) -> CampaignJudgement:
        """Compare the campaign with what was expected of it.

        Args:
            strict: what is inconclusive, or never triggered, is wrong as well.
        """
        robots = self.summary.robots.items()
        requirements = {name: tuple(robot.requirements) for name, robot in robots}
        shares: dict[RobotRequirement, dict[str, Decision]] = {}
        for name, robot in robots:
            for strategy, figures in robot.strategies.items():
                for requirement, decision in figures.shares.items():
                    shares.setdefault((name, requirement), {})[strategy] = decision
        return judge_campaign(self.results, requirements, shares, strict=strict)


def conduct(
    campaign: Campaign,
    strategies: Sequence[str],
    arguments: Namespace,
    words: Sequence[object],
    stack: ExitStack,
) -> Conducted:
    """Plan, load the requirements, play, count, write.

    Args:
        campaign: the campaign.
        strategies: the strategies that make tests.
        arguments: the options of `add_campaign_options`.
        words: the command that runs it again, and its other options.
        stack: closes what was needed meanwhile.

    Raises:
        TestError: there is nothing to be played.
    """
    if arguments.shard is not None and not arguments.out:
        raise RvmonError("--shard leaves what it played in a folder: name it by --out")
    if arguments.shard is not None and arguments.evidence:
        raise RvmonError("--evidence is of all tests: give it to the command that joins the shards")
    folder = output_folder(arguments.out) if arguments.out else None
    before = dated_files(folder) if folder is not None else {}
    with busy("generating tests"):
        if arguments.suite is not None:
            chosen = plan_of_folder(campaign, arguments.suite)
        else:
            chosen = plan(campaign, strategies, tests=arguments.tests, seed=arguments.seed)
    # Wrong requirements, and coverage models, are reported before anything is played.
    specs = campaign.requirements
    for name in campaign.robots if folder is not None else ():
        coverage_model(campaign, name)
    planned = len(chosen.jobs())
    if not planned:
        _refuse_nothing(chosen)
    texts = None if arguments.evidence is None else begun(campaign, arguments.evidence)
    command, *others = words
    amount = ["--tests", arguments.tests, "--seed", arguments.seed]
    if arguments.suite is not None:
        amount = ["--suite", arguments.suite]
    same = [command, *amount, *others]
    again = typed(campaign.program, [*same, "--out", arguments.out])
    kept = None
    if folder is not None:
        kept = unfinished(folder, chosen, specs, again, arguments.shard)
        planned = len(kept.jobs)
        if kept.known:
            warn(f"{len(kept.known)} of {planned} tests were played before")
    jobs, spool = arguments.dask or arguments.jobs, None
    if folder is not None and arguments.pages == "all":  # each is recorded as it is played
        spool = Path(stack.enter_context(TemporaryDirectory(prefix="rvmon-")))
    with bar("tests", planned) as show:
        results = execute(chosen, jobs=jobs, kept=kept, progress=show, spool=spool)
    if kept is not None and kept.shard is not None and len(results.played) == planned:
        warn(f"{kept.path}: the same command without --shard joins what lies beside it")
        return written(results, specs, None, arguments, again)
    conducted = written(results, specs, folder, arguments, again, spool)
    if texts is not None and results.cut_short:
        warn(f"{arguments.evidence}: not written: evidence is of whole campaigns")
    elif texts is not None:
        write_campaign(arguments.evidence, texts, results, conducted.summary, specs, same)
    if folder is not None and (remark := left_over(folder, before)):
        warn(remark)
    if kept is not None and results.cut_short:
        warn(f"{kept.path}: the same command plays what is left")
    elif kept is not None:
        kept.remove()
    return conducted


def _refuse_nothing(chosen: Plan) -> None:
    """Say why no test is to be played.

    Raises:
        TestError: always.
    """
    tests = [test for several in chosen.tests.values() for test in several]
    robots = " and ".join(chosen.campaign.robots)
    written_for = " and ".join(sorted({test.robot for test in tests if test.robot is not None}))
    made_by = ", ".join(f"`{name}`" for name in chosen.tests)
    why = f"all of {made_by} are for the robot {written_for}" if tests else f"{made_by} makes none"
    raise TestError(f"no test for the robot {robots}: {why}: choose another robot or strategy")


def written(
    results: Results,
    specs: Mapping[str, Spec],
    folder: Path | None,
    arguments: Namespace,
    again: str,
    spool: Path | None = None,
) -> Conducted:
    """Count what came out, and write it to a folder.

    Args:
        results: of the tests.
        specs: the specifications that judged them.
        folder: for tables, tests and pages; `None` writes nothing.
        arguments: the options of `add_playing_options`.
        again: the command that runs the tests again.
        spool: has what was recorded of tests, so that they are not played again for their pages.
    """
    campaign = results.plan.campaign
    summary = summarise(results, specs)
    tables = campaign.presentation.tables(summary)
    if folder is None:
        return Conducted(results, summary, tables)
    with busy("writing tables"):
        write_tables(folder, summary, tables, campaign.presentation)
        write_tests(folder, results)
        played = frozenset(played.job.test.strategy for played in results.played)
        campaign.presentation.write_more(folder, played)
    witnesses = {test for table in tables.values() for test in table.witnesses.values()}
    examples = choose_examples(results.played, also=witnesses, every=arguments.pages == "all")
    with bar("pages", len(examples.jobs)) as show:
        otherwise = write_pages(
            folder,
            summary,
            tables,
            results,
            again,
            examples=examples,
            jobs=arguments.jobs,
            progress=show,
            spool=spool,
        )
    if otherwise:
        warn(
            f"played again, these came out otherwise: {', '.join(otherwise)}: a run must "
            "depend on its test alone, and its random numbers on the test's seed"
        )
    return Conducted(results, summary, tables)


def show(campaign: Campaign, conducted: Conducted, form: str) -> None:
    """Print a campaign's figures."""
    summary = conducted.summary
    if form == "json":
        say_json(to_json(campaign.presentation.document(summary)).decode().removesuffix("\n"))
        return
    console = Terminal() if sys.stdout.isatty() else Terminal(width=100)
    print_summary(summary, conducted.tables, console, campaign.presentation.foremost)
    work = campaign.presentation.work(summary)
    console.print(f"{summary.finished} tests in {summary.seconds:.1f} s: {work}.")
    if summary.cut_short:
        console.print(
            f"{summary.cut_short}: {summary.finished} of {summary.planned} tests were finished; "
            "the tables are partial",
            style="yellow",
        )
