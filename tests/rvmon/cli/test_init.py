"""`rvmon init` writes a specification that passes on its recording without an edit."""

import json
import random
from pathlib import Path

import pytest
from tests.tools.each import each

import rvmon
from rvmon.cli import main

RECORDINGS = {
    "plain.csv": "t,speed,door\n0,0.5,true\n1,0.7,false\n2,,true\n",
    "zero_one.csv": "t,closed\n0,0\n1,1\n2,1\n",
    "only_numbers.csv": "t_ns,x\n0,1\n7,2\n9,nan\n",
    "only_event.csv": "t,go\n0,\n1,1\n2,\n3,1\n4,\n",
    "one_row.csv": "t,x,mode\n5.5,1,idle\n",
    "largest.csv": "t,x\n0,1.7e308\n1,1.797e308\n2,1.75e308\n",
    "late.csv": "t,x\n0,1\n2,2\n1.5,3\n3,4\n",
    "odd_names.csv": "t,for,a b,source,U,age,rate,always,mode\n0,1,2,3,4.5,1,2,true,for\n"
    "1,1,3,3,4.5,1,2,false,red hot\n",
    "unusable.csv": "t,x,note,empty,ok\n0,1,a,,1\n1,b,7,,2\n2,3,c,,3\n",
    "times.csv": "t,x\n1700000000.000000001,1\n1700000000.5,2\n",
    "9 lives.csv": "t,x\n0,1\n1,2\n",
    "bom.csv": "\ufefft,x\n0,1\n1,2\n",
    "plain.jsonl": '{"t":0,"speed":1,"mode":"idle"}\n{"t":0.5,"speed":1.5,"door":true}\n',
    "events.jsonl": '{"t":0,"x":1}\n{"t":1,"events":["go"]}\n{"t":1.4,"events":["done"]}\n',
    "nested.jsonl": '{"t":0,"arm":{"x":1,"y":{"z":2}}}\n{"t":1,"arm":{"x":2,"y":null}}\n',
    "payload.jsonl": "".join(f'{{"t":{t},"x":{t}}}\n' for t in range(9))
    + '{"t":9,"pick":{"id":3,"x":0.5,"by":"arm"}}\n{"t":10,"x":3}\n',
    "payloads.jsonl": '{"t":0,"x":1}\n{"t":1,"pick":[{"id":3}]}\n{"t":2,"x":null}\n',
    "century_late.csv": "t,x\n4611686018,1\n0,2\n1,3\n",
    # The silence between the clocks, rounded up, is longer than a specification can express.
    "two_clocks.csv": "t,x,go,done\n0,0.5,,\n1,0.7,1,\n4500000000,0.6,,1\n4500000001,0.6,1,\n"
    "4500000002,0.6,,1\n",
    "nulls.jsonl": '{"t":0,"x":null}\n{"t":1,"x":2,"list":[1,2],"both":1}\n{"t":2,"both":"a"}\n',
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDINGS)
def test_the_specification_passes_on_its_recording(name, put, says):
    assert main(["init", put(name, RECORDINGS[name]), "-o", "made.rv"]) == 0
    are_far_apart = name in {"century_late.csv", "two_clocks.csv"}
    assert ("warning: from" in says(0, "run", "made.rv", name).out) is are_far_apart
    told = says(0, "run", "made.rv", name, "--format", "json")
    assert ("warning" in told.err) is are_far_apart
    shown = json.loads(told.out)
    verdicts = [requirement["verdict"] for requirement in shown["requirements"].values()]
    assert 1 <= len(verdicts) <= 6
    assert set(verdicts) <= {"P", "I"}


@each("cells", [("0.0", "-0.0"), ("-0.0", "0.0")])
def test_minus_zero_is_zero(cells, put, says):
    put("zero.csv", "t,x\n" + "".join(f"{t},{cell}\n" for t, cell in enumerate([*cells, "2.5"])))
    assert "it was between 0 and 2.5" in says(0, "init", "zero.csv", "-o", "-").out


