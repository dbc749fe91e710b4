"""A campaign decides whether a requirement holds in a given share of runs."""

import json
import random

import pytest
from tests.tools.each import each

from rvmon.cdv.sequential_test import ALPHA, BETA, decide, errors_text
from rvmon.cli.campaign import main
from rvmon.language.checked.specification import RunShare
from rvmon.verdicts import Verdict

P, F, NT, I = Verdict  # noqa: E741 - the letters of the tables
MOST = RunShare(at_least=False, percent=5.0)
LEAST = RunShare(at_least=True, percent=95.0)


@each(
    ("share", "verdicts", "holds", "tests"),
    [
        (LEAST, [P] * 200, True, 57),
        (LEAST, [NT, P] * 200, True, 57),
        (LEAST, [F] * 200, False, 3),
        (MOST, [F] * 200, True, 57),
        (MOST, [P] * 200, False, 3),
        (LEAST, [P] * 56, None, 56),
        (LEAST, [NT] * 999, None, 0),
        (LEAST, [I] * 999, None, 999),
        (LEAST, ([P] * 19 + [I]) * 50, None, 1000),
        (LEAST, [I] + [P] * 99, True, 79),
        (LEAST, [I] + [F] * 9, False, 4),
    ],
)
def test_a_share_is_decided_with_as_few_tests_as_possible(share, verdicts, holds, tests):
    """Runs without a trigger do not count; inconclusive ones count against either decision."""
    found = decide(share, verdicts)
    assert (found.holds, found.tests) == (holds, tests)


@pytest.mark.slow
@pytest.mark.parametrize("share", [LEAST, MOST, RunShare(at_least=True, percent=50.0)])
def test_errors_are_as_stated(share):
    """At both ends of the indifference region, over 1,500 campaigns with inconclusive tests."""
    rng = random.Random(1)
    low, high = decide(share, []).indifference
    good, bad = (high, low) if share.at_least else (low, high)

    def verdicts(true_share):
        for _ in range(400):
            verdict = P if rng.random() < true_share else F
            yield I if rng.random() < 0.001 else verdict

    wrong = {True: 0, False: 0}
    for true_share, answer in ((good, False), (bad, True)):
        for _ in range(1500):
            wrong[answer] += decide(share, verdicts(true_share)).holds is answer
    assert 0 < wrong[False] <= 1500 * ALPHA
    assert 0 < wrong[True] <= 1500 * BETA


@pytest.mark.parametrize("before", [[], [P] * 20, [P] * 30 + [F], [I] * 4, [P] * 56])
def test_so_many_tests_are_missing(before):
    missing = decide(LEAST, before).missing
    assert decide(LEAST, before + [P] * missing).holds is True
    assert decide(LEAST, before + [P] * (missing - 1)).holds is None


def test_what_is_decided_is_said_with_its_errors():
    assert str(decide(LEAST, [P] * 9 + [I])) == (
        "undecided (9 of 10 triggered tests passed, 1 inconclusive): 69 more tests at least, "
        "if all pass"
    )
    assert "if all fail" in str(decide(MOST, []))
    nearly = decide(RunShare(at_least=True, percent=99.0), [])
    assert errors_text(nearly).endswith("unless the true share is between 98.5 and 99.5 %")


@pytest.mark.process
@pytest.mark.parametrize(
    ("share", "failing", "tests", "strict", "code", "told"),
    [
        ("at least 50", 1, 20, False, 0, "holds ("),
        ("at least 50", 20, 20, False, 1, "does not hold (0 of"),
        ("at most 50", 20, 20, False, 0, "holds (0 of"),
        ("at least 50", 1, 3, False, 0, "undecided (2 of 3 triggered tests passed): "),
        ("at least 50", 1, 3, True, 1, "undecided (2 of 3 triggered tests passed): "),
    ],
)
def test_a_campaign_is_judged_by_its_shares(
    campaign, spec, tmp_path, capsys, share, failing, tests, strict, code, told
):
    """One failure is not enough; the decision is in tables and JUnit, and sets the exit code."""
    clause = f"always level < 5\n  in {share} % of runs"
    spec.write_text(spec.read_text().replace("always level < 5", clause).replace("> 2", ">= 0"))
    made = campaign(*((f"t{n}", {"level": 6.0 if n < failing else 0.5}) for n in range(tests)))
    junit, out = tmp_path / "junit.xml", tmp_path / "out"
    words = ["run", "--jobs", "1", "--out", str(out), "--junit", str(junit)]
    assert main(made, [*words, *(["--strict"] if strict else [])]) == code
    printed = capsys.readouterr()
    line = f"T1 in {share} % of runs: under climbs {told}"
    assert line in " ".join(printed.out.split())
    assert ("not as expected: T1 in" in printed.err) is bool(code)
    assert f'name="T1 in {share} % of runs (toy)"' in junit.read_text()
    assert line in (out / "report.html").read_text()
    found = json.loads((out / "table.json").read_text())["robots"]["toy"]["strategies"]["climbs"]
    holds = {"holds": True, "does not": False, "undecide": None}[told.split(" (")[0][:8].strip()]
    assert found["shares"]["T1"]["holds"] is holds
    assert found["requirements"]["T1"]["F"] == failing
