"""The values of windows at a failure, as `rvmon run` shows them."""

import json

import pytest

from rvmon.cli import main


@pytest.fixture
def files(tmp_path):
    """Writes a specification and a recording; returns their paths."""

    def written(requirement, time="held"):
        spec, rows = tmp_path / "s.rv", tmp_path / "s.csv"
        head = f"time {time}\nsignal x : real [m]\nevent go\n"
        spec.write_text(f"{head}requirement R\n  {requirement}\n")
        rows.write_text("t,x,go\n0,1,\n1,4,1\n2,2.5,1\n3,0.5,1\n4,3,\n5,3,1\n9,3,1\n")
        return [str(spec), str(rows)]

    return written


def told(words, capsys):
    """The values shown, by number of the failed attempt."""
    assert main(["run", *words, "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)["requirements"]["R"].get("values", {})
    return {int(number): values for number, values in found.items()}


@pytest.mark.slow
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
def test_it_is_told_of_the_failures_that_are_shown(files, capsys, time, requirement, expected):
    assert told(files(requirement, time), capsys) == expected


@pytest.mark.parametrize(
    "requirement",
    [
        "upon go then immediately mean(x, 2 s) > 5 m",  # moves between samples
        "upon go then immediately max(x, 2 s) > v let v = x + 1 m",
    ],
)
def test_what_cannot_be_told_is_left_out(files, capsys, requirement):
    assert "(x, 2 s)" not in str(told(files(requirement), capsys))


def test_a_person_reads_it_behind_the_reason_and_why_at_trigger_and_end(files, capsys):
    assert main(["run", *files("always count(go, 10 s) <= 4")]) == 1
    assert "(count(go, 10 s) = 5)" in " ".join(capsys.readouterr().out.split())
    words = files("always count(go, 10 s) <= 3")
    assert main(["why", *words, "R#1", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["values"]["count(go, 10 s)"] == ["0", "4"]