@pytest.mark.slow
def test_specifications_of_random_recordings_do_not_fail_on_them(tmp_path):
    rng = random.Random(5)
    for number in range(30):
        columns = [_random_column(rng, 30) for _ in range(rng.randint(1, 5))]
        names = [f"c{index}" for index in range(len(columns))]
        rows = [
            f"{t * 0.1:.1f},{','.join(cells)}" for t, cells in enumerate(zip(*columns, strict=True))
        ]
        path = tmp_path / f"{number}.csv"
        path.write_text("\n".join([f"t,{','.join(names)}", *rows]))
        made = tmp_path / f"{number}.rv"
        assert main(["init", str(path), "-o", str(made)]) == 0
        report = rvmon.load(made).evaluate(path)
        assert "F" not in {verdict.value for verdict in report.verdicts.values()}, path.read_text()


def _random_column(rng, length):
    kind = rng.choice(["bool", "sparse", "int", "real", "label", "spike"])
    make = {
        "bool": lambda: rng.choice("01"),
        "sparse": lambda: rng.choice(["", "", "", "1"]),
        "int": lambda: str(rng.randint(-5, 5)),
        "real": lambda: rng.choice(["", f"{rng.uniform(-1, 1):.3f}"]),
        "label": lambda: rng.choice(["red", "green", "start"]),
        "spike": lambda: "1" if rng.random() < 0.05 else "0",
    }[kind]
    cells = [make() for _ in range(length)]
    return cells if any(cells) else ["1", *cells[1:]]


@each(
    ("name", "text", "said"),
    [
        ("a.csv", "time,x\n0,1\n", "`time` looks like it: name it"),
        ("a.csv", "t,x\n", "`x`: no value in the recording"),
        ("a.csv", "", "is empty"),
        ("a.csv", "t\n0\n", "no signal or event is found (there is only time)"),
        ("a.csv", "t,a,b,c,d,e\n", "(`a`, `b`, `c` and 2 more: no value in the recording)"),
        ("a.csv", "t,x\n0,1,2\n", "line 2"),
        ("a.csv", "t,x\nzero,1\n", "line 2"),
        ("a.jsonl", '{"t":0,\n', "line 1: not a JSON object"),
        ("a.jsonl", "[1]\n", "line 1: expected an object"),
        ("a.jsonl", '{"x":0}\n', "expected one time column"),
        ("a.txt", "x", "not a known format"),
        ("a.csv", "t,x\n\udcff\udcfe\x00", "a.csv"),
    ],
)
def test_bad_recordings_are_refused_with_their_place(name, text, said, tmp_path, says):
    path = tmp_path / name
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    shown = says(2, "init", path, "-o", tmp_path / "made.rv").err
    assert said in shown
    assert str(path) in shown
    assert not (tmp_path / "made.rv").exists()


@pytest.mark.slow
@each(
    ("name", "text", "time"),
    [
        ("a.csv", "stamp,t,x\n1000,1,1\n2000,2,3\n", "stamp:ms"),
        ("a.jsonl", '{"at":{"ms":1000},"x":1}\n{"at":{"ms":2000},"x":3}\n', "at.ms:ms"),
        ("a.csv", "when,x\n2024-05-01T12:00:00Z,1\n2024-05-01T12:00:01Z,2\n", "when:iso"),
    ],
)
def test_the_proposed_run_names_column_and_unit_of_time(name, text, time, put, says):
    shown = says(0, "init", put(name, text), "-o", "made.rv", "--force", "--time", time).out
    assert f"--time {time}" in shown
    assert {"x"} <= set(rvmon.load("made.rv").schema.signals) <= {"x", "t"}
    [command] = [line for line in shown.splitlines() if line.startswith("try:")]
    assert main([*command.split()[2:], "--format", "json"]) == 0


def test_a_signal_with_an_infinite_value_has_no_range(put, says):
    """A range of the finite values would fail on the recording."""
    rows = [f"{t / 10},{'-inf' if t == 7 else t % 5},{t % 3}" for t in range(40)]
    assert main(["init", put("a.csv", "\n".join(["t,x,y", *rows, ""]))]) == 0
    says(0, "run", "a.rv", "a.csv")
    text = Path("a.rv").read_text()
    assert "y stays in its range" in text
    assert "x stays in its range" not in text


def test_only_occurrences_of_an_event_with_a_payload_are_counted(put, says):
    picks = ['{"id":1}' if t in (4, 7) else "false" for t in range(20)]
    lines = [f'{{"t":{t},"x":{t},"pick":{pick}}}\n' for t, pick in enumerate(picks)]
    text = says(0, "init", put("a.jsonl", "".join(lines)), "-o", "-").out
    [line] = [line for line in text.splitlines() if "pick(" in line]
    assert line.endswith("# 2 times")
