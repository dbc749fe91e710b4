"""Programs made by `rvmon build` against `rvmon run`."""

import json
import os
import random
import shutil
import struct
import subprocess

import pytest

from rvmon.cli import main

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")

SPEC = """
spec watch "A cell"
time held
signal open_door : bool
signal arm.speed : real [m/s]  stale after 700 ms
signal parts : int
signal mode : {idle, "at work", stopped}
event pick(id: int, force: real)
event halt
requirement R1 "a"
  upon halt
  then within 300 ms arm.speed < 0.1 m/s
requirement R2 "b"
  whenever mode == idle
  then within 1 s not open_door
requirement R3 "c"
  upon pick.force > 4.5 or pick.id == 3
  then within 1 s (halt or parts >= 2)
requirement R4 "d"
  always once[0 s, 2 s] known(arm.speed)
"""
COLUMNS = ("open_door", "arm.speed", "parts", "mode", "pick", "pick.id", "pick.force", "halt", "x")
MODES = ("idle", "stopped")


def rows(seed: int):
    """Random rows: decimal time, and text by column."""
    dice = random.Random(seed)
    t = dice.choice([0, 1_700_000_000 * 10**9, -5 * 10**9])
    row = None
    for _ in range(400):
        t += dice.choice([0, 1, 50_000_000, 123_456_789, 900_000_000])
        if row is not None and dice.random() < 0.4:
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
            if dice.random() < 0.4:
                row[name] = dice.choice(values)
        if dice.random() < 0.2:
            row["pick.id"] = dice.choice(["3", "4"])
            row["pick.force"] = dice.choice(["4.5", "4.75", "nan", ""])
            row["pick"] = dice.choice(["", "1", "0"])
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


def without_stale(text: str) -> str:
    """The specification for which samples that say nothing new change nothing."""
    return text.replace("stale after 700 ms", "")


@pytest.fixture(scope="module", params=[str, without_stale], ids=["stale", "steady"])
def program(request, tmp_path_factory):
    """The spec and the program made of it, compiled without a warning."""
    folder = tmp_path_factory.mktemp("build")
    spec = folder / "watch.rv"
    spec.write_text(request.param(SPEC.replace('"at work"', "working")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        flags = (
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-pedantic",
            "-fsanitize=address,undefined",
        )
        patch.setattr("rvmon.codegen.c_build.FLAGS", flags)
        assert main(["build", str(spec), "-o", str(folder / "watch")]) == 0
    return spec, folder / "watch"


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


def ran(binary, path, stdin=None) -> subprocess.CompletedProcess:
    # It leaves by `exit` where a recording is wrong: memory that is in use then is not lost.
    env = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}
    return subprocess.run(  # noqa: S603
        [binary, path], capture_output=True, text=True, check=False, input=stdin, env=env
    )


@pytest.mark.parametrize(("ending", "text"), [(".csv", csv_text), (".jsonl", json_text)])
@pytest.mark.parametrize("seed", range(4))
def test_it_says_what_rvmon_run_says(program, tmp_path, capsys, ending, text, seed):
    """Verdicts, attempts, instants, counts and the exit code are the same."""
    spec, binary = program
    trace = tmp_path / f"trace{ending}"
    trace.write_text(text(seed))
    code = main(["run", str(spec), str(trace), "--format", "json"])
    expected = told(capsys.readouterr().out)
    done = ran(binary, str(trace))
    assert done.returncode == code, done.stderr
    assert told(done.stdout) == expected
    assert {one["verdict"] for one in expected["R1"][2]} >= {"P", "F"}


def test_lines_that_say_what_earlier_ones_said(program, tmp_path, capsys):
    """Few values, again and again, also at one instant: the same from all that is read."""
    spec, binary = program
    dice = random.Random(7)
    names = ["open_door", "mode", "parts", "halt"]
    csv, jsonl, packed = ["t_ns," + ",".join(names)], [], b"rvmonbin" + struct.pack("=I", 4)
    packed += b"".join(struct.pack("=I", len(name)) + name.encode() for name in names)
    t = 0
    for _ in range(2000):
        t += dice.choice([0, 1, 50_000_000, 700_000_000, 1_000_000_000])
        door, parts = dice.choice([(0, None), (1, None), (0, 2), (1, 2), (None, 1), (None, None)])
        halt = 1 if dice.random() < 0.05 else None
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
    main(["run", str(spec), str(tmp_path / "a.csv"), "--format", "json"])
    expected = told(capsys.readouterr().out)
    assert len(expected["R1"][2]) > 50
    for name in ("a.csv", "a.jsonl", "a.bin"):
        done = ran(binary, str(tmp_path / name))
        assert told(done.stdout) == expected, name


def test_standard_input_is_json_lines(program):
    """`-` reads JSON lines from standard input."""
    done = ran(program[1], "-", json_text(2))
    assert len(told(done.stdout)["R1"][2]) > 5


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
    first, second = (ran(program[1], str(tmp_path / name)) for name in ("a.bin", "a.csv"))
    assert told(first.stdout) == told(second.stdout)
    assert told(first.stdout)["R1"][1]["P"] > 10


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n1,2\n", "time column"),
        ("t,parts\n1,2\n0,3\n", "line 3: time goes backwards"),
        ("t,parts\n1,2.5\n", "line 2: no value of its column: `2.5`"),
        ("t,mode\n1,mad\n", "line 2"),
        ("t,mode\nsoon,idle\n", "no time"),
        ("t,mode\n1\n", "fewer cells"),
        ('t,mode\n1,"idle\n', "quoted"),
        ("t,mode\n", "no sample"),
        ("", "line 0"),
    ],
)
def test_wrong_recordings_are_refused_with_the_place(program, tmp_path, text, message):
    """Exit code 2, the line and the cause; nothing on standard output."""
    (tmp_path / "a.csv").write_text(text)
    done = ran(program[1], str(tmp_path / "a.csv"))
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr


