"""Is a campaign as expected? What is known to fail, fails; nothing else does. As JUnit XML, too."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.cdv.campaign import STRATEGY, Campaign, ExpectedFailure, Gate, unreachable_items
from rvmon.cdv.campaign_plan import Played, Results, accepted_failures, is_about
from rvmon.cdv.campaign_summary import differences, missed
from rvmon.cdv.coverage import coverage_model, covered_share
from rvmon.cdv.sequential_test import Decision
from rvmon.coverage import STATES, Ending
from rvmon.errors import UnknownNameError
from rvmon.report.junit import add_suite, as_text, case_of
from rvmon.texts import counted, shown, shown_line
from rvmon.verdicts import Verdict

RobotRequirement = tuple[str, str]
"""Names of a robot and of one of its requirements."""


@dataclass(frozen=True, slots=True)
class TestJudgement:
    """One test, compared with what was expected of it."""

    __test__ = False

    played: Played  # the test
    wrong: tuple[str, ...]  # the differences from the expectation, a sentence each
    known: tuple[str, ...]  # failures that are, each with the reason for which it is accepted


@dataclass(frozen=True, slots=True)
class CampaignJudgement:
    """A campaign, compared with what was expected of it."""

    tests: tuple[TestJudgement, ...]  # each by itself, in the order of the plan
    # by demand on all tests together, in words, the fault of it; "" if there is none
    checks: Mapping[str, str] = field(default_factory=dict)
    cut_short: str = ""  # why not all tests were played; empty if they were

    @property
    def wrong(self) -> list[str]:
        """All that is not as expected."""
        of_tests = [
            f"{test.played.job.test.name} ({test.played.job.robot}): {what}"
            for test in self.tests
            for what in test.wrong
        ]
        return of_tests + [f"{check}: {what}" for check, what in self.checks.items() if what]

    @property
    def known(self) -> dict[str, int]:
        """The failures that were expected, in words, each with the number of its tests."""
        return dict(Counter(what for test in self.tests for what in test.known))


def judge_campaign(
    results: Results,
    requirements: Mapping[str, Sequence[str]],
    shares: Mapping[RobotRequirement, Mapping[str, Decision]] | None = None,
    *,
    strict: bool = False,
) -> CampaignJudgement:
    """Compare all tests with what was expected of them.

    A test is wrong if a requirement failed that it does not know, and the campaign does not expect,
    to fail; if a verdict that it knows came out otherwise; if it does not reach what it is made to;
    if, on the robot as it is, something was
    hit that must not be, its code crashed, it hung or was lost. So is a hit of what the campaign
    calls unreachable, by any test. An expected failure that did not
    occur is wrong as well, unless no test was played in which it could.

    Args:
        results: of the played tests; of a campaign that was cut short only the tests are judged.
        requirements: by robot, the ids of those that were judged; none: only endings count.
        shares: for requirements that must hold in a share of runs, the decision by the tests of
            each strategy: a single test that fails them is not wrong, a strategy that rejects the
            share is. With `strict` it is wrong as well that none decides it.
        strict: verdicts that are inconclusive are wrong as well, unless the test knows them, and so
            is what the gates of strategies want and their tests did not bring.
    """
    campaign = results.plan.campaign
    expected = campaign.expected_failures
    decisions = shares or {}
    tests = tuple(
        judge_test(
            played,
            expected,
            [name for robot, name in decisions if robot == played.job.robot],
            gate=campaign.gates.get(_gate_name(campaign, played), Gate()) if strict else None,
        )
        for played in results.played
    )
    checks: dict[str, str] = {}
    if not results.cut_short:
        checks |= _expected_failures(expected, results.played)
        checks |= dict(_contradicted(results))
        checks |= dict(_unlisted(results))
        checks |= dict(_gated(results, requirements)) if strict else {}
        for (robot, name), by_strategy in decisions.items():
            known = (one.requirement == name and one.robot in ("", robot) for one in expected)
            if not any(known):
                share = next(iter(by_strategy.values())).share
                checks[f"{name} {share} ({robot})"] = _undecided(by_strategy, strict=strict)
    return CampaignJudgement(tests, checks, results.cut_short)


def _undecided(decisions: Mapping[str, Decision], *, strict: bool) -> str:
    """The complaint about a share of runs; empty if it holds, or need not be decided."""
    found = decisions.items()
    rejected = [f"under {name} it {one}" for name, one in found if one.holds is False]
    if strict and not rejected and not any(one.holds for _, one in found):
        rejected = [f"under {name} it is {one}" for name, one in found]
    return "; ".join(rejected)


def judge_test(
    played: Played,
    expected: Sequence[ExpectedFailure],
    shared: Collection[str] = (),
    *,
    gate: Gate | None = None,
) -> TestJudgement:
    """Compare one test with what was expected of it, as `judge_campaign` does with all.

    Of `shared` requirements not this test decides, but all together. With a gate, verdicts that are
    inconclusive are wrong, unless it or the test knows them.
    """
    test, outcome = played.job.test, played.outcome
    wrong: list[str] = []
    known: list[str] = []
    if outcome.ending is not Ending.COMPLETED and test.mutation is None:
        wrong.append(f"{outcome.ending}: {shown_line(str(outcome.error))}")
    accepted = accepted_failures(played, expected)
    if outcome.verdicts:
        wrong.extend(differences(test.expected, outcome.verdicts))
    wrong.extend(missed(test.reaches, outcome.hits))
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
        elif verdict is Verdict.INCONCLUSIVE and gate and name not in gate.inconclusive:
            wrong.append(f"{name} is inconclusive")
    return TestJudgement(played, tuple(wrong), tuple(known))


def _expected_failures(
    expected: Sequence[ExpectedFailure], played: Sequence[Played]
) -> dict[str, str]:
    checks = {}
    for why in expected:
        if why.seldom:
            continue
        verdicts = [
            test_run.outcome.verdicts[why.requirement]
            for test_run in played
            if why.requirement in test_run.outcome.verdicts and is_about(why, test_run)
        ]
        if verdicts:
            tests = counted(len(verdicts), "test")
            missing = "" if Verdict.FAIL in verdicts else f"it did not, in {tests}"
            checks[f"{_named(why)} is expected to fail ({why.reason})"] = missing
    return checks


def _named(why: ExpectedFailure) -> str:
    places = {"strategy": why.strategy, "test": why.test, "robot": why.robot}
    named = [f"{kind} {name}" for kind, name in places.items() if name]
    return " of ".join([why.requirement, *named])


def _contradicted(results: Results) -> Iterator[tuple[str, str]]:
    """Whether what the campaign calls unreachable was not hit."""
    campaign = results.plan.campaign
    if not campaign.closing.unreachable:
        return
    for robot in campaign.robots:
        out = unreachable_items(campaign, robot, coverage_model(campaign, robot))
        first = {
            f"{group}: {item}": test_run.job.test.name
            # Reversed, so that of several tests the first stays.
            for test_run in reversed(results.counting(robot))
            for group, items in test_run.outcome.hits.items()
            for item in items
            if (group, item) in out
        }
        wrong = "; ".join(f"{test} hits {item}" for item, test in first.items())
        yield f"no test hits what is called unreachable ({robot})", wrong


def _unlisted(results: Results) -> Iterator[tuple[str, str]]:
    """The states that were entered, and that the campaign, which lists some, does not."""
    campaign = results.plan.campaign
    for robot in campaign.robots if campaign.states else ():
        first = {
            state: test_run.job.test.name
            for test_run in reversed(results.counting(robot))
            for state in test_run.outcome.hits.get(STATES, {}).keys() - {*campaign.states}
        }
        if first:
            wrong = "; ".join(f"{test} enters `{state}`" for state, test in sorted(first.items()))
            yield f"the states of the campaign are all that are entered ({robot})", wrong


def _gate_name(campaign: Campaign, played: Played) -> str:
    """The strategy whose gate a test is compared with; empty: that of all which have none."""
    strategy = played.job.test.strategy
    return strategy if strategy in campaign.gates else ""


def _gated(
    results: Results, requirements: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, str]]:
    """The conditions of gates on all tests together, each with its complaint."""
    campaign = results.plan.campaign
    groups: dict[tuple[str, str], list[Played]] = {}
    for robot in campaign.robots:
        for test_run in results.counting(robot):
            key = robot, _gate_name(campaign, test_run)
            groups.setdefault(key, []).append(test_run)
    for (robot, strategy), tests in groups.items():
        gate = campaign.gates.get(strategy, Gate())
        place = f"{strategy}, {robot}" if strategy else robot
        count = counted(len(tests), "test")
        for name in requirements[robot]:
            if name not in gate.untriggered:
                seen = {test.outcome.verdicts[name] for test in tests}
                decided = not seen.isdisjoint((Verdict.PASS, Verdict.FAIL))
                wrong = "" if decided else f"none of {count} passed or failed it"
                yield f"{name} is triggered ({place})", wrong
        if gate.coverage:
            share = 100 * covered_share(campaign, robot, tests)
            wrong = "" if share >= gate.coverage else f"{count} covered {share:.1f} %"
            yield f"at least {gate.coverage:g} % are covered ({place})", wrong


def refuse_unknown(campaign: Campaign) -> None:
    """See that all that failures are expected of, and gates name, exists; tests come later.

    Raises:
        UnknownNameError: a failure is expected of what there is not, or a gate names it.
        SpecError: the requirements of a robot are wrong.
    """
    specs = campaign.requirements.values()
    there_is = {
        "requirement": {name for spec in specs for name in spec.requirements},
        "strategy": {"", STRATEGY, *campaign.strategies},
        "robot": {"", *campaign.robots},
    }
    named = [
        (f"a failure is expected of the {kind}", kind, getattr(why, kind))
        for why in campaign.expected_failures
        for kind in there_is
    ]
    for strategy, gate in campaign.gates.items():
        named.append(("there is a gate of the strategy", "strategy", strategy))
        named += [
            ("a gate names the requirement", "requirement", name)
            for name in (*gate.untriggered, *gate.inconclusive)
        ]
    for what, kind, name in named:
        if name not in there_is[kind]:
            names = ", ".join(sorted(there_is[kind] - {"", STRATEGY}))
            raise UnknownNameError(f"{what} `{name}`: there are {names}")


def junit_xml(campaign: str, judgement: CampaignJudgement) -> str:
    """A test suite per robot and strategy, a test case per test; one suite for all together.

    What is not as expected is a failure; a test that crashed, hung or was lost, and that not all
    were played, an error; one that fails as expected is skipped, with the reason.
    """
    root = ET.Element("testsuites", name=shown(campaign))
    groups: dict[str, list[TestJudgement]] = {}
    for test in judgement.tests:
        job = test.played.job
        groups.setdefault(f"{job.robot}.{job.test.strategy}", []).append(test)
    for name, tests in groups.items():
        add_suite(root, f"{campaign}.{name}", [_case(test) for test in tests])
    together = [
        case_of(check, "failure" if what else "", [what])
        for check, what in judgement.checks.items()
    ]
    if judgement.cut_short:
        together.append(case_of("all tests are played", "error", [judgement.cut_short]))
    if together:
        add_suite(root, campaign, together)
    return as_text(root)


def _case(judgement: TestJudgement) -> ET.Element:
    test, outcome = judgement.played.job.test, judgement.played.outcome
    facts = {"seed": str(test.seed), "purpose": test.text, "planted fault": test.mutation or ""}
    facts |= {name: verdict.value for name, verdict in outcome.verdicts.items()}
    kind, reasons = "", [*judgement.wrong[:1], *judgement.wrong]
    if judgement.wrong:
        ended = outcome.ending is not Ending.COMPLETED and test.mutation is None
        kind = "error" if ended else "failure"
    elif judgement.known:
        kind, reasons = "skipped", ["; ".join(judgement.known)]
    case = case_of(test.name, kind, reasons, facts.items())
    case.set("time", f"{outcome.seconds:.3f}")
    return case
