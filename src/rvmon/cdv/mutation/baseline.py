"""Play a suite on the unchanged code and record it, as the baseline for mutants."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import zip_longest

from rvmon.cdv.campaign import Campaign, Robot
from rvmon.cdv.code_coverage import code_groups, statements_name
from rvmon.cdv.mutation.python_mutants import Mutant
from rvmon.cdv.play import Bench, Progress, Recorded
from rvmon.cdv.system import Code, Values
from rvmon.cdv.test import Test
from rvmon.coverage import Subject
from rvmon.errors import RvmonError
from rvmon.execute import parallel
from rvmon.session import Spec


@dataclass(frozen=True, slots=True)
class Difference:
    """The first difference of a mutant's run from that of the unchanged code."""

    test: str  # the name of the test
    t_ns: int  # the instant of the difference
    name: str  # the signal or event, or `state` of the robot; empty: the runs end at other instants
    was: str  # the original value; empty: none
    now: str  # the mutant's value; empty: none
    # Requirements with another verdict, none of them a new failure: id, verdict before and after.
    verdicts: tuple[tuple[str, str, str], ...] = ()


def recorder(name: str, robot: Robot, code: Code | None = None) -> Callable[[Test], Recorded]:
    """Make a function that plays and records tests here, measuring the coverage of `code`."""
    bench = Bench(name, robot, code)

    def play(test: Test) -> Recorded:
        played = bench.play(test, keeps=True)
        # Only the verdicts of the report are compared, so its attempts need not be sent.
        return played._replace(report=replace(played.report, attempts=()))

    return play


def difference(test: str, was: Recorded, now: Recorded) -> Difference | None:
    """The first difference between two recorded runs of a test, or `None`."""
    verdicts = tuple(
        (name, verdict.value, now.verdicts[name].value)
        for name, verdict in was.verdicts.items()
        if now.verdicts[name] is not verdict
    )
    places = [
        place
        for place in (
            _first_difference(was.samples, now.samples),
            _first_difference(_states(was), _states(now)),
            None if was.run.end_ns == now.run.end_ns else (now.run.end_ns, "", "", ""),
        )
        if place is not None
    ]
    if not places:
        return None
    return Difference(test, *min(places, key=lambda place: place[0]), verdicts)


def _states(recorded: Recorded) -> Sequence[tuple[int, Values]]:
    return [(t_ns, {"state": state}) for t_ns, state in recorded.run.states]


_AFTER_END: tuple[int, Values] = (2**63, {})
"""Stands for a sample after the last one, later than all others."""


def _first_difference(
    was: Sequence[tuple[int, Values]], now: Sequence[tuple[int, Values]]
) -> tuple[int, str, str, str] | None:
    for (t_was, before), (t_now, after) in zip_longest(was, now, fillvalue=_AFTER_END):
        t_ns = min(t_was, t_now)
        if place := _first_value(
            t_ns, before if t_was == t_ns else {}, after if t_now == t_ns else {}
        ):
            return place
    return None


def _first_value(t_ns: int, was: Values, now: Values) -> tuple[int, str, str, str] | None:
    for name in {**was, **now}:
        before, after = _as_text(was, name), _as_text(now, name)
        if before != after:
            return t_ns, name, before, after
    return None


def _as_text(values: Values, name: str) -> str:
    """A value as text with all its digits; as text, NaN equals NaN."""
    if name not in values:
        return ""
    value = values[name]
    return "unknown" if value is None else str(value)


@dataclass(frozen=True)
class Suite:
    """A robot with tests that were played and recorded on its unchanged code."""

    name: str  # of the robot
    robot: Robot
    spec: Spec  # that judges it
    code: Code  # that is mutated
    tests: Mapping[str, Test]  # by name
    recorded: Mapping[str, Recorded]  # by name of the test
    left_out: Mapping[str, str]  # tests that gave no result, by name, each with the reason

    def reaching(self, mutant: Mutant) -> list[str]:
        """The names of the tests that run the changed statement; of a constant, all tests."""
        path = str(mutant.path)
        if mutant.function in self.code.constants.get(path, ()):
            return list(self.tests)
        statements = self._statements[path]
        statement = str(statements[bisect_right(statements, mutant.line) - 1])
        groups = [statements_name(one.name) for one in self.code.blocks if one.path == path]
        return [
            name
            for name, recorded in self.recorded.items()
            if any(statement in recorded.hits.get(group, ()) for group in groups)
        ]

    @cached_property
    def _statements(self) -> dict[str, list[int]]:
        """The first lines of the statements of each file, ascending."""
        groups = [group for group in code_groups(self.code) if group.subject is Subject.STATEMENTS]
        lines_of: dict[str, list[int]] = {}
        for block, group in zip(self.code.blocks, groups, strict=True):
            lines_of.setdefault(block.path, []).extend(map(int, group.items))
        return {path: sorted(lines) for path, lines in lines_of.items()}


def mutated_code(campaign: Campaign) -> Code:
    """The code of a campaign, which is to be mutated.

    Raises:
        RvmonError: the campaign names no code.
    """
    if campaign.code is None:
        raise RvmonError(f"campaign `{campaign.name}` names no code: give it `code` to be mutated")
    return campaign.code


def record_suite(
    campaign: Campaign,
    robot: str,
    tests: Sequence[Test],
    *,
    jobs: int,
    progress: Progress | None = None,
) -> Suite:
    """Play tests on the unchanged robot and record them.

    Tests for another robot, or with a planted fault, are skipped.

    Raises:
        RvmonError: the campaign measures no code, the robot has no requirements, or no test gives a
            result.
    """
    under_test = campaign.robots[robot]
    code = mutated_code(campaign)
    spec = campaign.requirements_of(robot)
    usable = [test for test in tests if test.mutation is None and test.robot in (None, robot)]
    recorded: dict[str, Recorded] = {}
    left_out: dict[str, str] = {}
    with closing(
        parallel.execute(
            usable,
            partial(recorder, robot, under_test, code),
            jobs=jobs,
            what="test",
            instead=lambda _, ended: ended.why,
            timeout_s=campaign.timeout_s,
        )
    ) as results:
        for number, (test, result) in enumerate(zip(usable, results, strict=True), start=1):
            if isinstance(result, Recorded) and result.run.error is None:
                recorded[test.name] = result
            else:
                error = result.run.error if isinstance(result, Recorded) else str(result)
                left_out[test.name] = error or ""
            if progress is not None:
                progress(number)
    if not recorded:
        why = next(iter(left_out.values()), "it has no test for this robot without a planted fault")
        raise RvmonError(f"the suite has no result for robot `{robot}`: {why}")
    used = {test.name: test for test in usable if test.name in recorded}
    return Suite(robot, under_test, spec, code, used, recorded, left_out)
