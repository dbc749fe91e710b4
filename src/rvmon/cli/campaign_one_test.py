"""Play one test of a campaign again, alone, or shrink it."""

from __future__ import annotations

import json
from argparse import Namespace
from contextlib import closing
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_page import comparable_jobs
from rvmon.cdv.campaign_plan import Job, Played
from rvmon.cdv.campaign_text import typed
from rvmon.cdv.gate import judge_test
from rvmon.cdv.play import Bench, PlayerApart, outcome_of
from rvmon.cdv.replay_pages import Replay, play_again, replay_page
from rvmon.cdv.shrink import Shrunk, regression_test, removed, save_regression, shrink
from rvmon.cdv.test import Test, to_json
from rvmon.cdv.test import load as load_test
from rvmon.cli.output import busy, say_json, warn
from rvmon.errors import UnknownNameError
from rvmon.files import write_whole
from rvmon.report.folder import output_folder, refuse_no_file
from rvmon.report.run_text import print_report
from rvmon.report.terminal import Terminal
from rvmon.report.verdicts_mcap import refuse_mcap, write_verdicts
from rvmon.session import Spec
from rvmon.verdicts import Verdict


def replay(campaign: Campaign, arguments: Namespace) -> int:
    """Play a test file again, judge it, and return an exit code: 1 if a requirement failed."""
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
        command = typed(campaign.program, words)
        page = replay_page(played, job.robot, spec, command=command, others=others)
        # The file is named after the test's file: what it says inside is no path.
        name = Path(arguments.test).stem
        write_whole(folder / f"{name}.html", page)
        lines = [json.dumps({"t_ns": sample.t, **sample.values}) + "\n" for sample in judged[1]]
        write_whole(folder / f"{name}.jsonl", "".join(lines))
    if arguments.expected:
        wrong = judge_test(
            Played(job, outcome_of(played.recorded)), campaign.expected_failures
        ).wrong
        for what in wrong:
            warn(f"not as expected: {what}")
        return int(bool(wrong))
    return int(Verdict.FAIL in judged[0].verdicts.values())


def shrink_file(campaign: Campaign, arguments: Namespace) -> int:
    """Shrink a test file, show what is left, and return an exit code: 1 if it does not fail."""
    job, requirement = _job(campaign, arguments), arguments.requirement
    # A folder that cannot be written to is reported before anything is played.
    folder = output_folder(arguments.out) if arguments.out else None
    with busy("shrinking"):
        found = _smallest(campaign, job, requirement)
    if found is None:
        why = f"{requirement} does not fail" if requirement else "no requirement fails"
        warn(f"{arguments.test}: {why}: there is nothing to shrink")
        return 1
    small = regression_test(campaign, job, found)
    left = removed(job.test, small)
    say_json(to_json(small).decode().removesuffix("\n"))
    if not found.is_minimal:
        warn("it was ended early: an even smaller test may fail alike")
    if not job.test.removable:
        kind = type(job.test).__name__
        warn(f"`{kind}` names nothing in `removable`: only values can be simpler")
    warn(f"{found.failure}: {left or 'values'}; {found.tried} tests in {found.seconds:.1f} s")
    if folder is not None:
        for written in save_regression(campaign, small, folder):
            warn(f"written: {written}")
    return 0


def _job(campaign: Campaign, arguments: Namespace) -> Job:
    """The test, on the robot that was asked for, else its own, else the campaign's first.

    Raises:
        UnknownNameError: there is no such robot.
    """
    test = load_test(arguments.test, campaign.test)
    name = arguments.robot or test.robot or next(iter(campaign.robots))
    if name not in campaign.robots:
        raise UnknownNameError(f"no robot `{name}`: there are {', '.join(campaign.robots)}")
    return Job(test, name)


def _smallest(campaign: Campaign, job: Job, requirement: str | None) -> Shrunk[Test] | None:
    """The smallest test; a smaller one may hang, or be lost, and does no harm."""
    with closing(PlayerApart(campaign, job.robot)) as player:
        return shrink(job.test, player.play(job.test), player.play, requirement)


def _show(form: str, spec: Spec, played: Replay) -> None:
    report, error = played.judged.report, played.recorded.run.error
    if form == "json":
        say_json(report.to_json())
        return
    console = Terminal()
    print_report(report, spec.checked, console)
    if error is not None:
        console.print(f"The robot's code crashed: {error}", style="bold red")
