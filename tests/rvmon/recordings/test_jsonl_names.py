"""A name that is twice in a JSON object is ambiguous."""

import json
import random

import pytest
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError
from rvmon.recordings.jsonl_rows import count_of_names, names_in

SPEC = rvmon.loads(
    "spec s\nsignal s : real\nsignal a.b : real\nevent go(n : int)\n"
    "requirement R\n  always s < 10\nrequirement R2\n  upon go.n > 0\n  then s < 10 and a.b < 10\n"
)

PLAIN = '{"t": %d, "s": 1, "a": {"b": 2}, "go": {"n": 3}, "u": [{"v": "w:x"}]}\n'


@each("lines", [0, 5, 600])
@each(
    ("line", "name"),
    [
        ('{"t": 9000, "s": 1, "s": 50}', "s"),
        ('{"t": 9000, "s" : 1, "s"\t: 50}', "s"),
        ('{"t": 9000, "t": 9001, "s": 1}', "t"),
        ('{"t": 9000, "s": 1, "a": {"b": 1, "b": 1}}', "b"),
        ('{"t": 9000, "s": 1, "a": {"b": 1}, "a": {}}', "a"),
        ('{"t": 9000, "s": 1, "a": {"b": 1}, "a.b": 2}', "a.b"),
        ('{"t": 9000, "s": 1, "go": {"n": 1, "n": 2}}', "n"),
        ('{"t": 9000, "s": NaN, "s": 1}', "s"),
        ('{"t": 9000, "s": 1, "u": [{"v": 1, "v": 2}]}', "v"),
    ],
)
def test_it_is_an_error_with_its_line(tmp_path, lines, line, name):
    path = tmp_path / "a.jsonl"
    path.write_text("".join(PLAIN % t for t in range(lines)) + line + "\n")
    told = rf"(`{name}` appears 2 times in one object|two fields of the line stand for `{name}`)"
    with pytest.raises(TraceError, match=f"line {lines + 1}: {told}"):
        SPEC.evaluate(path)


def test_lines_that_have_each_name_once_are_read():
    rng = random.Random(1)
    parts = ["a", '"', ":", '":', ' "x" : 1', "\\", "\n", "é", "{", "}"]

    def drawn(depth):
        kind = rng.randrange(4 if depth else 2)
        if kind == 2:
            return {"".join(rng.choices(parts, k=2)): drawn(depth - 1) for _ in range(3)}
        if kind == 3:
            return [drawn(depth - 1) for _ in range(2)]
        return rng.random() if kind else "".join(rng.choices(parts, k=4))

    plain = 0
    for _ in range(1000):
        value = drawn(3)
        text = json.dumps(value, ensure_ascii=rng.random() < 0.5)
        plain += names_in(text) == count_of_names(value)
        assert names_in(text) == names_in(text.encode())
        assert names_in(text) in (-1, *range(count_of_names(value), len(text)))
    assert plain > 150
