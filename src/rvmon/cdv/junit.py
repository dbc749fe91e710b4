"""What was expected of a campaign, and what came out, as JUnit XML, which CI servers show."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from rvmon.cdv.gate import CampaignJudgement, TestJudgement
from rvmon.coverage.record import Ending
from rvmon.diagnostics.shown import shown
from rvmon.report.junit import add_suite, as_text


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
        add_suite(root, f"{campaign}.{name}", [_case(one) for one in tests])
    together = [_check(check, what) for check, what in judgement.checks.items()]
    if judgement.cut_short:
        case = ET.Element("testcase", name="all tests are played")
        ET.SubElement(case, "error", message=shown(judgement.cut_short))
        together.append(case)
    if together:
        add_suite(root, campaign, together)
    return as_text(root)


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
