"""What was expected of a campaign, and what came out, as JUnit XML, which CI servers show."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

from rvmon.cdv.gate import CampaignJudgement, TestJudgement
from rvmon.coverage.record import Ending
from rvmon.diagnostics.shown import shown


def junit_xml(campaign: str, judgement: CampaignJudgement) -> str:
    """A test suite per robot and strategy, a test case per test; one suite for all together.

    What is not as expected is a failure; a test that crashed, hung or was lost an error; one that
    fails as expected is skipped, with the reason.

    Args:
        campaign: its name.
        judgement: on its tests; that not all were played is an error.
    """
    root = ET.Element("testsuites", name=shown(campaign))
    groups: dict[str, list[TestJudgement]] = {}
    for one in judgement.tests:
        job = one.played.job
        groups.setdefault(f"{job.robot}.{job.test.strategy}", []).append(one)
    for name, tests in groups.items():
        _suite(root, f"{campaign}.{name}", [_case(one) for one in tests])
    together = [_check(check, what) for check, what in judgement.checks.items()]
    if judgement.cut_short:
        case = ET.Element("testcase", name="all tests are played")
        ET.SubElement(case, "error", message=shown(judgement.cut_short))
        together.append(case)
    if together:
        _suite(root, campaign, together)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _suite(root: ET.Element, name: str, cases: Sequence[ET.Element]) -> None:
    counts: Mapping[str, int] = {
        kind: sum(case.find(tag) is not None for case in cases)
        for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped"))
    }
    figures = {kind: str(count) for kind, count in counts.items()}
    own = {"name": shown(name), "tests": str(len(cases)), **figures}
    suite = ET.SubElement(root, "testsuite", own)
    for case in cases:
        case.set("classname", shown(name))
        suite.append(case)


def _case(one: TestJudgement) -> ET.Element:
    test, outcome = one.played.job.test, one.played.outcome
    case = ET.Element("testcase", name=shown(test.name), time=f"{outcome.seconds:.3f}")
    properties = ET.SubElement(case, "properties")
    facts = {"seed": str(test.seed), "purpose": test.text, "planted fault": test.mutation or ""}
    for name, verdict in outcome.verdicts.items():
        facts[name] = verdict.value
    for name, value in facts.items():
        if value:
            ET.SubElement(properties, "property", name=shown(name), value=shown(value))
    if one.wrong:
        ended = outcome.ending is not Ending.COMPLETED and test.mutation is None
        element = ET.SubElement(case, "error" if ended else "failure", message=shown(one.wrong[0]))
        element.text = shown("\n".join(one.wrong))
    elif one.known:
        ET.SubElement(case, "skipped", message=shown("; ".join(one.known)))
    return case


def _check(check: str, what: str) -> ET.Element:
    case = ET.Element("testcase", name=shown(check))
    if what:
        ET.SubElement(case, "failure", message=shown(what))
    return case
