"""Verdicts as JUnit XML."""

import xml.etree.ElementTree as ET

import rvmon
from rvmon.report.junit import junit_xml
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import report_of

SPEC = rvmon.loads(
    "spec door\nsignal a : bool input\n"
    + "".join(f'requirement D{n} "text {n}"\n  upon a\n  then within 2 s not a\n' for n in range(5))
).checked


def reports():
    """A run with a requirement for each verdict, and a reason that XML has to escape."""
    attempts = [
        Attempt("D0", 1, 0, 5, Verdict.PASS),
        Attempt("D1", 1, 0, 5, Verdict.FAIL, reason='<"\x00&'),
        Attempt("D1", 2, 1, 6, Verdict.FAIL, reason="again"),
        Attempt("D2", 1, 0, None, Verdict.INCONCLUSIVE, reason="open"),
    ]
    names = ["D0", "D1", "D2", "D3", "D4"]
    return [report_of(names, attempts, incomplete=["D4"], trace="run\x01.csv")]


def test_every_verdict_has_its_form():
    root = ET.fromstring(junit_xml(reports(), SPEC))  # noqa: S314
    suite = root.find("testsuite")
    counts = {name: suite.get(name) for name in ("tests", "failures", "skipped")}
    assert counts == {"tests": "5", "failures": "1", "skipped": "3"}
    cases = {case.get("name"): case for case in root.iter("testcase")}
    kinds = {
        name: [child.tag for child in case if child.tag != "properties"]
        for name, case in cases.items()
    }
    skipped = {name: ["skipped"] for name in ("D2", "D3", "D4")}
    assert kinds == {"D0": [], "D1": ["failure"], **skipped}
    assert "again" in cases["D1"].find("failure").text
    assert cases["D3"].find("skipped").get("message") == "NT: never triggered"
    assert cases["D4"].find("skipped").get("message") == "I: not known ever to be triggered"
