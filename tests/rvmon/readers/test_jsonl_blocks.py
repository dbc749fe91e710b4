"""JSON lines read by columns: the same report as line by line, or not at all."""

import json
import random
from collections import Counter

import pytest

import rvmon
from rvmon.cli.judging import Options, judge
from rvmon.readers import jsonl_blocks as module
from rvmon.readers.batch import NotPlainError
from rvmon.readers.jsonl_blocks import jsonl_blocks
from rvmon.readers.source import Source
from rvmon.trace.schema import Kind, Schema

SPEC = """
spec watch "A base"
time {time}
signal p : bool
signal arm.speed : real
signal count : int
event stop
requirement R1 "a"
  upon stop
  then within 1 s arm.speed < 0.2
requirement R2 "b"
  whenever p and once[100 ms, 900 ms] count > 2
  then within 700 ms arm.speed * 2 + 1 < 1.5
"""
SCHEMA = Schema({"p": Kind.BOOL, "n": Kind.INT, "x": Kind.REAL}, {"go": {}})
ALL = frozenset({"p", "n", "x", "go"})


def lines(seed: int, *, gaps: bool = False, rows: int = 2000) -> list[dict]:
    """A plain recording: nested names, an undeclared one, whole numbers among the others."""
    rng = random.Random(seed)
    t, speed, p, count = 0, 0.3, False, 0
    made = []
    for row in range(rows):
        t += rng.choice([1, 50_000_000, 49_999_999, 600_000_000])
        speed = rng.choice([speed, speed, speed + 0.01, speed - 0.01, 0, 1])
        p ^= rng.random() < 0.05
        count = rng.randrange(5) if rng.random() < 0.1 else count
        line = {"t_ns": t, "arm": {"speed": speed, "more": [1]}, "p": rng.choice([p, int(p)])}
        line |= {"count": count, "stop": rng.random() < 0.02, "note": rng.choice(["a", 1, None])}
        if gaps and row:
            line = {k: v for k, v in line.items() if k == "t_ns" or rng.random() < 0.4}
        made.append(line)
    return made


def written(path, found: list[dict]):
    path.write_text("".join(json.dumps(line) + "\n" for line in found))
    return path


def by_lines(spec: rvmon.Spec, path) -> rvmon.Report:
    """The report of the slow way."""
    monitor = spec.monitor()
    for sample in spec.recording(path):
        monitor.step_ns(sample.t, sample.values)
    return monitor.finish_ns(None)


@pytest.mark.law
@pytest.mark.parametrize("gaps", [False, True])
@pytest.mark.parametrize("time", ["held", "sampled every 20 ms", "sampled"])
def test_columns_say_what_lines_say(time, gaps, tmp_path, monkeypatch):
    """Verdicts, records, reasons and health are the same, wherever a block ends."""
    monkeypatch.setattr(module, "BLOCK", 1999)
    path = written(tmp_path / "a.jsonl", lines(1, gaps=gaps))
    spec = rvmon.loads(SPEC.format(time=time))
    read = spec.recording(path)
    report = spec.judge(Source(read))
    assert report == by_lines(spec, path)
    assert {"P", "F"} <= {attempt.verdict for attempt in report.attempts}
    recording = spec.recording(path)
    list(recording)
    assert list(read.ignored.items()) == list(recording.ignored.items())


@pytest.mark.parametrize("until", [None, 31.4])
def test_undeclared_names_are_counted_once(until, tmp_path):
    """What is judged by columns reports as many as the recording holds up to its end."""
    path = written(tmp_path / "a.jsonl", lines(2, rows=300))
    spec = rvmon.loads(SPEC.format(time="held"))
    report = judge(spec, str(path), Options(until=until)).report
    counts = {one.name: one.count for one in report.health}
    slow = judge(spec, str(path), Options(until=until, coverage=True)).report
    assert counts == {one.name: one.count for one in slow.health}
    assert set(counts) == {"arm.more", "note"}


