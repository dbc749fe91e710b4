"""Known failures are accepted until their last day."""

import datetime

import pytest
from tests.tools.each import each

from rvmon.errors import RvmonError
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.known_failures import KnownFailures, read_known
from rvmon.verdicts.report import report_of

FILE = """
[[known]]
requirement = "R1"
reason = "the motor is slow"
until = 2030-01-31
recording = "monday/*.csv"

[[known]]
requirement = "R2"
reason = "recalled"
until = 2031-01-01
"""


def report(trace, *failed):
    """R1 and R2 on a recording, with some failures."""
    attempts = [
        Attempt(name, 1, 0, 1, Verdict.FAIL if name in failed else Verdict.PASS)
        for name in ("R1", "R2")
    ]
    return report_of(["R1", "R2"], attempts, trace=trace)


@pytest.fixture
def known(tmp_path):
    """The failures that a file accepts on a day."""
    path = tmp_path / "known.toml"
    path.write_text(FILE)
    return lambda day: KnownFailures(
        read_known(path, ["R1", "R2"]), datetime.date.fromisoformat(day)
    )


def test_a_known_failure_is_accepted_in_its_recordings(known):
    """In recordings that match its pattern, in any folder, including on its last day."""
    accepted = known("2030-01-31")
    assert accepted.failures(report("logs/monday/3.csv", "R1", "R2")) == []
    assert accepted.failures(report("logs/tuesday/3.csv", "R1", "R2")) == ["R1"]
    assert accepted.expected(report("monday/3.csv")) == {
        "R1": "the motor is slow (until 2030-01-31)",
        "R2": "recalled (until 2031-01-01)",
    }


def test_after_its_last_day_it_is_a_failure_again(known):
    over = known("2030-02-01")
    failing = report("monday/3.csv", "R1", "R2")
    assert over.failures(failing) == ["R1"]
    assert list(over.remarks([failing])) == [
        "R1 (the motor is slow) was known to fail until 2030-01-31, and still fails: monday/3.csv"
    ]


def test_a_known_failure_that_no_longer_occurs_is_reported(known):
    """Only if one of its recordings shows that."""
    fine = report("monday/3.csv", "R2")
    assert list(known("2030-01-01").remarks([fine])) == [
        "R1 (the motor is slow) is known to fail, but does not: remove it from the file"
    ]
    assert list(known("2030-01-01").remarks([report("tuesday/3.csv", "R2")])) == []


@each(
    ("text", "told"),
    [
        ("[[known", "known.toml"),
        ('[[known]]\nrequirement = "R1"\nuntil = 2030-01-31', "missing required field `reason`"),
        ('[[known]]\nrequirement = "R1"\nreason = "x"\nuntil = "soon"', "until"),
        ('[[known]]\nrequirement="R1"\nreason="x"\nuntil=2030-01-31\nday=1', "unknown field `day`"),
        ('[[known]]\nrequirement = "R11"\nreason = "x"\nuntil = 2030-01-31', "did you mean `R1`"),
        ('[[known]]\nrequirement = "R1"\nreason = " "\nuntil = 2030-01-31', "say in `reason` why"),
        ("known = 3", "Expected `array`"),
    ],
)
def test_a_file_that_is_wrong_is_refused(tmp_path, text, told):
    path = tmp_path / "known.toml"
    path.write_text(text)
    with pytest.raises(RvmonError, match=r"known\.toml") as caught:
        read_known(path, ["R1", "R2"])
    assert told in str(caught.value)
    with pytest.raises(RvmonError, match="cannot read"):
        read_known(tmp_path / "none.toml", ["R1"])
