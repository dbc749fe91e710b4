"""`rvmon why` shows an attempt: verdict, truth of its parts over time, values."""

import json

import pytest
from tests.rvmon.cli.conftest import DOOR
from tests.tools.logs import write_ulog

from rvmon.recordings import places

SPEC = f"""{DOOR}
requirement D2
  upon fall(closed)
  then immediately not knock
"""


@pytest.fixture
def door(door):
    """A folder with a recording in which D1 passes, fails and stays open."""
    (door / "door.rv").write_text(SPEC)
    (door / "a.csv").write_text("t,closed,knock\n0,1,\n1,,1\n2,0,\n3,1,\n4,,1\n8,,1\n9,,\n")
    return door


@pytest.mark.slow
@pytest.mark.parametrize(
    ("named", "verdict", "when"),
    [
        ("D1#1", "P", "triggered 1 s, decided 2 s"),
        ("D1#2", "F", "triggered 4 s, decided 6.000000001 s"),
        ("D1#3", "I", "triggered 8 s"),
        ("D1", "F", "triggered 4 s, decided 6.000000001 s"),
        ("D2", "P", "triggered 2 s, decided 2 s"),
    ],
)
def test_an_attempt_is_shown_with_verdict_and_times(door, says, named, verdict, when):
    lines = says(0, "why", "door.rv", "a.csv", named).out.splitlines()
    assert lines[0].split()[1] == verdict
    assert f"  {when}" in lines
    assert all(len(line) <= 80 for line in lines)
    assert any(line.strip() == "required" for line in lines)


def test_rows_draw_the_truth_of_a_part_over_the_window(put, says):
    """A column is a second and shows edges, moments, and whether all or some of it is unknown."""
    steps = {0: False, 3: True, 4.5: False, 6.2: True, 6.4: False, 9: True, 12.3: False}
    steps |= {12.6: True, 14.5: False, 14.7: True, 14.9: False, 17.5: None, 20: True, 22.5: None}
    steps |= {25: True, 26.5: False, 30.5: True, 46: True}
    samples = [{"t": t, "p": p, "q": False, "go": t == 0} for t, p in steps.items()]
    text = "requirement R\n  upon go then within 44 s (p and q)\n"
    put("a.rv", f"spec a\nsignal p, q : bool\nevent go\n{text}")
    put("a.jsonl", "\n".join(map(json.dumps, samples)) + "\n")
    lines = says(0, "why", "a.rv", "a.jsonl", "R").out.splitlines()
    rows = {line[:34].strip(): line[34:] for line in reversed(lines)}
    assert rows["go"] == "●" + "▁" * 45
    assert rows["p"] == "▁▁▁▇╲▁●▁▁▇▇▇○▇╲▁▁???▇▇▇??▇╲▁▁▁╱" + "▇" * 15


def test_a_possible_attempt_has_a_name_with_a_question_mark(door, says):
    (door / "a.jsonl").write_text(
        '{"t": 0, "closed": true, "knock": true}\n{"t": 1, "knock": null}\n{"t": 9}\n'
    )
    for name, verdict in (("D1#1", "F"), ("D1?1", "I")):
        assert says(0, "why", "door.rv", "a.jsonl", name).out.split()[:2] == [name, verdict]
    told = says(2, "why", "door.rv", "a.jsonl", "D1?2").err
    assert "no attempt D1?2: there are D1#1 to D1?1" in told