@pytest.mark.parametrize(
    "text", ["{", "[]", '{"t": 1, "parts": }', '{"t": "x"}', "{}", '{"t": 1} x', "\0", '{"a' * 99]
)
def test_wrong_json_is_refused(program, text):
    """No line of JSON that is cut off or of another shape passes."""
    done = ran(program[1], "-", text)
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 1" in done.stderr


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
    spec, binary = program
    trace = tmp_path / "a.jsonl"
    trace.write_text(line + '\n{"t":3,"arm":{"speed":0.5}}\n', encoding="utf-8")
    code = main(["run", str(spec), str(trace), "--format", "json"])
    expected = told(capsys.readouterr().out)
    done = ran(binary, str(trace))
    assert (done.returncode, done.stderr) == (code, "")
    assert told(done.stdout) == expected


@pytest.mark.parametrize(
    "line",
    [
        *(f'{{"t":1,"arm":{{"speed":{n}}}}}' for n in ("1e400", "01", "5.", ".5", "+1", "-", "1e")),
        *(f'{{"t":1,"x":{n}}}' for n in ("1e400", "-01", "5.", "1.e5", "NaN", "0x1")),
        '{"t":01}',
        '{"t_ns":1.0}',
        '{"t":1}\0',
        '{"t":1,"events":"halt"}',
        '{"t":1,"events":[1]}',
        '{"t":1,"x":"\\ud800"}',
        '{"t":1,"x":"\\udc00\\ud800"}',
        '{"t":1,"halt":[]}',
        b'{"t":1,"x":"\xff"}',
        b'{"t":1,"x":"\xed\xa0\x80"}',
        b'{"t":1,"x":"\xc0\x80"}',
        b'{"t":1,"x":"\xf0\x9f\x98"}',
    ],
)
def test_json_that_rvmon_run_refuses(program, tmp_path, capsys, line):
    """Both refuse numbers, escapes, bytes and members that are not what JSON or rvmon has."""
    spec, binary = program
    trace = tmp_path / "a.jsonl"
    text = line if isinstance(line, bytes) else line.encode()
    trace.write_bytes(b'{"t":0}\n' + text + b'\n{"t":2}\n')
    assert main(["run", str(spec), str(trace)]) == 2
    capsys.readouterr()
    done = ran(binary, str(trace))
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 2: " in done.stderr


def test_a_repeated_line_has_a_time_of_json(program):
    """The time of a line that says what the line before said is read as strictly."""
    first = '{"t":1,"parts":2}\n'
    assert ran(program[1], "-", first + '{"t":2,"parts":2}\n').returncode in (0, 1)
    done = ran(program[1], "-", first + '{"t":02,"parts":2}\n')
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 2: no time: `02`" in done.stderr


@pytest.mark.parametrize(
    "line",
    [
        '{"t":1,"arm":{"speed":1},"arm":{"other":2}}',
        '{"t":1,"arm":{"speed":1},"arm":null}',
        '{"t":1,"arm.speed":1,"arm":{"speed":2},"arm.speed":3}',
        '{"t":1,"t":2}',
        '{"t":1,"pick":[{"id":1},{"id":2}]}',
        '{"t":1,"open_door":1.0}',
        '{"t":1}\r{"t":2}',
    ],
)
def test_json_that_only_rvmon_run_reads_is_refused(program, line):
    """What the program would count otherwise it does not judge at all."""
    done = ran(program[1], "-", line + "\n")
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 1: " in done.stderr


@pytest.mark.parametrize(
    "text",
    [
        't,mode,x\n1,idle,"a\nb"\n',
        "t,halt\r\r\n1,1\r\r\n",
        "t,halt\r1,1\r",
        "t,x,x\n1,1,1\n",
        "t,,\n1,1,1\n",
        't,halt\n1, "1"\n',
        't,halt\n1,"1" \n',
        "t,halt\n1,\0\n",
        "t,\u00a0halt\n1,1\n",
        "t,arm.speed\n1e 0,1\n",
        b"t,halt,\xff\n1,1,1\n",
        b"t,halt,x\n1,1,\xff\n",
        b"t,x\n1," + b"x" * 131073 + b"\n",
    ],
)
def test_csv_that_readers_cut_otherwise_is_refused(program, tmp_path, text):
    """No column, cell or line is passed over in silence."""
    trace = tmp_path / "a.csv"
    trace.write_bytes(text if isinstance(text, bytes) else text.encode())
    done = ran(program[1], str(trace))
    assert (done.returncode, done.stdout) == (2, "")
    assert "line " in done.stderr


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
    spec, binary = program
    trace = tmp_path / "a.csv"
    trace.write_text(text, encoding="utf-8")
    code = main(["run", str(spec), str(trace), "--format", "json"])
    expected = told(capsys.readouterr().out)
    done = ran(binary, str(trace))
    assert (done.returncode, done.stderr) == (code, "")
    assert told(done.stdout) == expected
    assert len(expected["R1"][2]) == 1