PLAIN = '{"t": 1, "p": true, "n": 1, "x": 0.5, "go": false}'


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[1]",
        '{"p": true}',
        '{"t": 1, "t_ns": 1, "p": true, "n": 1, "x": 1}',
        '{"t": 1, "p": true, "n": 1}',
        PLAIN.replace("true", "null"),
        PLAIN.replace("true", "2"),
        PLAIN.replace("true", '"yes"'),
        PLAIN.replace('"n": 1', '"n": 1.0'),
        PLAIN.replace('"n": 1', f'"n": {2**70}'),
        PLAIN.replace("0.5", "true"),
        PLAIN.replace("0.5", "{}"),
        PLAIN.replace('"t": 1', '"t": 1e300'),
        PLAIN.replace('"t": 1', '"t_ns": 1.5'),
        PLAIN.replace('"t": 1', '"t": "1"'),
        PLAIN.replace("false", '{"id": 1}'),
        PLAIN.replace('"go": false', '"events": ["go"]'),
        f"{PLAIN}\n{PLAIN}",
        f"{PLAIN}\n{PLAIN.replace('1', '0', 1)}",
        f"{PLAIN}\n\n{PLAIN.replace('1', '2', 1)}",
        f"{PLAIN}\n{PLAIN.replace('1', '2', 1)[:-1]}",
        f"{PLAIN}\n{PLAIN.replace('1', '2', 1)} {PLAIN.replace('1', '3', 1)}",
        f"{PLAIN}\n{PLAIN.replace('1', '2', 1).replace('p', 'q')}",
        f"{PLAIN}\n{PLAIN.replace('1', '2', 1).replace('true', '[]')}",
        f"{PLAIN}\r{PLAIN.replace('1', '2', 1)}",
        "\ufeff" + PLAIN,
        PLAIN[:-1] + ', "\u00e9": 1}',
    ],
)
def test_what_is_not_plain_is_left_to_whoever_reads_lines(text, tmp_path):
    """A file with more than numbers and truth values, or with a fault, is not read by columns."""
    path = tmp_path / "a.jsonl"
    path.write_bytes(text.encode())
    with pytest.raises(NotPlainError):
        list(jsonl_blocks(path, SCHEMA, ALL, Counter()))


@pytest.mark.parametrize("name", ["arm.speed", "note.more"])
def test_a_name_that_is_flat_and_nested_loses_no_value(name, tmp_path):
    """A line that holds a name in both ways is left to whoever reads lines, who sees both."""
    outer, inner = name.split(".")
    found = [
        {"t": 0, name: 1.0, outer: {inner: 2.0}},
        {"t": 1, name: 9.0},
        {"t": 2, outer: {inner: 1.0}},
    ]
    path = written(tmp_path / "a.jsonl", found)
    spec = rvmon.loads(
        'spec a "A"\nsignal arm.speed : real\nrequirement R\n  always arm.speed < 5.0\n'
    )
    with pytest.raises(NotPlainError):
        list(jsonl_blocks(path, spec.schema, frozenset({"arm.speed"}), Counter()))
    if name in spec.schema.signals:
        assert spec.evaluate(path).verdicts["R"] == "F"


def test_a_plain_file_is_read(tmp_path):
    """Values as declared; what a line leaves out holds, or does not occur."""
    path = tmp_path / "a.jsonl"
    path.write_text(f'{PLAIN}\r\n{{"t": 2.5, "go": true}}\n{{"t": 3, "p": 0, "x": 2, "n": -3}}\n')
    (block,) = jsonl_blocks(path, SCHEMA, ALL, Counter())
    assert block.times.tolist() == [1_000_000_000, 2_500_000_000, 3_000_000_000]
    assert {name: column.tolist() for name, column in block.columns.items()} == {
        "p": [True, True, False],
        "n": [1, 1, -3],
        "x": [0.5, 0.5, 2.0],
        "go": [False, True, False],
    }
    with pytest.raises(NotPlainError):
        list(jsonl_blocks(path, SCHEMA, frozenset(), Counter()))
