"""A shrunk test as a regression test: a file that knows its answer, and a test of pytest."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

from msgspec import structs

from rvmon.cdv.abstract_test import Test, VerdictName
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.files import save
from rvmon.cdv.plan import Job
from rvmon.cdv.shrink import Shrunk
from rvmon.execute import parallel
from rvmon.writing import write_whole

_FILE = '''"""{found}"""

import subprocess
import sys
from pathlib import Path

TEST = Path(__file__).with_name({test})


def test_{function}():
    """{law}."""
    command = [{command}, "replay", TEST, "--expected"]
    assert subprocess.run(command, timeout={timeout}).returncode == 0
'''


def regression_test(campaign: Campaign, job: Job, shrunk: Shrunk[Test]) -> Test:
    """The smallest test, by a name of its own, with what is to come out.

    A test that is made to fail, or has a fault planted into its robot, is to fail again: it finds
    the fault. Any other is to pass: it fails until the robot is fixed.

    Args:
        campaign: that the test is of.
        job: the test that was shrunk.
        shrunk: what came of it.
    """
    test, failure = job.test, shrunk.failure
    finds = test.mutation is not None or test.expected.get(failure.requirement) == "F"
    expected: dict[str, VerdictName] = {}
    if failure.requirement:
        expected = {failure.requirement: "F" if finds else "P"}
    elif finds:
        expected = {name: verdict.value for name, verdict in shrunk.outcome.verdicts.items()}
    only = job.robot if len(campaign.robots) > 1 else test.robot
    return structs.replace(
        shrunk.test,
        name=small_name(test),
        text=f"the smallest test in which {failure}, as in {test.name}",
        robot=only,
        expected=expected,
        reaches={},
    )


def small_name(test: Test) -> str:
    """What the smallest test like this one is called."""
    return f"{test.name}-small"


def save_regression(campaign: Campaign, test: Test, folder: Path) -> tuple[Path, Path]:
    """Write a regression test as `NAME.json` and `test_NAME.py`, and return these paths.

    Args:
        campaign: that the test is of.
        test: what `regression_test` made.
        folder: of both files.
    """
    function = re.sub(r"\W", "_", test.name)
    text = _FILE.format(
        found=f"Replays {test.name}, and sees that it comes out as it should.",
        test=json.dumps(f"{test.name}.json"),
        function=function,
        law=", ".join(f"{name} is {verdict}" for name, verdict in test.expected.items())
        or "It completes",
        command=_command(campaign.program, folder),
        timeout=None if campaign.timeout_s is None else campaign.timeout_s + parallel.BEGIN_S,
    )
    path = folder / f"test_{function}.py"
    write_whole(path, text)
    return save(test, folder), path


def removed(before: Test, after: Test) -> str:
    """How much of a test is left, in words.

    Args:
        before: as it was.
        after: as it is now.
    """
    fields = ((name, getattr(before, name), getattr(after, name)) for name in before.removable)
    return ", ".join(f"{len(new)} of {len(old)} {name}" for name, old, new in fields)


def _command(program: str, folder: Path) -> str:
    """The command line of the campaign, as Python in a file of that folder."""
    if program:
        return f"Path(sys.executable).with_name({json.dumps(program)})"
    script = os.path.relpath(sys.argv[0], folder)
    return f"sys.executable, Path(__file__).parent / {json.dumps(script)}"
