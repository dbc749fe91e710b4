"""The commands `run`, `replay` and `shrink` of a campaign."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from tempfile import TemporaryDirectory

from msgspec import Struct

from rvmon.cdv import campaign_text, gate, tables
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_page import choose_examples, comparable_jobs
from rvmon.cdv.campaign_plan import Job, Plan, Played, Results, plan, plan_of_folder
from rvmon.cdv.campaign_summary import CampaignSummary
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.outcome_counts import summarise
from rvmon.cdv.play import INTERRUPTED, Bench, PlayerApart, execute, outcome_of
from rvmon.cdv.replay_pages import Replay, play_again, replay_page, write_pages
from rvmon.cdv.resume import unfinished
from rvmon.cdv.sequential_test import Decision
from rvmon.cdv.shrink import regression_test, removed, save_regression, shrink
from rvmon.cdv.tables import RobotTables
from rvmon.cdv.test import TestError, to_json
from rvmon.cdv.test import load as load_test
from rvmon.cli.campaign_evidence import requirement_texts, write_campaign
from rvmon.cli.output import bar, busy, say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.files import output_folder, refuse_no_file, write_file, write_whole
from rvmon.report.printer import TEXT_WIDTH, Printer
from rvmon.report.run_text import print_report
from rvmon.report.verdicts_mcap import refuse_mcap, write_verdicts
from rvmon.session import Spec
from rvmon.texts import counted
from rvmon.verdicts import Verdict


class Conducted(Struct, frozen=True):
    """A finished or interrupted campaign."""

    results: Results
    summary: CampaignSummary
    tables: Mapping[str, RobotTables]

    @property
    def interrupted(self) -> bool:
        """Whether a person ended it before all tests were played."""
        return self.results.cut_short == INTERRUPTED

    def judged(self, *, strict: bool) -> gate.CampaignJudgement:
        """Compare the verdicts with the expected ones; if `strict`, I and NT are wrong."""
        robots = self.summary.robots.items()
        requirements = {name: tuple(robot.requirements) for name, robot in robots}
        shares: dict[gate.RobotRequirement, dict[str, Decision]] = {}
        for name, robot in robots:
            for strategy, figures in robot.strategies.items():
                for requirement, decision in figures.shares.items():
                    shares.setdefault((name, requirement), {})[strategy] = decision
        return gate.judge_campaign(self.results, requirements, shares, strict=strict)


def conduct(
    campaign: Campaign,
    strategies: Sequence[str],
    arguments: Namespace,
    words: Sequence[object],
    stack: ExitStack,
) -> Conducted:
    """Plan a campaign, load its requirements, play the tests, count and write the results.

    Temporary folders are entered in `stack`.
    """
    if arguments.shard is not None and not arguments.out:
        raise RvmonError("--shard writes its results to a folder: name it with --out")
    if arguments.shard is not None and arguments.evidence:
        raise RvmonError("--evidence covers all tests: give it to the command that joins shards")
    folder = output_folder(arguments.out) if arguments.out else None
    before = campaign_text.dated_files(folder) if folder is not None else {}
    with busy("generating tests"):
        if arguments.suite is not None:
            chosen = plan_of_folder(campaign, arguments.suite)
        else:
            chosen = plan(campaign, strategies, tests=arguments.tests, seed=arguments.seed)
    # Errors in requirements and coverage models are reported before any test is played.
    specs = campaign.requirements
    for name in campaign.robots if folder is not None else ():
        coverage_model(campaign, name)
    planned = len(chosen.jobs())
    if not planned:
        _refuse_nothing(chosen)
    texts = None if arguments.evidence is None else requirement_texts(campaign, arguments.evidence)
    command, *others = words
    amount = ["--tests", arguments.tests, "--seed", arguments.seed]
    if arguments.suite is not None:
        amount = ["--suite", arguments.suite]
    same = [command, *amount, *others]
    again = campaign_text.typed(campaign.program, [*same, "--out", arguments.out])
    kept = None
    if folder is not None:
        kept = unfinished(folder, chosen, specs, again, arguments.shard)
        planned = len(kept.jobs)
        if kept.known:
            warn(f"{len(kept.known)} of {planned} tests were played before")
    jobs, spool = arguments.dask or arguments.jobs, None
    # For pages of all runs, each run is recorded when it is played, not played again.
    if folder is not None and arguments.pages == "all":
        spool = Path(stack.enter_context(TemporaryDirectory(prefix="rvmon-")))
    with bar("tests", planned) as show:
        results = execute(chosen, jobs=jobs, kept=kept, progress=show, spool=spool)
    if kept is not None and kept.shard is not None and len(results.played) == planned:
        warn(f"{kept.path}: the same command without --shard joins the shards in this folder")
        # The folder is written by the command that joins the shards.
        return written(results, specs, None, arguments, again)
    conducted = written(results, specs, folder, arguments, again, spool)
    if texts is not None and results.cut_short:
        warn(f"{arguments.evidence}: not written: evidence needs a complete campaign")
    elif texts is not None:
        write_campaign(arguments.evidence, texts, results, conducted.summary, specs, same)
    if folder is not None and (remark := campaign_text.left_over(folder, before)):
        warn(remark)
    if kept is not None and results.cut_short:
        warn(f"{kept.path}: the same command plays the rest")
    elif kept is not None:
        kept.remove()
    return conducted


def _refuse_nothing(chosen: Plan) -> None:
    """Raise the error that the plan has no test, with the reason."""
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
    """Count the results and write them to `folder`, if given.

    Args:
        results: the outcomes of all played tests.
        specs: the requirements by robot.
        folder: the output folder; `None`: nothing is written.
        arguments: the command line.
        again: the command line that repeats the run, for pages.
        spool: folder with the recordings of runs; `None`: runs are played again for their pages.
    """
    campaign = results.plan.campaign
    summary = summarise(results, specs)
    tables = campaign.presentation.tables(summary)
    if folder is None:
        return Conducted(results, summary, tables)
    with busy("writing tables"):
        campaign_text.write_tables(folder, summary, tables, campaign.presentation)
        campaign_text.write_tests(folder, results)
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
            f"played again, these gave other results: {', '.join(otherwise)}: a run must depend "
            "only on its test, and its random numbers only on the test's seed"
        )
    return Conducted(results, summary, tables)


def show(campaign: Campaign, conducted: Conducted, form: str) -> None:
    """Print the tables of a campaign as text or JSON."""
    summary = conducted.summary
    if form == "json":
        say_json(
            tables.to_json(campaign.presentation.document(summary)).decode().removesuffix("\n")
        )
        return
    printer = page_printer()
    campaign_text.print_summary(summary, conducted.tables, printer, campaign.presentation.foremost)
    work = campaign.presentation.work(summary)
    printer.sentences(f"{counted(summary.finished, 'test')} in {summary.seconds:.1f} s: {work}.")
    if summary.cut_short:
        printer.sentences(
            f"{summary.cut_short}: {summary.finished} of {summary.planned} tests were finished; "
            "the tables are partial",
            "yellow",
        )


def page_printer() -> Printer:
    """A printer to standard output; if that is no terminal, as wide as the files of a campaign."""
    return Printer(width=None if sys.stdout.isatty() else TEXT_WIDTH)


SHOWN = 20  # the most deviations printed; `--junit` writes all


def is_as_expected(
    campaign: Campaign, judgement: gate.CampaignJudgement, arguments: Namespace
) -> bool:
    """Print all deviations, and write JUnit XML if requested; return whether there are none."""
    if arguments.junit is not None:
        write_file(arguments.junit, gate.junit_xml(campaign.name, judgement))
    for what, count in judgement.known.items():
        warn(f"{what} ({counted(count, 'test')})")
    wrong = judgement.wrong
    for what in wrong[:SHOWN]:
        warn(f"not as expected: {what}")
    if len(wrong) > SHOWN:
        warn(f"not as expected: … and {len(wrong) - SHOWN:,} more: --junit FILE has all")
    return not wrong


def replay(campaign: Campaign, arguments: Namespace) -> int:
    """Play a test file, judge it, and return an exit code: 1 if a requirement failed.

    With `--expected`, the exit code is 1 if a verdict is not the expected one.
    """
    job = _job(campaign, arguments)
    robot = campaign.robots[job.robot]
    spec = campaign.requirements_of(job.robot)
    # A folder that cannot be written to is reported before anything is played.
    folder = output_folder(arguments.out) if arguments.out else None
    if arguments.mcap is not None:
        refuse_mcap(arguments.mcap)
        refuse_no_file(arguments.mcap)
    bench = Bench(job.robot, robot)
    played = play_again(job.test, bench)
    judged = played.judged.report, played.judged.samples
    _show(arguments.format, spec, played)
    if arguments.mcap is not None:
        write_verdicts(arguments.mcap, spec.checked, *judged, played.recorded.run.scene)
    if folder is not None:
        words: list[object] = ["replay", arguments.test]
        words += [] if arguments.robot is None else ["--robot", arguments.robot]
        others = [
            play_again(one.test, bench, wants_scene=False).judged
            for one in comparable_jobs(job, (), ())
        ]
        command = campaign_text.typed(campaign.program, words)
        page = replay_page(played, job.robot, spec, command=command, others=others)
        # Named after the test's file, because the name inside the test is not a safe path.
        name = Path(arguments.test).stem
        write_whole(folder / f"{name}.html", page)
        lines = [json.dumps({"t_ns": sample.t, **sample.values}) + "\n" for sample in judged[1]]
        write_whole(folder / f"{name}.jsonl", "".join(lines))
    if arguments.expected:
        wrong = gate.judge_test(
            Played(job, outcome_of(played.recorded)), campaign.expected_failures
        ).wrong
        for what in wrong:
            warn(f"not as expected: {what}")
        return int(bool(wrong))
    return int(Verdict.FAIL in judged[0].verdicts.values())


def shrink_file(campaign: Campaign, arguments: Namespace) -> int:
    """Shrink a test file, print the result, and return an exit code: 1 if it does not fail."""
    job, requirement = _job(campaign, arguments), arguments.requirement
    # A folder that cannot be written to is reported before anything is played.
    folder = output_folder(arguments.out) if arguments.out else None
    # In a process of its own, so that a smaller test may hang or crash without harm.
    with busy("shrinking"), closing(PlayerApart(campaign, job.robot)) as player:
        smallest = shrink(job.test, player.play(job.test), player.play, requirement)
    if smallest is None:
        why = f"{requirement} does not fail" if requirement else "no requirement fails"
        warn(f"{arguments.test}: {why}: there is nothing to shrink")
        return 1
    small = regression_test(campaign, job, smallest)
    left = removed(job.test, small)
    say_json(to_json(small).decode().removesuffix("\n"))
    if not smallest.is_minimal:
        warn("shrinking was stopped early: an even smaller test may fail in the same way")
    if not job.test.removable:
        kind = type(job.test).__name__
        warn(f"`{kind}` names nothing in `removable`: only values can be simpler")
    effort = f"{counted(smallest.tried, 'test')} in {smallest.seconds:.1f} s"
    warn(f"{smallest.failure}: {left or 'values'}; {effort}")
    if folder is not None:
        for written in save_regression(campaign, small, folder):
            warn(f"written: {written}")
    return 0


def _job(campaign: Campaign, arguments: Namespace) -> Job:
    """The test on the robot of `--robot`, else on its own, else on the campaign's first."""
    test = load_test(arguments.test, campaign.test)
    name = arguments.robot or test.robot or next(iter(campaign.robots))
    if name not in campaign.robots:
        raise UnknownNameError(f"no robot `{name}`: there are {', '.join(campaign.robots)}")
    return Job(test, name)


def _show(form: str, spec: Spec, played: Replay) -> None:
    report, error = played.judged.report, played.recorded.run.error
    if form == "json":
        say_json(report.to_json())
        return
    printer = Printer()
    print_report(report, spec.checked, printer)
    if error is not None:
        printer.line((f"The robot's code crashed: {error}", "bold red"))
