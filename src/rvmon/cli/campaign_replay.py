"""Play one test of a campaign again, alone."""

from __future__ import annotations

import json
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_page import comparable_jobs
from rvmon.cdv.gate import judge_test
from rvmon.cdv.output import typed
from rvmon.cdv.pages import Replay, play_again, replay_page
from rvmon.cdv.plan import Job, Played
from rvmon.cdv.test import Test
from rvmon.cdv.test import load as load_test
from rvmon.cli.output import say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.export.verdicts_mcap import refuse_mcap, write_verdicts
from rvmon.report.folder import made, refuse_no_file
from rvmon.report.run_text import print_report
from rvmon.report.terminal import Terminal
from rvmon.session import Spec, load
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole


def replay(
    campaign: Campaign,
    path: str,
    robot: str | None,
    *,
    out: str | None,
    mcap: str | None,
    form: str,
    expected: bool = False,
) -> int:
    """Play a test file again, judge it, and return an exit code: 1 if a requirement failed.

    Args:
        campaign: that the test is of.
        path: of the file.
        robot: its name; `None`: the one that the test names, else the campaign's first.
        out: folder for the recording and a page.
        mcap: file for the verdicts and the scene.
        form: `text` for people, or `json`.
        expected: the exit code is 0 if all came out as the campaign would expect it.
    """
    test = load_test(path, campaign.test)
    name = robot_of(campaign, test, robot)
    under_test = campaign.robots[name]
    if under_test.spec is None:
        raise RvmonError(f"robot `{name}` has no requirements: name some by --spec")
    spec = load(under_test.spec)
    # A folder that cannot be written to is reported before anything is played.
    folder = made(out) if out else None
    if mcap is not None:
        refuse_mcap(mcap)
        refuse_no_file(mcap)
    played = play_again(test, name, under_test, spec)
    _show(form, spec, played)
    if mcap is not None:
        write_verdicts(mcap, spec.checked, played.report, played.samples, played.run.scene)
    if folder is not None:
        words: list[object] = ["replay", path]
        if robot is not None:
            words += campaign.presentation.robot_words(robot)
        others = [
            play_again(one.test, name, under_test, spec).judged
            for one in comparable_jobs(Job(test, name), (), ())
        ]
        command = typed(campaign.program, words)
        page = replay_page(played, name, spec, command=command, others=others)
        # The file is named after the test's file: what it says inside is no path.
        _write(folder / Path(path).stem, played, page)
    if expected:
        one = Played(Job(test, name), played.outcome)
        wrong = judge_test(one, campaign.expected_failures).wrong
        for what in wrong:
            warn(f"not as expected: {what}")
        return int(bool(wrong))
    return int(Verdict.FAIL in played.report.verdicts.values())


def robot_of(campaign: Campaign, test: Test, robot: str | None) -> str:
    """The robot that a test is played on.

    Args:
        campaign: that the test is of.
        test: the test.
        robot: that was asked for; `None`: the one that the test names, else the campaign's first.

    Raises:
        UnknownNameError: there is no such robot.
    """
    name = robot or test.robot or next(iter(campaign.robots))
    if name not in campaign.robots:
        raise UnknownNameError(f"no robot `{name}`: there are {', '.join(campaign.robots)}")
    return name


def _write(target: Path, played: Replay, page: str) -> None:
    """Write the page, and the samples as JSON lines, which `rvmon run` reads."""
    lines = [json.dumps({"t_ns": one.t, **one.values}) + "\n" for one in played.samples]
    write_whole(target.with_name(f"{target.name}.html"), page)
    write_whole(target.with_name(f"{target.name}.jsonl"), "".join(lines))


def _show(form: str, spec: Spec, played: Replay) -> None:
    if form == "json":
        say_json(played.report.to_json())
        return
    console = Terminal()
    print_report(played.report, spec.checked, console)
    if played.run.error is not None:
        console.print(f"The robot's code crashed: {played.run.error}", style="bold red")
