"""Programs made by `rvmon build` against `rvmon run`."""

import json
import random
import struct
import subprocess

import pytest

from rvmon.cli import main

pytestmark = pytest.mark.compiler

COLUMNS = ("open_door", "arm.speed", "parts", "mode", "pick", "pick.id", "pick.force", "halt", "x")
MODES = ("idle", "stopped")


def rows(seed: int):
    """Random rows: decimal time, and text by column."""
    rng = random.Random(seed)
    t = rng.choice([0, 1_700_000_000 * 10**9, -5 * 10**9])
    row = None
    for _ in range(400):
        t += rng.choice([0, 1, 50_000_000, 123_456_789, 900_000_000])
        if row is not None and rng.random() < 0.4:
            yield t, row
            continue
        row = dict.fromkeys(COLUMNS, "")
        for name, values in [
            ("open_door", ("true", "0", "1")),
            ("arm.speed", ("0.05", "1e-2", "3", "nan", "-0.1", "12345.678901234567")),
            ("parts", ("0", "2", "-7")),
            ("mode", MODES),
            ("halt", ("1", "", "False")),
            ("x", ("what, ever", 'so "so"')),
        ]:
            if rng.random() < 0.4:
                row[name] = rng.choice(values)
        if rng.random() < 0.2:
            row["pick.id"] = rng.choice(["3", "4"])
            row["pick.force"] = rng.choice(["4.5", "4.75", "nan", ""])
            row["pick"] = rng.choice(["", "1", "0"])
        yield t, row


def distinct(seed: int):
    """As `rows`, with at most one payload at an instant."""
    paid = None
    for t, row in rows(seed):
        if row["pick"] or row["pick.id"]:
            if paid == t:
                continue
            paid = t
        yield t, row


def seconds(t: int) -> str:
    sign = "-" if t < 0 else ""
    return f"{sign}{abs(t) // 10**9}.{abs(t) % 10**9:09d}"


def quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"' if set(cell) & {",", '"'} else cell


def csv_text(seed: int) -> str:
    lines = ["t," + ",".join(COLUMNS)]
    lines += [
        f"{seconds(t)}," + ",".join(quoted(row[name]) for name in COLUMNS)
        for t, row in distinct(seed)
    ]
    return "\n".join(lines) + "\n"


def json_text(seed: int) -> str:
    lines = []
    for t, row in distinct(seed):
        entry: dict = {"t": float(seconds(t))} if seed % 2 else {"t_ns": t}
        if row["arm.speed"]:
            speed = float(row["arm.speed"])
            entry["arm"] = {
                "speed": None if speed != speed else speed,
                "other": [1, {"a": "\\u00e9"}],
            }
        if row["mode"]:
            entry["mode"] = row["mode"]
        if row["parts"]:
            entry["parts"] = int(row["parts"])
        if row["open_door"]:
            entry["open_door"] = row["open_door"] in ("true", "1")
        if row["halt"] == "1":
            entry["events"] = ["halt", "unheard_of"]
        if row["pick.id"]:
            entry["pick"] = {"id": int(row["pick.id"]), "force": None}
            if row["pick.force"] not in ("", "nan"):
                entry["pick"]["force"] = float(row["pick.force"])
        lines.append(json.dumps(entry))
    return "\n".join(lines) + "\n"


def told(text: str) -> dict:
    """What both have to say alike."""
    keys = ("number", "triggered", "decided", "verdict", "decision", "triggered_s", "decided_s")
    report = json.loads(text)
    return {
        "origin": report["origin"],
        "end": report["end"],
        **{
            name: (
                entry["verdict"],
                entry["counts"],
                [{key: one[key] for key in keys} for one in entry["attempts"]],
            )
            for name, entry in report["requirements"].items()
        },
    }


def said_alike(program, trace, capsys):
    """What program and `rvmon run` both say of a recording."""
    code = main(["run", str(program.spec), str(trace), "--format", "json", "--allow-missing"])
    expected = told(capsys.readouterr().out)
    done = program.judge(str(trace))
    assert (done.returncode, done.stderr) == (code, "")
    assert told(done.stdout) == expected
    return expected


@pytest.mark.parametrize(("ending", "text"), [(".csv", csv_text), (".jsonl", json_text)])
@pytest.mark.parametrize("seed", range(4))
def test_it_says_what_rvmon_run_says(program, tmp_path, capsys, ending, text, seed):
    """Verdicts, attempts, instants, counts and the exit code are the same."""
    trace = tmp_path / f"trace{ending}"
    trace.write_text(text(seed))
    code = main(["run", str(program.spec), str(trace), "--format", "json"])
    expected = told(capsys.readouterr().out)
    done = program.judge(str(trace))
    assert done.returncode == code, done.stderr
    assert told(done.stdout) == expected
    assert {one["verdict"] for one in expected["R1"][2]} >= {"P", "F"}


