"""A suite as it is on the code as it is: what mutants are held against."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property, partial

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.campaign import Campaign, Robot
from rvmon.cdv.checker import Checker
from rvmon.cdv.code import Code
from rvmon.cdv.meter import code_groups
from rvmon.cdv.mutation.mutant import Mutant
from rvmon.cdv.mutation.record import Recorded, Recorder
from rvmon.cdv.play import system_of
from rvmon.coverage.model import Subject
from rvmon.errors import RvmonError
from rvmon.execute import parallel
from rvmon.execute.ended import Ended
from rvmon.session import Spec, load

Progress = Callable[[int], None]
"""Called with the number of those that are done."""


@dataclass(frozen=True)
class Suite:
    """A robot, and tests that were played on it.

    Attributes:
        name: of the robot.
        robot: itself.
        spec: its requirements.
        code: its code.
        tests: by name, those that completed.
        recorded: their runs.
        left_out: tests that are of no use here, and why.
    """

    name: str
    robot: Robot
    spec: Spec
    code: Code
    tests: Mapping[str, Test]
    recorded: Mapping[str, Recorded]
    left_out: Mapping[str, str]

    def reaching(self, mutant: Mutant) -> list[str]:
        """The tests that run the changed statement; of a constant all, as nothing runs it.

        Args:
            mutant: of one of the files of the code.
        """
        path = str(mutant.path)
        if mutant.function in self.code.constants.get(path, ()):
            return list(self.tests)
        statements = self._statements[path]
        own = statements[bisect_right(statements, mutant.line) - 1]
        return [name for name, one in self.recorded.items() if own in one.lines[path]]

    @cached_property
    def _statements(self) -> dict[str, list[int]]:
        """The first lines of the statements of each file, ascending."""
        groups = [one for one in code_groups(self.code) if one.subject is Subject.STATEMENTS]
        found: dict[str, list[int]] = {}
        for block, group in zip(self.code.blocks, groups, strict=True):
            found.setdefault(block.path, []).extend(map(int, group.items))
        return {path: sorted(lines) for path, lines in found.items()}


def mutated_code(campaign: Campaign) -> Code:
    """The code of a campaign that is to be mutated.

    Raises:
        RvmonError: it names none.
    """
    if campaign.code is None:
        raise RvmonError(f"campaign `{campaign.name}` names no code: give it `code` to be mutated")
    return campaign.code


def mutated_spec(campaign: Campaign, robot: str) -> Spec:
    """The requirements of a robot.

    Raises:
        RvmonError: it has none, or they are wrong.
    """
    path = campaign.robots[robot].spec
    if path is None:
        raise RvmonError(f"robot `{robot}` has no requirements: name some by --spec")
    return load(path)


def record_suite(
    campaign: Campaign,
    robot: str,
    tests: Sequence[Test],
    *,
    jobs: int,
    progress: Progress | None = None,
) -> Suite:
    """Play tests on a robot as it is.

    Args:
        campaign: that they are of.
        robot: its name.
        tests: of the suite; those that are for another robot, or plant a fault of their own, are
            passed over.
        jobs: processes.
        progress: called as each test is played.

    Raises:
        RvmonError: the campaign measures no code, the robot has no requirements, or no test is
            left.
    """
    under_test = campaign.robots[robot]
    code = mutated_code(campaign)
    spec = mutated_spec(campaign, robot)
    own = [one for one in tests if one.mutation is None and one.robot in (None, robot)]
    recorded: dict[str, Recorded] = {}
    left_out: dict[str, str] = {}
    with closing(
        parallel.execute(
            own,
            partial(_begin, robot, under_test, spec, code),
            jobs=jobs,
            what="test",
            instead=_ended,
            timeout_s=campaign.timeout_s,
        )
    ) as results:
        for number, (test, result) in enumerate(zip(own, results, strict=True), start=1):
            if isinstance(result, Recorded) and result.run.error is None:
                recorded[test.name] = result
            else:
                error = result.run.error if isinstance(result, Recorded) else result
                left_out[test.name] = error or ""
            if progress is not None:
                progress(number)
    if not recorded:
        why = next(iter(left_out.values()), "it has no test for this robot without a planted fault")
        raise RvmonError(f"the suite has no result for robot `{robot}`: {why}")
    used = {one.name: one for one in own if one.name in recorded}
    return Suite(robot, under_test, spec, code, used, recorded, left_out)


def _begin(name: str, robot: Robot, spec: Spec, code: Code) -> Callable[[Test], Recorded | str]:
    return Recorder(system_of(name, robot), Checker(spec), code).play


def _ended(_: Test, ended: Ended) -> Recorded | str:
    return ended.why
