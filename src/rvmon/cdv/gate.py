"""The gate of a campaign: it compares all results with what was expected; also as JUnit XML."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.cdv.campaign import STRATEGY, Campaign, ExpectedFailure, Gate, unreachable_items
from rvmon.cdv.campaign_plan import Played, Results, accepted_failures, applies_to
from rvmon.cdv.campaign_summary import differences, missed
from rvmon.cdv.coverage import coverage_model, covered_share
from rvmon.cdv.sequential_test import Decision
from rvmon.coverage import STATES, Ending
from rvmon.errors import UnknownNameError
from rvmon.report.junit import add_suite, as_text, case_of
from rvmon.texts import counted, escaped, escaped_line
from rvmon.verdicts import Verdict

RobotRequirement = tuple[str, str]
"""Names of a robot and of one of its requirements."""


@dataclass(frozen=True, slots=True)
class TestJudgement:
    """One test, compared with what was expected of it."""

    __test__ = False

    played: Played
    wrong: tuple[str, ...]  # differences from the expectation, a sentence each
    known: tuple[str, ...]  # expected failures that occurred, each with the reason to accept it


@dataclass(frozen=True, slots=True)
class CampaignJudgement:
    """A campaign, compared with what was expected of it."""

    tests: tuple[TestJudgement, ...]  # in the order of the plan
    # Conditions on all tests together, in words, each with its violation; "" if it holds.
    checks: Mapping[str, str] = field(default_factory=dict)
    cut_short: str = ""  # why not all tests were played; empty if all were

    @property
    def wrong(self) -> list[str]:
        """All differences from what was expected."""
        of_tests = [
            f"{test.played.job.test.name} ({test.played.job.robot}): {what}"
            for test in self.tests
            for what in test.wrong
        ]
        return of_tests + [f"{check}: {what}" for check, what in self.checks.items() if what]

    @property
    def known(self) -> dict[str, int]:
        """The expected failures that occurred, in words, each with its number of tests."""
        return dict(Counter(what for test in self.tests for what in test.known))


def judge_campaign(
    results: Results,
    requirements: Mapping[str, Sequence[str]],
    shares: Mapping[RobotRequirement, Mapping[str, Decision]] | None = None,
    *,
    strict: bool = False,
) -> CampaignJudgement:
    """Compare all tests with what was expected of them.

    A test is wrong if it does not have the verdicts that it expects, or does not reach the items
    that it is made to reach. A test without a planted fault is also wrong if a requirement failed
    that neither the test nor the campaign expects to fail, or if it hit an illegal item, crashed,
    hung or was lost.

    The campaign is wrong if a test without a planted fault hit an item that is declared
    unreachable, or entered a state that the campaign does not list, or if an expected failure (not
    a `seldom` one) occurred in none of the tests in which it could.

    Args:
        results: of the campaign; if it was cut short, only the single tests are judged.
        requirements: the ids of the judged requirements, by robot; none: only endings count.
        shares: for requirements that must hold in a share of runs, the decision on the tests of
            each strategy. A single test that fails such a requirement is not wrong, but a strategy
            that rejects the share is; with `strict`, so is a share that no strategy decides.
        strict: inconclusive verdicts are wrong too, unless the test expects them or its gate allows
            them, and so are unmet gates of strategies.
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
        checks |= dict(_unreachable_hits(results))
        checks |= dict(_unlisted_states(results))
        checks |= dict(_gate_checks(results, requirements)) if strict else {}
        for (robot, name), by_strategy in decisions.items():
            known = (one.requirement == name and one.robot in ("", robot) for one in expected)
            if not any(known):
                share = next(iter(by_strategy.values())).share
                checks[f"{name} {share} ({robot})"] = _share_fault(by_strategy, strict=strict)
    return CampaignJudgement(tests, checks, results.cut_short)