def test_lines_that_say_what_earlier_ones_said(program, tmp_path, capsys):
    """Few values, again and again, also at one instant: the same from all that is read."""
    rng = random.Random(7)
    names = ["open_door", "mode", "parts", "halt"]
    csv, jsonl, packed = ["t_ns," + ",".join(names)], [], b"rvmonbin" + struct.pack("=I", 4)
    packed += b"".join(struct.pack("=I", len(name)) + name.encode() for name in names)
    t = 0
    for _ in range(2000):
        t += rng.choice([0, 1, 50_000_000, 700_000_000, 1_000_000_000])
        door, parts = rng.choice([(0, None), (1, None), (0, 2), (1, 2), (None, 1), (None, None)])
        halt = 1 if rng.random() < 0.05 else None
        cells = [door, None, parts, halt]
        csv.append(f"{t}," + ",".join("" if cell is None else str(cell) for cell in cells))
        entry = {"t_ns": t} | ({"open_door": bool(door)} if door is not None else {})
        entry |= {"parts": parts} if parts is not None else {}
        entry |= {"halt": True} if halt else {}
        jsonl.append(json.dumps(entry))
        states = [3 * (cell is not None) for cell in cells]
        packed += struct.pack("=q4d4B", t, *(cell or 0 for cell in cells), *states)
    (tmp_path / "a.csv").write_text("\n".join(csv) + "\n")
    (tmp_path / "a.jsonl").write_text("\n".join(jsonl) + "\n")
    (tmp_path / "a.bin").write_bytes(packed)
    # Columns say that `pick` has no source; lines do not.
    for name, same in (("a.csv", "a.csv"), ("a.jsonl", "a.jsonl"), ("a.bin", "a.csv")):
        asked = ["run", str(program.spec), str(tmp_path / same), "--format", "json"]
        main([*asked, "--allow-missing"])
        expected = told(capsys.readouterr().out)
        assert len(expected["R1"][2]) > 50
        done = program.judge(str(tmp_path / name))
        assert told(done.stdout) == expected, name


def test_standard_input_is_json_lines(program):
    """`-` reads JSON lines from standard input."""
    done = program.judge("-", stdin=json_text(2))
    assert len(told(done.stdout)["R1"][2]) > 5


def test_several_recordings_are_an_array_without_those_that_are_damaged(program, tmp_path):
    """Each report is as by itself; the exit code is the highest, and the damaged one is named."""
    good, damaged = str(tmp_path / "good.csv"), str(tmp_path / "damaged.csv")
    (tmp_path / "good.csv").write_text(csv_text(0))
    (tmp_path / "damaged.csv").write_text(csv_text(0) + "0,backwards\n")
    done = program.judge(damaged, good, good, damaged)
    assert json.loads(done.stdout) == 2 * [json.loads(program.judge(good).stdout)]
    assert done.returncode == 2
    assert done.stderr.count("damaged.csv") == 2


def test_the_fixed_layout(program, tmp_path):
    """A binary recording says what the same one as CSV says."""
    names = ["halt", "arm.speed", "pick", "pick.id", "unheard_of"]
    packed = b"rvmonbin" + struct.pack("=I", len(names))
    for name in names:
        packed += struct.pack("=I", len(name)) + name.encode()
    lines = ["t_ns," + ",".join(names)]
    for row in range(300):
        t = row * 70_000_000
        cells = [row % 9 == 0 or None, row % 5 / 20, None, 3 if row % 20 == 0 else None, 1]
        packed += struct.pack(
            "=q5d5B", t, *(c or 0 for c in cells), *(3 * (c is not None) for c in cells)
        )
        lines.append(f"{t}," + ",".join("" if c is None else f"{c:g}" for c in cells))
    (tmp_path / "a.bin").write_bytes(packed)
    (tmp_path / "a.csv").write_text("\n".join(lines))
    first, second = (program.judge(str(tmp_path / name)) for name in ("a.bin", "a.csv"))
    assert told(first.stdout) == told(second.stdout)
    assert told(first.stdout)["R1"][1]["P"] > 10


