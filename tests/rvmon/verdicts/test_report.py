"""Reports: order, counts, fold, JSON and back."""

import json
from dataclasses import replace

import pytest
from tests.tools.each import each

from rvmon.errors import TraceError
from rvmon.trace.sample import Health, HealthKind
from rvmon.verdicts import LAW, Verdict
from rvmon.verdicts.attempt import Attempt, Blame, Decision
from rvmon.verdicts.report import Report, report_of

ORIGIN = 500_000_000


def attempts() -> list[Attempt]:
    """An attempt of each verdict; the first has every field set."""
    return [
        Attempt(
            *("R2", 2, 4, None, Verdict.INCONCLUSIVE, Decision.OPEN),
            deadline=9,
            required="F p",
            origin=ORIGIN,
        ),
        Attempt(
            "R2",
            1,
            1_000_000_000,
            2_500_000_000,
            Verdict.FAIL,
            reason="window closed",
            at_trigger={"p": True, "x > 3": None, "x": 2.0, "n": 2},
            captured={"v": 1.5, "label": "red"},
            blame=Blame("F p", 3, 6, (0, None), (1, 2)),
            forecast=Verdict.PASS,
            robustness=0.0,
            origin=ORIGIN,
        ),
        Attempt("R1", 1, 0, 2_500_000_000, Verdict.PASS, Decision.HELD_TO_END, origin=ORIGIN),
    ]


def report() -> Report:
    health = Health(HealthKind.STALE, "x", 3, 17, ("R1",), "late")
    return report_of(
        ["R1", "R2", "R3"], attempts(), health=[health], trace="run.csv", origin=ORIGIN, end=7
    )


def test_order_and_fold() -> None:
    got = report()
    assert [(a.requirement, a.number) for a in got.attempts] == [("R1", 1), ("R2", 1), ("R2", 2)]
    assert got.verdicts == {"R1": "P", "R2": "F", "R3": "NT"}
    assert got.counts["R2"] == {"P": 0, "F": 1, "I": 1}
    assert got.counts["R3"] == {"P": 0, "F": 0, "I": 0}


def test_what_was_not_kept_counts() -> None:
    dropped = {"R1": {Verdict.FAIL: 3, Verdict.PASS: 10}, "R3": {Verdict.INCONCLUSIVE: 1}}
    got = report_of(["R1", "R2", "R3"], attempts(), dropped=dropped, origin=ORIGIN)
    assert got.verdicts == {"R1": "F", "R2": "F", "R3": "I"}
    assert got.counts["R1"] == {"P": 11, "F": 3, "I": 0}
    assert got.dropped == dropped
    text = got.to_json()
    assert json.loads(text)["requirements"]["R1"]["dropped"] == {"F": 3, "P": 10}
    assert Report.from_json(text) == got


def test_json_shape() -> None:
    assert Report.from_json(report().to_json()) == report()
    document = json.loads(report().to_json())
    assert next(iter(document.items())) == ("law", LAW)
    assert (document["trace"], document["health"][0]["kind"]) == ("run.csv", "stale")
    entry = document["requirements"]["R2"]
    assert (entry["verdict"], entry["counts"]) == ("F", {"P": 0, "F": 1, "I": 1})
    failed, undecided = entry["attempts"]
    assert undecided["decided"] is None
    assert failed.items() >= {
        ("number", 1),
        ("triggered", 1_000_000_000),
        ("decided", 2_500_000_000),
        ("triggered_s", 0.5),
        ("decided_s", 2.0),
        ("verdict", "F"),
        ("reason", "window closed"),
    }


def test_a_report_of_the_first_semantics_is_read() -> None:
    """They do not name their semantics; after a round trip they still have that version."""
    document = json.loads(report().to_json())
    del document["law"]
    old = Report.from_json(json.dumps(document))
    assert old == replace(report(), law=1)
    assert json.loads(old.to_json())["law"] == 1


DROPPED = [
    report().to_json().replace('"counts"', f'"dropped":{dropped},"counts"', 1)
    for dropped in ('{"F":-1}', '{"NT":1}', '{"F":"x"}', "3")
]


@each("text", ["", "[]", "{}", '{"requirements": {"R": 1}, "health": []}', b"\xff", *DROPPED])
def test_what_is_no_report_is_refused(text: str | bytes) -> None:
    with pytest.raises(TraceError):
        Report.from_json(text)


def test_a_report_shows_its_verdicts():
    passed = Attempt("R1", 1, 0, 5, Verdict.PASS)
    report = report_of(["R1", "R2"], [passed], trace="a.csv")
    assert repr(report) == "<Report of a.csv: R1 P, R2 NT>"
    assert str(replace(report, trace="")) == "<Report: R1 P, R2 NT>"