def test_values_of_signals_are_shown_at_trigger_and_end(put, says):
    """Only once if these coincide; a NaN is not known."""
    put(
        "a.rv",
        "spec a\nsignal force : real [N] input\nsignal grip : {open, closed} output\n"
        "event go input\nrequirement A1\nupon go then within 1 s (grip = closed and force > 3 N)\n"
        "requirement B1\nupon go then immediately grip = closed\n",
    )
    put("a.csv", "t,force,grip,go\n0,0.30000000000000004,open,1\n0.5,nan,closed,\n3,,,\n")
    rows = [line.split("  ") for line in says(0, "why", "a.rv", "a.csv", "A1").out.splitlines()]
    told = [[cell.strip() for cell in row if cell.strip()] for row in rows][-3:]
    assert told == [
        ["values", "at the trigger", "at the end"],
        ["grip", "open", "closed"],
        ["force", "0.3 N", "not known"],
    ]
    told = says(0, "why", "a.rv", "a.csv", "B1", "--format", "json").out
    assert json.loads(told)["values"] == {"grip": ["open"]}


def test_the_missing_condition_or_time_is_named(put, says):
    """A nearest miss if nothing triggered; the necessary length if nothing was decided."""
    text = "spec s\nsignal a, b : bool\nevent e, f\nrequirement R1\n  upon {}\n"
    put("t.csv", "t,a,b,e,f\n0,false,false,,\n1,,,1,\n3,,,,1\n")
    put("s.rv", text.format("e and a then within 1 s b"))
    told = says(2, "why", "s.rv", "t.csv", "R1").err
    assert "`a` was never true while `e` was (first at 1 s)" in told
    put("s.rv", text.format("e then within 5 s f"))
    told = says(0, "why", "s.rv", "t.csv", "R1", "--until", "2").out
    assert "a recording more than 4 s longer would have decided it" in " ".join(told.split())


@pytest.mark.parametrize("rows", range(1, 5))
def test_until_may_fall_on_the_end_of_a_block(put, says, monkeypatch, rows):
    put("s.rv", "spec s\nsignal x : real\nrequirement R1\n  always x < 9\n")
    put("t.csv", "t,x\n" + "".join(f"{t},{t}\n" for t in range(8)))
    asked = ["why", "s.rv", "t.csv", "R1", "--until", "3"]
    whole = says(0, *asked).out
    monkeypatch.setattr(places, "BLOCK", 4 * (1 + rows))
    assert says(0, *asked).out == whole


def test_truth_is_unknown_where_a_log_lost_data(door, says):
    """The verdict is the same as that of `rvmon run`."""
    write_ulog(door / "a.ulg", [(10**6 + 10_000 * k, 1.0, 2) for k in range(100)], [(49, 250)])
    (door / "u.toml").write_text('[bind.speed]\ntopic = "/drive"\nvalue = "speed"\nunit = "m/s"\n')
    (door / "u.rv").write_text(
        "signal speed : real [m/s]\nrequirement R\n  upon start then for 900 ms speed < 3 m/s\n"
    )
    asked = ["u.rv", "a.ulg", "--binding", "u.toml", "--format", "json"]
    assert json.loads(says(0, "run", *asked).out)["requirements"]["R"]["verdict"] == "I"
    told = json.loads(says(0, "why", *asked[:2], "R#1", *asked[2:]).out)
    assert told["attempt"]["verdict"] == "I"
    row = next(one for one in told["part_truths"] if one["text"] == "speed < 3 m/s")
    second = 10**9
    assert row["true"] == [[second, row["true"][0][1]], [row["true"][1][0], 2 * second - 10**7]]
    assert row["false"] == []
    lost = range(row["true"][0][1] + 1, row["true"][1][0])
    assert len(lost) >= second // 4
    assert second + 5 * second // 10 in lost


def test_the_triggers_end_and_true_have_no_row(put, says):
    for trigger in ("upon end", "whenever true"):
        text = f"spec a\nsignal p : bool\nrequirement R\n{trigger} then immediately p\n"
        put("a.rv", text)
        put("a.csv", "t,p\n0,1\n1,0\n")
        told = says(0, "why", "a.rv", "a.csv", "R", "--format", "json").out
        texts = [row["text"] for row in json.loads(told)["part_truths"]]
        assert texts == ["immediately p", "p"][-len(texts) :], trigger
