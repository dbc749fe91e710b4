"""Verdicts as JUnit XML for CI servers, and helpers to write other suites."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from rvmon.report.wording import full_reason, without_attempts
from rvmon.texts import escaped
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
    root = ET.Element("testsuites", name=escaped(spec.name))
    for report in reports:
        failures = known.failures(report)
        cases = []
        for name, verdict in report.verdicts.items():
            accepted = verdict is Verdict.FAIL and name not in failures
            why = known.expected(report)[name] if accepted else ""
            cases.append(_case(report, name, verdict, spec.requirements[name], why))
        cases += [
            case_of(f"{hit.group}: {hit.item}", "failure", [hit.sentence(report.origin)])
            for hit in report.illegal
        ]
        add_suite(root, report.trace or spec.name, cases)
    for trace, message in broken:
        add_suite(root, trace, [case_of("recording", "error", [message])])
    return as_text(root)


def case_of(
    name: str, kind: str = "", reasons: Sequence[str] = (), facts: Iterable[tuple[str, str]] = ()
) -> ET.Element:
    """A test case.

    Args:
        name: of the case.
        kind: `error`, `failure` or `skipped`; "" if it passed.
        reasons: the message, then further lines; at least one if `kind` is given.
        facts: properties, as pairs of name and value; empty ones are left out.
    """
    case = ET.Element("testcase", name=escaped(name))
    stated = [(word, fact) for word, fact in facts if fact]
    properties = ET.SubElement(case, "properties") if stated else case
    for word, fact in stated:
        ET.SubElement(properties, "property", name=escaped(word), value=escaped(fact))
    if kind:
        element = ET.SubElement(case, kind, message=escaped(reasons[0]))
        element.text = escaped("\n".join(reasons[1:])) or None
    return case


def add_suite(root: ET.Element, name: str, cases: Sequence[ET.Element]) -> None:
    """Add a suite of cases, with the numbers of failures, errors and skipped cases."""
    counts = {
        kind: str(sum(case.find(tag) is not None for case in cases))
        for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped"))
    }
    attributes = {"name": escaped(name), "tests": str(len(cases)), **counts}
    suite = ET.SubElement(root, "testsuite", attributes)
    for case in cases:
        # CI servers group cases by `classname`.
        case.set("classname", escaped(name))
        suite.append(case)


def as_text(root: ET.Element) -> str:
    """The document as indented XML."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _case(
    report: Report, name: str, verdict: Verdict, requirement: Requirement, accepted: str
) -> ET.Element:
    """The case of a requirement; `accepted` is the reason why its failure is known, or ""."""
    tags = (("tag", tag) for tag in requirement.tags)
    facts = (("requirement", requirement.text), ("severity", requirement.severity), *tags)
    if verdict is Verdict.PASS:
        return case_of(name, facts=facts)
    if report.is_silent(name):
        why = without_attempts(verdict, report.misses.get(name, ""))
        return case_of(name, "skipped", [f"{verdict}: {why}"], facts)
    reasons = []
    for attempt in report.of(name, verdict):
        at = attempt.decided
        when = "undecided" if at is None else format_stamped(at, attempt.origin)
        reasons.append(f"attempt {attempt.numbered}, {when}: {full_reason(attempt, report)}")
    reasons = reasons or ["a step was interrupted: what followed was not evaluated in full"]
    message = f"{verdict}: {reasons[0]}"
    if accepted:
        message = f"known: {accepted}; {message}"
    kind = "failure" if verdict is Verdict.FAIL and not accepted else "skipped"
    return case_of(name, kind, [message, *reasons], facts)
