"""Is a campaign as expected? What is known to fail, fails; nothing else does."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.cdv.campaign import Campaign, ExpectedFailure
from rvmon.cdv.outcome import Played, Results
from rvmon.cdv.run_share import Decision
from rvmon.cdv.summary import differences
from rvmon.coverage.record import Ending
from rvmon.errors import UnknownNameError
from rvmon.loading import load
from rvmon.verdict.verdict import Verdict

RobotRequirement = tuple[str, str]
"""Names of a robot and of one of its requirements."""


@dataclass(frozen=True, slots=True)
class TestJudgement:
    """One test, held against what was expected of it.

    Attributes:
        played: the test.
        wrong: what is not as expected, each in a sentence.
        known: failures that are, each with the reason for which it is accepted.
    """

    __test__ = False

    played: Played
    wrong: tuple[str, ...]
    known: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CampaignJudgement:
    """A campaign, held against what was expected of it.

    Attributes:
        tests: each by itself, in the order of the plan.
        checks: what is asked of the tests together, in words, with what is wrong about it; empty if
            nothing is.
    """

    tests: tuple[TestJudgement, ...]
    checks: Mapping[str, str] = field(default_factory=dict)

    @property
    def wrong(self) -> list[str]:
        """All that is not as expected."""
        of_tests = [
            f"{one.played.job.test.name} ({one.played.job.robot}): {what}"
            for one in self.tests
            for what in one.wrong
        ]
        return of_tests + [f"{check}: {what}" for check, what in self.checks.items() if what]


def judge_campaign(
    results: Results,
    requirements: Mapping[str, Sequence[str]],
    shares: Mapping[RobotRequirement, Mapping[str, Decision]] | None = None,
    *,
    strict: bool = False,
) -> CampaignJudgement:
    """Hold all tests against what was expected of them.

    A test is wrong if a requirement failed that it does not know, and the campaign does not expect,
    to fail; if a verdict that it knows came out otherwise; if, on the robot as it is, something was
    hit that must not be, its code crashed, it hung or was lost. An expected failure that did not
    occur is wrong as well, unless no test was played in which it could.

    Args:
        results: what was played; of a campaign that was cut short only the tests are judged.
        requirements: by robot, the ids of those that were judged.
        shares: what the tests of each strategy say of those that are to hold in a share of runs: a
            single test that fails them is not wrong, a strategy that rejects the share is. With
            `strict` it is wrong as well that none decides it.
        strict: verdicts that are inconclusive are wrong as well, unless the test knows them, and so
            are requirements that were never triggered: that no test passed or failed.
    """
    expected = results.plan.campaign.expected_failures
    decisions = shares or {}
    tests = tuple(
        judge_test(
            one,
            expected,
            [name for robot, name in decisions if robot == one.job.robot],
            strict=strict,
        )
        for one in results.played
    )
    checks: dict[str, str] = {}
    if not results.cut_short:
        checks |= _expected_failures(expected, results.played)
        checks |= _triggered(requirements, results.played) if strict else {}
        for (robot, name), found in decisions.items():
            if not any(_is_of(why, robot, name) for why in expected):
                share = next(iter(found.values())).share
                checks[f"{name} {share} ({robot})"] = _undecided(found, strict=strict)
    return CampaignJudgement(tests, checks)


def _is_of(why: ExpectedFailure, robot: str, requirement: str) -> bool:
    return why.requirement == requirement and why.robot in ("", robot)


def _undecided(found: Mapping[str, Decision], *, strict: bool) -> str:
    """What is wrong with a share of runs; empty if it holds, or need not be decided."""
    rejected = [f"under {name} it {one}" for name, one in found.items() if one.holds is False]
    if strict and not any(one.holds for one in found.values()):
        rejected = rejected or [f"under {name} it is {one}" for name, one in found.items()]
    return "; ".join(rejected)


def judge_test(
    one: Played,
    expected: Sequence[ExpectedFailure],
    shared: Collection[str] = (),
    *,
    strict: bool = False,
) -> TestJudgement:
    """Hold one test against what was expected of it, as `judge_campaign` does with all.

    Args:
        one: the test.
        expected: failures that its campaign expects.
        shared: requirements of which not this test decides, but all together.
        strict: verdicts that are inconclusive are wrong, unless the test knows them.
    """
    test, outcome = one.job.test, one.outcome
    wrong: list[str] = []
    known: list[str] = []
    if outcome.ending is not Ending.COMPLETED and test.mutation is None:
        wrong.append(f"{outcome.ending}: {outcome.error}")
    accepted = accepted_failures(one, expected)
    if outcome.verdicts:
        wrong.extend(differences(test.expected, outcome.verdicts))
    if test.mutation is None:
        wrong.extend(outcome.illegal)
    for name, verdict in outcome.verdicts.items():
        if name in test.expected or test.mutation is not None:
            continue  # a planted fault says nothing about the robot
        if name in shared:
            continue
        if verdict is Verdict.FAIL:
            if name in accepted:
                known.append(f"{name} failed, as expected: {accepted[name]}")
            else:
                wrong.append(outcome.reasons.get(name, f"{name} failed"))
        elif verdict is Verdict.INCONCLUSIVE and strict:
            wrong.append(f"{name} is inconclusive")
    return TestJudgement(one, tuple(wrong), tuple(known))


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
        if _is_about(why, one):
            accepted.setdefault(why.requirement, why.reason)
    return accepted


def _is_about(why: ExpectedFailure, one: Played) -> bool:
    """Whether a failure is expected in a test: on the robot as it is."""
    test = one.job.test
    return (
        test.mutation is None
        and why.strategy in ("", test.strategy)
        and why.test in ("", test.name)
        and why.robot in ("", one.job.robot)
    )


def _expected_failures(
    expected: Sequence[ExpectedFailure], played: Sequence[Played]
) -> dict[str, str]:
    checks = {}
    for why in expected:
        verdicts = [
            one.outcome.verdicts[why.requirement]
            for one in played
            if why.requirement in one.outcome.verdicts and _is_about(why, one)
        ]
        if verdicts:
            missing = "" if Verdict.FAIL in verdicts else f"it did not, in {len(verdicts)} tests"
            checks[f"{_named(why)} is expected to fail ({why.reason})"] = missing
    return checks


def _named(why: ExpectedFailure) -> str:
    places = {"strategy": why.strategy, "test": why.test, "robot": why.robot}
    named = [f"{kind} {name}" for kind, name in places.items() if name]
    return " of ".join([why.requirement, *named])


def _triggered(
    requirements: Mapping[str, Sequence[str]], played: Sequence[Played]
) -> dict[str, str]:
    checks = {}
    for robot, names in requirements.items():
        for name in names:
            seen = {
                one.outcome.verdicts[name]
                for one in played
                if one.job.robot == robot and one.job.test.mutation is None
            }
            is_decided = not seen.isdisjoint((Verdict.PASS, Verdict.FAIL))
            wrong = "" if is_decided else "no test passed or failed it"
            checks[f"{name} is triggered ({robot})"] = wrong
    return checks


def refuse_unknown(campaign: Campaign) -> None:
    """See that all that is expected to fail exists; a test's name is only known with the tests.

    Args:
        campaign: as it was written.

    Raises:
        UnknownNameError: a failure is expected of what there is not.
        SpecError: the requirements of a robot are wrong.
    """
    specs = [load(robot.spec) for robot in campaign.robots.values() if robot.spec is not None]
    there_is = {
        "requirement": {name for spec in specs for name in spec.requirements},
        "strategy": {"", *campaign.strategies},
        "robot": {"", *campaign.robots},
    }
    for why in campaign.expected_failures:
        for kind, known in there_is.items():
            if (name := getattr(why, kind)) not in known:
                names = ", ".join(sorted(known - {""}))
                raise UnknownNameError(
                    f"a failure is expected of the {kind} `{name}`: there are {names}"
                )
