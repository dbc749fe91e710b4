"""Verdicts as JUnit XML for CI servers, and helpers to write other suites."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rvmon.report.wording import full_reason, without_attempts
from rvmon.texts import shown
from rvmon.trace.time import format_stamped
from rvmon.verdicts import Verdict
from rvmon.verdicts.known_failures import NONE_KNOWN, KnownFailures
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from rvmon.language.checked.specification import CheckedSpec, Requirement


def junit_xml(
    reports: Sequence[Report],
    spec: CheckedSpec,
    broken: Sequence[tuple[str, str]] = (),
    known: KnownFailures = NONE_KNOWN,
) -> str:
    """A test suite per run, a test case per requirement.

    F is a failure, and so is an illegal bin that was hit; NT, I and known failures are skipped
    with their reason, since none of them is a pass. A recording that could not be read to its end
    (`broken`) is an error.
    """
    root = ET.Element("testsuites", name=shown(spec.name))
    for report in reports:
        failures = known.failures(report)
        cases = []
        for name, verdict in report.verdicts.items():
            cases.append(_case(report, name, verdict, spec.requirements[name]))
            if verdict is Verdict.FAIL and name not in failures:
                _accept(cases[-1], known.expected(report)[name])
        for hit in report.illegal:
            cases.append(ET.Element("testcase", name=shown(f"{hit.group}: {hit.item}")))
            ET.SubElement(cases[-1], "failure", message=shown(hit.sentence(report.origin)))
        add_suite(root, report.trace or spec.name, cases)
    for trace, message in broken:
        case = ET.Element("testcase", name="recording")
        ET.SubElement(case, "error", message=shown(message))
        add_suite(root, trace, [case])
    return as_text(root)


def add_suite(root: ET.Element, name: str, cases: Sequence[ET.Element]) -> None:
    """Add a suite of cases, with the numbers of failures, errors and skipped cases."""
    counts = {
        kind: str(sum(case.find(tag) is not None for case in cases))
        for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped"))
    }
    attributes = {"name": shown(name), "tests": str(len(cases)), **counts}
    suite = ET.SubElement(root, "testsuite", attributes)
    for case in cases:
        # CI servers group cases by it.
        case.set("classname", shown(name))
        suite.append(case)


def as_text(root: ET.Element) -> str:
    """The document as indented XML."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _case(report: Report, name: str, verdict: Verdict, requirement: Requirement) -> ET.Element:
    case = ET.Element("testcase", name=shown(name))
    entries = [("requirement", requirement.text), ("severity", requirement.severity)]
    entries = [
        entry for entry in (*entries, *(("tag", tag) for tag in requirement.tags)) if entry[1]
    ]
    properties = ET.SubElement(case, "properties") if entries else case
    for kind, value in entries:
        ET.SubElement(properties, "property", name=kind, value=shown(value))
    if verdict is Verdict.PASS:
        return case
    if report.is_silent(name):
        why = without_attempts(verdict, report.misses.get(name, ""))
        ET.SubElement(case, "skipped", message=shown(f"{verdict}: {why}"))
        return case
    reasons = []
    for attempt in report.of(name, verdict):
        at = attempt.decided
        when = "undecided" if at is None else format_stamped(at, attempt.origin)
        reasons.append(shown(f"attempt {attempt.numbered}, {when}: {full_reason(attempt, report)}"))
    reasons = reasons or ["a step was interrupted: what followed was not evaluated in full"]
    kind = "failure" if verdict is Verdict.FAIL else "skipped"
    element = ET.SubElement(case, kind, message=f"{verdict.value}: {reasons[0]}")
    element.text = "\n".join(reasons)
    return case


def _accept(case: ET.Element, why: str) -> None:
    """Turn a failure into a skipped case with the reason why it is known."""
    for failure in case.findall("failure"):
        failure.tag = "skipped"
        failure.set("message", shown(f"known: {why}; {failure.get('message')}"))