def _share_fault(decisions: Mapping[str, Decision], *, strict: bool) -> str:
    """What is wrong with a share of runs; empty if it holds, or is undecided and not `strict`."""
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

    `shared` requirements must hold in a share of runs, so no single test decides them. With a gate,
    inconclusive verdicts are wrong unless the gate or the test allows them.
    """
    test, outcome = played.job.test, played.outcome
    wrong: list[str] = []
    known: list[str] = []
    if outcome.ending is not Ending.COMPLETED and test.mutation is None:
        wrong.append(f"{outcome.ending}: {escaped_line(str(outcome.error))}")
    accepted = accepted_failures(played, expected)
    if outcome.verdicts:
        wrong.extend(differences(test.expected, outcome.verdicts))
    wrong.extend(missed(test.reaches, outcome.hits))
    if test.mutation is None:
        wrong.extend(outcome.illegal)
    for name, verdict in outcome.verdicts.items():
        if name in test.expected or test.mutation is not None:
            continue  # compared above; of a test with a planted fault, nothing else is expected
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
            if why.requirement in test_run.outcome.verdicts and applies_to(why, test_run)
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


def _unreachable_hits(results: Results) -> Iterator[tuple[str, str]]:
    """Check that no test hit an item that is declared unreachable."""
    campaign = results.plan.campaign
    if not campaign.closing.unreachable:
        return
    for robot in campaign.robots:
        out = unreachable_items(campaign, robot, coverage_model(campaign, robot))
        first = {
            f"{group}: {item}": test_run.job.test.name
            # Reversed, so that the first of several tests is the one named.
            for test_run in reversed(results.unmutated(robot))
            for group, items in test_run.outcome.hits.items()
            for item in items
            if (group, item) in out
        }
        wrong = "; ".join(f"{test} hits {item}" for item, test in first.items())
        yield f"no test hits an item that is declared unreachable ({robot})", wrong


def _unlisted_states(results: Results) -> Iterator[tuple[str, str]]:
    """Check that no state was entered that the campaign does not list, if it lists any."""
    campaign = results.plan.campaign
    for robot in campaign.robots if campaign.states else ():
        first = {
            state: test_run.job.test.name
            for test_run in reversed(results.unmutated(robot))
            for state in test_run.outcome.hits.get(STATES, {}).keys() - {*campaign.states}
        }
        if first:
            wrong = "; ".join(f"{test} enters `{state}`" for state, test in sorted(first.items()))
            yield f"only states of the campaign are entered ({robot})", wrong


def _gate_name(campaign: Campaign, played: Played) -> str:
    """The name of the gate for a test: its strategy, or empty if the strategy has no gate."""
    strategy = played.job.test.strategy
    return strategy if strategy in campaign.gates else ""


def _gate_checks(
    results: Results, requirements: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, str]]:
    """The conditions of gates on all their tests together, each with its violation."""
    campaign = results.plan.campaign
    groups: dict[tuple[str, str], list[Played]] = {}
    for robot in campaign.robots:
        for test_run in results.unmutated(robot):
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
    """Check that the names in expected failures and gates exist; test names cannot be checked yet.

    Raises:
        UnknownNameError: an expected failure or a gate names an unknown requirement, strategy or
            robot.
        SpecError: the requirements of a robot are wrong.
    """
    specs = campaign.requirements.values()
    there_is = {
        "requirement": {name for spec in specs for name in spec.requirements},
        "strategy": {"", STRATEGY, *campaign.strategies},
        "robot": {"", *campaign.robots},
    }
    named = [
        (f"an expected failure names the {kind}", kind, getattr(why, kind))
        for why in campaign.expected_failures
        for kind in there_is
    ]
    for strategy, gate in campaign.gates.items():
        named.append(("a gate names the strategy", "strategy", strategy))
        named += [
            ("a gate names the requirement", "requirement", name)
            for name in (*gate.untriggered, *gate.inconclusive)
        ]
    for what, kind, name in named:
        if name not in there_is[kind]:
            names = ", ".join(sorted(there_is[kind] - {"", STRATEGY}))
            raise UnknownNameError(f"{what} `{name}`: there are {names}")


def junit_xml(campaign: str, judgement: CampaignJudgement) -> str:
    """The judgement as JUnit XML: a suite per robot and strategy, and one for the whole campaign.

    A test that is wrong is a failure, or an error if it crashed, hung or was lost. A test that
    fails as expected is skipped, with the reason. A campaign that was cut short has an error.
    """
    root = ET.Element("testsuites", name=escaped(campaign))
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
