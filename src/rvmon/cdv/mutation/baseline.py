"""A suite played on the code as it is, with all that is recorded: what mutants are compared to."""

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
    """The first difference of a run from that of the unchanged code."""

    test: str  # the played test
    t_ns: int  # the instant; of a difference at the end of the run, that
    name: str  # the signal or event; `state`: of the robot; empty: the run's end itself
    was: str  # its value; empty: none
    now: str  # its value with the change; empty: none
    # requirements that are judged otherwise, none of them F: verdicts before and after
    verdicts: tuple[tuple[str, str, str], ...] = ()


def recorder(name: str, robot: Robot, code: Code | None = None) -> Callable[[Test], Recorded]:
    """A function that plays tests of a robot here; `code`: whose statements are measured."""
    bench = Bench(name, robot, code)

    def play(test: Test) -> Recorded:
        played = bench.play(test, keeps=True)
        # Of the report the verdicts are compared: what each attempt was need not be sent.
        return played._replace(report=replace(played.report, attempts=()))

    return play


def difference(test: str, was: Recorded, now: Recorded) -> Difference | None:
    """The first difference between two recorded runs of a test; `None`: there is none."""
    verdicts = tuple(
        (name, verdict.value, now.verdicts[name].value)
        for name, verdict in was.verdicts.items()
        if now.verdicts[name] is not verdict
    )
    places = [
        place
        for place in (
            _of_samples(was.samples, now.samples),
            _of_samples(_states(was), _states(now)),
            None if was.run.end_ns == now.run.end_ns else (now.run.end_ns, "", "", ""),
        )
        if place is not None
    ]
    if not places:
        return None
    return Difference(test, *min(places, key=lambda place: place[0]), verdicts)


def _states(recorded: Recorded) -> Sequence[tuple[int, Values]]:
    return [(t_ns, {"state": state}) for t_ns, state in recorded.run.states]


_OVER: tuple[int, Values] = (2**63, {})
"""Stands for a sample behind the last one."""


def _of_samples(
    was: Sequence[tuple[int, Values]], now: Sequence[tuple[int, Values]]
) -> tuple[int, str, str, str] | None:
    for (t_was, before), (t_now, after) in zip_longest(was, now, fillvalue=_OVER):
        t_ns = min(t_was, t_now)
        if place := _first(t_ns, before if t_was == t_ns else {}, after if t_now == t_ns else {}):
            return place
    return None


def _first(t_ns: int, was: Values, now: Values) -> tuple[int, str, str, str] | None:
    for name in {**was, **now}:
        before, after = _as_text(was, name), _as_text(now, name)
        if before != after:
            return t_ns, name, before, after
    return None


def _as_text(values: Values, name: str) -> str:
    """A value as text, all digits of it; NaN is as NaN."""
    if name not in values:
        return ""
    value = values[name]
    return "unknown" if value is None else str(value)


@dataclass(frozen=True)
class Suite:
    """A robot, and tests that were played on it."""

    name: str
    robot: Robot
    spec: Spec
    code: Code
    tests: Mapping[str, Test]
    recorded: Mapping[str, Recorded]
    left_out: Mapping[str, str]

    def reaching(self, mutant: Mutant) -> list[str]:
        """The tests that run the changed statement; of a constant all, as nothing runs it."""
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
    """The code of a campaign that is to be mutated.

    Raises:
        RvmonError: it names none.
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
    """Play tests on a robot as it is, but those for another one, or with a fault of their own.

    Raises:
        RvmonError: the campaign measures no code, the robot has no requirements, or no test is
            left.
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
