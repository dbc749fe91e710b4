"""A campaign passes if everything is as expected, including known failures."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from rvmon import cdv
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.gate import judge_campaign, junit_xml, refuse_unknown
from rvmon.cdv.play import execute
from rvmon.errors import UnknownNameError

pytestmark = pytest.mark.process

REQUIREMENTS = {"toy": ("T1", "T2", "T3")}
LOW, HIGH = ("low", {"level": 3.0}), ("high", {"level": 6.0})
CRASH = ("crash", {"does": "crash"})
TOO_HIGH = "T1#1 F at 1 s: `level < 5` became false at 1 s; it had to be true at all times"


def judged(campaign, *, strict=False):
    return judge_campaign(execute(plan(campaign), jobs=1), REQUIREMENTS, strict=strict)


@pytest.mark.parametrize(
    ("tests", "wrong"),
    [
        ([LOW], []),
        ([LOW, HIGH], [f"high (toy): {TOO_HIGH}"]),
        ([("known", {"level": 6.0, "expected": {"T1": "F"}})], []),
        ([("known", {"level": 3.0, "expected": {"T1": "F"}})], ["known (toy): T1 is P, not F"]),
        (
            [("known", {"expected": {"T9": "P"}})],
            ["known (toy): T9 is no requirement, not P"],
        ),
        ([CRASH], ["crash (toy): crashed: ZeroDivisionError: by zero"]),
        ([("b", {"does": "exit"})], ["b (toy): lost: its process ended, with exit code 5"]),
    ],
)
def test_what_is_not_as_expected_is_wrong(campaign, tests, wrong):
    assert judged(campaign(*tests)).wrong == wrong


def test_a_crash_is_told_in_one_line(campaign, spec):
    class Broken:
        def play(self, test, observer):
            raise ValueError("no power\nat the arm")

    found = judged(campaign(LOW, robots={"toy": cdv.Robot(Broken, spec)}))
    assert found.wrong == [r"low (toy): crashed: ValueError: no power\nat the arm"]


@pytest.mark.parametrize("where", [{}, {"strategy": "climbs"}, {"test": "high"}, {"robot": "toy"}])
def test_an_expected_failure_is_none(campaign, where):
    known = cdv.ExpectedFailure("T1", "the motor is too strong", **where)
    found = judged(campaign(LOW, HIGH, expected_failures=[known]))
    assert found.wrong == []
    assert found.tests[1].known == ("T1 failed, as expected: the motor is too strong",)


def test_an_expected_failure_elsewhere_excuses_nothing(campaign):
    known = [cdv.ExpectedFailure("T1", "why", test="low"), cdv.ExpectedFailure("T2", "why")]
    wrong = judged(campaign(LOW, HIGH, expected_failures=known)).wrong
    assert wrong == [
        f"high (toy): {TOO_HIGH}",
        "T1 of test low is expected to fail (why): it did not, in 1 test",
        "T2 is expected to fail (why): it did not, in 2 tests",
    ]


def test_an_expected_failure_need_not_occur_if_it_is_rare_or_cannot_be_triggered(campaign):
    """A residual risk excuses failures, and is no error without them."""
    known = cdv.ExpectedFailure("T1", "why", strategy="other")
    assert judged(campaign(LOW, expected_failures=[known])).wrong == []
    risk = cdv.ExpectedFailure("T1", "the motor is strong", seldom=True)
    assert judged(campaign(LOW, expected_failures=[risk])).wrong == []
    found = judged(campaign(LOW, HIGH, expected_failures=[risk]))
    assert found.wrong == []
    assert found.known == {"T1 failed, as expected: the motor is strong": 1}


def test_strict_wants_all_decided(campaign):
    found = judged(campaign(("flat", {"level": 1.0}), ("known", {"does": "crash"})), strict=True)
    assert "known (toy): T3 is inconclusive" in found.wrong
    assert "T2 is triggered (toy): none of 2 tests passed or failed it" in found.wrong
    assert judged(campaign(LOW), strict=True).wrong == []


def test_a_gate_excepts_what_a_strategy_need_not_reach(campaign):
    """Each strategy has its own exceptions; without any, all requirements must be triggered."""
    flat = ("flat", {"level": 1.0})
    untriggered = "T2 is triggered (toy): none of 1 test passed or failed it"
    assert judged(campaign(flat), strict=True).wrong == [untriggered]
    for gates in ({"climbs": cdv.Gate(["T2"])}, {"": cdv.Gate(["T2"])}):
        assert judged(campaign(flat, gates=gates), strict=True).wrong == []
    open_end = campaign(("open", {"does": "end early", "level": 3.0}))
    assert "open (toy): T3 is inconclusive" not in judged(open_end).wrong


def test_a_gate_lets_a_test_leave_something_open(campaign):
    tests = [("crash", {"does": "crash", "expected": {"T1": "P"}}), LOW]
    wrong = judged(campaign(*tests), strict=True).wrong
    assert "crash (toy): T3 is inconclusive" in wrong
    gate = cdv.Gate(inconclusive=["T3"])
    eased = judged(campaign(*tests, gates={"climbs": gate}), strict=True).wrong
    assert "crash (toy): T3 is inconclusive" not in eased
    assert set(eased) < set(wrong)


def test_a_gate_has_a_bar_of_coverage(campaign):
    reached = {"states": ("down", "up", "away")}
    for bar, wrong in ((30, []), (99, ["at least 99 % are covered (climbs, toy)"])):
        gates = {"climbs": cdv.Gate(coverage=bar)}
        found = judged(
            campaign(LOW, HIGH, gates=gates, **reached, expected_failures=[]), strict=True
        )
        told = [one for one in found.wrong if "covered" in one]
        assert [one.partition(":")[0] for one in told] == wrong


def test_a_test_must_reach_what_it_declares(campaign):
    """Otherwise it is an error, even if all its verdicts are as expected."""
    climbs_to_up = {"level": 3.0, "reaches": {"states": ["up"]}}
    lost = {**climbs_to_up, "expected": {"T1": "P"}, "reaches": {"states": ["up", "away"]}}
    found = judged(campaign(("up", climbs_to_up), ("away", lost)))
    assert found.wrong == ["away (toy): states: away is not reached"]


def test_what_is_called_unreachable_is_not_to_be_hit(campaign):
    for item, wrong in (("away", ""), ("up", "low hits states: up")):
        out = cdv.Closing(unreachable=[cdv.Unreachable("states", item, "the motor is weak")])
        options = {"states": ("down", "up", "away"), "closing": out}
        found = judged(campaign(LOW, ("lower", {"level": 2.0}), **options))
        assert found.checks == {"no test hits an item that is declared unreachable (toy)": wrong}


def test_a_state_that_the_campaign_does_not_list_must_not_be_entered(campaign):
    """A misspelt name would silently leave another state uncovered."""
    wrong = "only states of the campaign are entered (toy): low enters `up`"
    for states, expected in ((("down", "upp"), [wrong]), (("down", "up"), []), ((), [])):
        assert judged(campaign(LOW, states=states)).wrong == expected


def known(**what):
    """An expected failure."""
    return {"expected_failures": [cdv.ExpectedFailure(**{"requirement": "T1", **what}, reason="")]}


@pytest.mark.parametrize(
    "options",
    [
        *(known(requirement="T9"), known(strategy="luck"), known(robot="r")),
        *({"gates": {"luck": cdv.Gate()}}, {"gates": {"": cdv.Gate(["T9"])}}),
    ],
)
def test_an_expected_failure_or_gate_with_an_unknown_name_is_an_error(campaign, options):
    """A misspelt name would silently have no effect."""
    with pytest.raises(UnknownNameError, match="there are"):
        refuse_unknown(campaign(LOW, **options))


def test_junit_has_a_case_per_test_and_per_expectation(campaign, golden):
    """Failures, errors, known failures as skipped; an incomplete campaign is an error."""
    known = [cdv.ExpectedFailure("T1", "too strong", test="high")]
    known += [cdv.ExpectedFailure("T2", "fixed since")]
    tests = (LOW, HIGH, ("higher", {"level": 7.0, "text": "far up"}), CRASH)
    judgement = judged(campaign(*tests, expected_failures=known))
    text = junit_xml("toys", replace(judgement, cut_short="interrupted"))
    root = ET.fromstring(text)  # noqa: S314 - our own
    for case in root.iter("testcase"):
        if "time" in case.attrib:
            case.set("time", "0.0")
    golden("junit.xml", ET.tostring(root, encoding="unicode"))
    assert [
        (suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("errors"))
        for suite in root
    ] == [("toys.toy.climbs", "4", "1", "1"), ("toys", "3", "1", "1")]


def test_what_must_not_be_hit_is_wrong(campaign, spec):
    spec.write_text(spec.read_text() + "coverpoint height = level {illegal high: [5, inf)}\n")
    known = ("known", {"level": 6.0, "expected": {"T1": "F"}})
    assert judged(campaign(LOW, known)).wrong == [
        "known (toy): illegal: `high` of `height` was hit at 1 s"
    ]
