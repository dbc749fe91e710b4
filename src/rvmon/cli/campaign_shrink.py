"""Shrink one failing test of a campaign."""

from __future__ import annotations

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.plan import Job, Outcome
from rvmon.cdv.play import play_apart, player
from rvmon.cdv.shrink import Shrunk, regression_test, removed, save_regression, shrink
from rvmon.cdv.test import Test, to_json
from rvmon.cdv.test import load as load_test
from rvmon.cli.campaign_replay import robot_of
from rvmon.cli.output import busy, say_json, warn
from rvmon.coverage.record import Ending
from rvmon.report.folder import made


def shrink_file(
    campaign: Campaign, path: str, robot: str | None, requirement: str | None, out: str | None
) -> int:
    """Shrink a test file, show what is left, and return an exit code: 1 if it does not fail.

    Args:
        campaign: that the test is of.
        path: of the file.
        robot: its name; `None`: the one that the test names, else the campaign's first.
        requirement: that is to fail; `None`: the first that does, or how the run ends.
        out: folder for the regression test.
    """
    test = load_test(path, campaign.test)
    job = Job(test, robot_of(campaign, test, robot))
    folder = made(out) if out else None  # reported before anything is played
    with busy("shrinking"):
        found = _found(campaign, job, requirement)
    if found is None:
        why = f"{requirement} does not fail" if requirement else "no requirement fails"
        warn(f"{path}: {why}: there is nothing to shrink")
        return 1
    small = regression_test(campaign, job, found)
    left = removed(test, small)
    say_json(to_json(small).decode().removesuffix("\n"))
    if not found.is_minimal:
        warn("it was ended early: an even smaller test may fail alike")
    if not test.removable:
        warn(f"`{type(test).__name__}` names nothing in `removable`: only values can be simpler")
    warn(f"{found.failure}: {left or 'values'}; {found.tried} tests in {found.seconds:.1f} s")
    if folder is not None:
        for written in save_regression(campaign, small, folder):
            warn(f"written: {written}")
    return 0


def _found(campaign: Campaign, job: Job, requirement: str | None) -> Shrunk[Test] | None:
    """The smallest test; where the run hangs or is lost, each is played in a process of its own."""
    outcome = play_apart(campaign, job)
    here = None
    if outcome.ending in (Ending.COMPLETED, Ending.CRASHED):
        here = player({job.robot: campaign.robots[job.robot]}, None, None)

    def play(test: Test) -> Outcome:
        again = Job(test, job.robot)
        return play_apart(campaign, again) if here is None else here(again)[0]

    return shrink(job.test, outcome, play, requirement)