@pytest.mark.parametrize(
    "line",
    [
        '{"t":1,"events":["halt"],"halt":false}',
        '{"t":1,"halt":false,"events":["halt"]}',
        '{"t":1,"halt":null,"events":["halt"]}',
        '{"t":1,"halt":true,"halt":false}',
        '{"t":1,"halt":false,"halt":true}',
        '{"t":1,"events":["halt"],"events":["pick"]}',
        '{"t":1,"events":["halt"],"events":null}',
        '{"t":1,"pick":{"id":3},"pick":false}',
        '{"t":1,"pick":{"id":3},"pick":{"force":1}}',
        '{"t":1,"events":["pick"],"pick":{"id":3}}',
        '{"t":1,"parts":1,"parts":2,"mode":"idle"}',
        '{"t":1,"mode":"\\u0069dle","x":"\\ud83d\\ude00"}',
        '\ufeff{"t":1,"mode":"idle"}',
        '{"t":1e0,"arm":{"speed":-0.5E-1},"mode":"idle"}',
    ],
)
def test_json_that_says_a_thing_twice_or_otherwise(program, tmp_path, capsys, line):
    """What a line says of one event in several ways counts as `rvmon run` counts it."""
    trace = tmp_path / "a.jsonl"
    trace.write_text(line + '\n{"t":3,"arm":{"speed":0.5}}\n', encoding="utf-8")
    said_alike(program, trace, capsys)


@pytest.mark.parametrize(
    "text",
    [
        "\n\nt,halt\n1,1\n\n3,0\n",
        '\ufeff"t",halt\n1,1\n3,0\n',
        't,"  halt "\n1,"\t1 "\n3, 0\x1f\n',
        't,halt,x\n1,1,a"b"\n3,0,"c""d"\n',
        't,halt,x\n1,1, "y\n3,0,z\n',
    ],
)
def test_csv_that_is_unusual_is_read_as_rvmon_run_does(program, tmp_path, capsys, text):
    """Blank lines, marks of byte order, space and quotes within cells."""
    trace = tmp_path / "a.csv"
    trace.write_text(text, encoding="utf-8")
    assert len(said_alike(program, trace, capsys)["R1"][2]) == 1


def test_a_gap_that_starts_many_attempts(tmp_path, capsys):
    """The room for open attempts grows also between two samples; so does that of columns."""
    (tmp_path / "echo.rv").write_text(
        "spec echo\nsignal p, q : bool\n"
        "requirement R1\n  upon once[1 s, 1 s] p\n  then within 1 h q\n"
    )
    knocks = [10 * burst + n / 1000 for burst in range(22) for n in range(100)]
    rows = [f"{t:.3f},{int(n % 2 == 0)}," for n, t in enumerate(knocks)]
    trace = tmp_path / "echo.csv"
    trace.write_text("\n".join(["t,p,q", "-9,0,0", *rows, "300,,1", ""]))
    assert main(["build", str(tmp_path / "echo.rv"), "-o", str(tmp_path / "echo")]) == 0
    done = subprocess.run([tmp_path / "echo", trace], capture_output=True, check=True)  # noqa: S603
    assert json.loads(done.stdout)["requirements"]["R1"]["counts"]["P"] == 22 * 50
    capsys.readouterr()
    command = ["run", str(tmp_path / "echo.rv"), str(trace), "--engine", "c", "--format", "json"]
    assert main([*command, "--until", "301"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["requirements"]["R1"]["counts"]["P"] == 22 * 50


def test_what_is_read_has_a_column(tmp_path):
    """Else the program refuses, or says that it is not known and is not content."""
    (tmp_path / "door.rv").write_text(
        "spec door\nsignal open, shut : bool\nrequirement R1\n  always not (open and shut)\n"
    )
    (tmp_path / "door.csv").write_text("t,open\n0,0\n1,1\n")
    assert main(["build", str(tmp_path / "door.rv"), "-o", str(tmp_path / "door")]) == 0

    def judged(*words):
        return subprocess.run(  # noqa: S603
            [tmp_path / "door", *words, tmp_path / "door.csv"], capture_output=True, check=False
        )

    refused, allowed = judged(), judged("--allow-missing")
    assert (refused.returncode, refused.stdout) == (2, b"")
    assert b"no column" in refused.stderr
    assert b"`shut`" in refused.stderr
    assert allowed.returncode == 1
    assert json.loads(allowed.stdout)["requirements"]["R1"]["verdict"] == "I"


def test_a_compiler_without_threads(tmp_path, monkeypatch):
    """Its program reads on one processor."""
    compiler = tmp_path / "cc"
    compiler.write_text(
        '#!/bin/sh\nfor word; do [ "$word" = -pthread ] && exit 1; done\nexec cc "$@"\n'
    )
    compiler.chmod(0o700)
    monkeypatch.setenv("CC", str(compiler))
    spec, binary, trace = (tmp_path / name for name in ("s.rv", "judge", "a.csv"))
    spec.write_text("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
    trace.write_text("t,p\n0,1\n1,0\n")
    assert main(["build", str(spec), "-o", str(binary)]) == 0
    done = subprocess.run([binary, trace], capture_output=True, text=True, check=False)  # noqa: S603
    assert (done.returncode, done.stderr) == (1, "")
    assert json.loads(done.stdout)["requirements"]["R1"]["verdict"] == "F"
