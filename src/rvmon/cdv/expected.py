"""Which failures of a test are known beforehand."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.cdv.campaign import ExpectedFailure
from rvmon.cdv.outcome import Played
from rvmon.verdict.verdict import Verdict


def accepted_failures(one: Played, expected: Sequence[ExpectedFailure]) -> dict[str, str]:
    """The requirements that may fail in a test, each with the reason.

    Args:
        one: the test.
        expected: what its campaign expects to fail.
    """
    accepted = {
        name: "this test is made to fail it"
        for name, verdict in one.job.test.expected.items()
        if verdict == Verdict.FAIL.value
    }
    for why in expected:
        if is_about(why, one):
            accepted.setdefault(why.requirement, why.reason)
    return accepted


def is_about(why: ExpectedFailure, one: Played) -> bool:
    """Whether a failure is expected in a test: on the robot as it is."""
    test = one.job.test
    return (
        test.mutation is None
        and why.strategy in ("", test.strategy)
        and why.test in ("", test.name)
        and why.robot in ("", one.job.robot)
    )
