"""What a window came to where a requirement failed, as `rvmon run` tells it."""

import json

import pytest

from rvmon.cli import main

ROWS = "t,x,go\n0,1,\n1,4,1\n2,2.5,1\n3,0.5,1\n4,3,\n5,3,1\n9,3,1\n"


def told(tmp_path, capsys, requirement, rows=ROWS, time="held"):
    """By number of the failed attempt, the values that are told."""
    (tmp_path / "s.rv").write_text(
        f"time {time}\nsignal x : real [m]\nevent go\nrequirement R\n  {requirement}\n"
    )
    (tmp_path / "s.csv").write_text(rows)
    assert main(["run", str(tmp_path / "s.rv"), str(tmp_path / "s.csv"), "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)["requirements"]["R"].get("values", {})
    return {int(number): values for number, values in found.items()}


@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 500 ms"])
@pytest.mark.parametrize(
    ("requirement", "expected"),
    [
        (
            "upon go then immediately count(go, 2 s) <= 1",
            {2: {"count(go, 2 s)": "2"}, 3: {"count(go, 2 s)": "3"}, 4: {"count(go, 2 s)": "2"}},
        ),
        (
            "upon go then immediately max(x, 2 s) - min(x, 2 s) <= 2.5 m",
            {
                1: {"max(x, 2 s)": "4 m", "min(x, 2 s)": "1 m"},
                2: {"max(x, 2 s)": "4 m", "min(x, 2 s)": "1 m"},
                3: {"max(x, 2 s)": "4 m", "min(x, 2 s)": "0.5 m"},
            },
        ),
        ("always max(x, 2 s) < 4 m", {1: {"x": "4 m"}}),
    ],
)
def test_it_is_told_of_the_failures_that_are_shown(tmp_path, capsys, time, requirement, expected):
    assert told(tmp_path, capsys, requirement, time=time) == expected


@pytest.mark.parametrize(
    "requirement",
    [
        "upon go then immediately mean(x, 2 s) > 5 m",  # moves between samples
        "upon go then immediately max(x, 2 s) > v let v = x + 1 m",
    ],
)
def test_what_cannot_be_told_is_left_out(tmp_path, capsys, requirement):
    assert "max(x, 2 s)" not in str(told(tmp_path, capsys, requirement))
    assert "mean(x, 2 s)" not in str(told(tmp_path, capsys, requirement))


def test_a_person_reads_it_behind_the_reason(tmp_path, capsys):
    (tmp_path / "s.rv").write_text("event go\nrequirement R\n  always count(go, 10 s) <= 4\n")
    (tmp_path / "s.csv").write_text(ROWS)
    assert main(["run", str(tmp_path / "s.rv"), str(tmp_path / "s.csv")]) == 1
    assert "(count(go, 10 s) = 5)" in " ".join(capsys.readouterr().out.split())


def test_why_tells_it_at_trigger_and_end(tmp_path, capsys):
    (tmp_path / "s.rv").write_text("event go\nrequirement R\n  always count(go, 10 s) <= 3\n")
    (tmp_path / "s.csv").write_text(ROWS)
    words = [str(tmp_path / "s.rv"), str(tmp_path / "s.csv"), "R#1", "--format", "json"]
    assert main(["why", *words]) == 0
    assert json.loads(capsys.readouterr().out)["values"]["count(go, 10 s)"] == ["0", "4"]
