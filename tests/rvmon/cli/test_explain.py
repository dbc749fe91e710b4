"""`rvmon explain`: requirements in words, with their shortest runs."""

import pytest
from tests.tools.each import each

SPEC = """
spec door "A door"
signal closed : bool input
signal speed : real [m/s] output
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2
  upon knock
  then within 3 s not closed
requirement D3
  upon start
  then eventually knock
requirement D4
  always (closed -> speed <= 0 m/s)
requirement D5
  upon knock and closed and not closed
  then within 2 s knock
requirement D6
  always (knock -> within 2 s for 1 s (closed and once[0, 1 s] knock))
"""


@pytest.mark.slow
@each(
    ("body", "said"),
    [
        ("{} count(knock since trigger) >= 2", "2 times or more since the trigger, knock occurs"),
        ("{} duration(closed since trigger) >= 3 s", "for 3 s or more since the trigger, closed"),
        ("{} integral(speed since trigger) >= 2 m", "integral of speed since the trigger is at"),
        ("{} duration(closed, 5 s) >= 3 s", "for 3 s or more in the last 5 s, closed is true"),
        # A truth value among numbers.
        ("always rung.loud", "rung.loud is true"),
        ("always not rung.loud", "rung.loud is false"),
        ("always bit(mode, 3)", "bit(mode, 3) is true"),
    ],
)
def test_measures_and_truth_values_are_put_into_words(put, says, body, said):
    body = body.format("upon knock then eventually")
    text = f"{SPEC}event rung(loud: bool)\nsignal mode : int\nrequirement W\n {body}\n"
    text = says(0, "explain", put("s.rv", text), "W").out
    assert said in " ".join(text.split())
    assert "`upon`" not in text


def test_the_instant_of_the_trigger_is_called_so(put, says):
    text = f"{SPEC}signal d : real [s]\nrequirement W\n  upon knock then within (d) closed\n"
    words = " ".join(says(0, "explain", put("s.rv", text), "W").out.split())
    assert "closed is true and the time since the trigger is at most `within`" in words


@pytest.mark.slow
def test_all_requirements_fit_80_columns(put, says):
    text = says(0, "explain", put("door.rv", SPEC)).out
    assert all(len(line) <= 80 for line in text.splitlines()), text
    assert text.count("The shortest run on which it") == 6


@pytest.mark.slow
def test_impossible_and_undecided_outcomes_are_reported(put, says):
    text = says(0, "explain", put("door.rv", SPEC), "D3").out
    assert "fails: never, whatever comes" in text
    assert "is not triggered: never, every run triggers it" in text
    assert "nothing can trigger it" in says(0, "explain", "door.rv", "D5").out
    few = ["--runs", "2", "--max-memory", "2000"]
    assert "not decided" in says(0, "explain", "door.rv", "D1", *few).out


def test_no_run_tells_two_equal_requirements_apart(put, says):
    twin = "\n upon a\n then immediately a\n"
    path = put("twins.rv", f"event a\nrequirement R1{twin}requirement R2{twin}")
    assert "No run was found" in says(0, "explain", path, "R1", "R2").out
