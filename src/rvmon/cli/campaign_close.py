"""The command `close` of a campaign: generate tests for the holes, keep the smallest suite."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace

import msgspec

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_plan import Plan, Results
from rvmon.cdv.campaign_text import TESTS, dated_files, left_over, typed
from rvmon.cdv.close import MARGIN, Budget, Closed, close
from rvmon.cdv.close.faults import with_mutants
from rvmon.cdv.close.outcome import closed_document, print_closed
from rvmon.cdv.gate import CampaignJudgement
from rvmon.cdv.tables import to_json
from rvmon.cli.campaign_run import page_printer, written
from rvmon.cli.output import bar, say, say_json, warn
from rvmon.files import output_folder, write_whole
from rvmon.report.printer import text_of


def conduct_closing(
    campaign: Campaign,
    robot: str,
    strategies: Sequence[str],
    arguments: Namespace,
    words: Sequence[object],
) -> tuple[Closed, CampaignJudgement]:
    """Close holes, print the result and write the suite; returns result and judgement."""
    campaign = replace(campaign, robots={robot: campaign.robots[robot]})
    folder = output_folder(arguments.out) if arguments.out else None
    before = dated_files(folder) if folder is not None else {}
    specs = campaign.requirements
    with bar("goals", 1.0) as show:
        closed = close(
            campaign,
            robot,
            seed=arguments.seed,
            strategies=strategies,
            margin=arguments.margin,
            budget=Budget(arguments.tests, arguments.seconds),
            jobs=arguments.dask or arguments.jobs,
            progress=lambda met, goals: show(met / goals),
        )
    if arguments.mutants is not None:
        jobs = arguments.jobs or os.cpu_count() or 1
        with bar("mutants", 1.0) as show:
            closed = with_mutants(
                campaign, robot, closed, arguments.mutants, jobs=jobs, progress=show
            )
    amount: list[object] = ["--tests", arguments.tests, "--seed", arguments.seed]
    amount += ["--strategy", ",".join(strategies)] if strategies else []
    if arguments.margin != MARGIN:
        amount += ["--margin", arguments.margin]
    if arguments.mutants is not None:
        amount += ["--mutants", arguments.mutants]
    if arguments.seconds is not None:
        amount += ["--seconds", arguments.seconds]
    command, *others = words
    again = typed(campaign.program, [command, *amount, *others, "--out", arguments.out])
    conducted = written(_suite(campaign, arguments.seed, closed), specs, folder, arguments, again)
    if folder is not None:
        text = text_of(lambda printer: print_closed(closed, printer))
        write_whole(folder / "closing.txt", text)
        write_whole(folder / "closing.json", to_json(closed_document(closed)))
        if remark := left_over(folder, before):
            warn(remark)
    if arguments.format == "json":
        say_json(msgspec.json.encode(closed_document(closed)).decode())
    else:
        print_closed(closed, page_printer())
        if folder is not None:
            replayed = typed(campaign.program, ["run", *others, "--suite", folder / TESTS])
            say(f"Play the suite again: {replayed}")
    return closed, conducted.judged(strict=False)


def _suite(campaign: Campaign, seed: int, closed: Closed) -> Results:
    tests = [played.job.test for played in closed.suite]
    plan = Plan(campaign, seed, {test.strategy: tests for test in tests})
    seconds = sum(played.outcome.seconds for played in closed.suite)
    return Results(plan, tuple(closed.suite), seconds, "", closed.groups, closed.proofs)
