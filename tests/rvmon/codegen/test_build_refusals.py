"""What programs made by `rvmon build` refuse: the place, the cause, and nothing judged."""

import struct
import subprocess
from contextlib import suppress

import pytest

from rvmon.cli import main

pytestmark = pytest.mark.compiler

HALT = b"rvmonbin" + struct.pack("=II", 1, 4) + b"halt"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n1,2\n", "time column"),
        ("t,parts\n1,2\n0,3\n", "line 3: time goes backwards"),
        ("t,parts\n1,2\n0,3\n2,x\n", "line 3: time goes backwards"),
        ("t,parts\n1,2\n0,x\n", "line 3: time goes backwards"),
        ("t,parts\n1,2\n\n" + "2,2\n" * 99 + "2,x\n0,3\n", "line 103: `parts`: expected a whole"),
        ("t,parts\n1,2.5\n", "line 2: `parts`: expected a whole number from -9007199254740991 to"),
        ("t,mode\n1,mad\n", "line 2: `mode`: expected a label that is declared, found `mad`"),
        ("t,mode\nsoon,idle\n", "line 2: `t`: expected seconds such as 1.5"),
        ("t_ns,mode\n1.5,idle\n", "line 2: `t_ns`: expected whole nanoseconds"),
        ("t_ns,mode\n" + "1" * 5000 + ",idle\n", "line 2: `t_ns`: expected whole nanoseconds"),
        ("t,open_door\n1,ajar\n", "`open_door`: expected true, false, 1 or 0, found `ajar`"),
        ("t,arm.speed\n1,fast\n", "`arm.speed`: expected a number, found `fast`"),
        ("t,mode\n1,2,3\n", "more cells than the header has: put quotes"),
        ("t,mode\n1\n", "fewer cells than the header has: was the line cut off?"),
        ('t,mode\n1,"idle\n', "quoted"),
        ("t,mode\n", "no sample"),
        ("", "line 0"),
    ],
)
def test_wrong_recordings_are_refused_with_the_place(program, tmp_path, text, message):
    """Exit code 2, the line and the cause; nothing on standard output."""
    (tmp_path / "a.csv").write_text(text)
    done = program.judge(str(tmp_path / "a.csv"))
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "was the line cut off?"),
        ("[]", "not a JSON object such as"),
        ('{"t": 1, "parts": }', "`parts`: expected a whole number from"),
        ('{"t": 1, "parts": "2"}', "`parts`: expected a whole number from"),
        ('{"t": 1, "mode": "mad"}', "`mode`: expected a label that is declared, found `mad`"),
        ('{"t": "x"}', "`t`: expected seconds such as 1.5"),
        ("{}", "expected a time, `t` (seconds) or `t_ns`"),
        ('{"t": 1} x', "put each object on a line of its own"),
        ("\0", "is this a binary file?"),
        ('{"a' * 99, "not a JSON object such as"),
    ],
)
def test_wrong_json_is_refused(program, text, message):
    """No line of JSON that is cut off or of another shape passes; the cause is said."""
    done = program.judge("-", stdin=text)
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 1: " in done.stderr
    assert message in done.stderr


@pytest.mark.parametrize(
    "line",
    [
        *(f'{{"t":1,"arm":{{"speed":{n}}}}}' for n in ("1e400", "01", "5.", ".5", "+1", "-", "1e")),
        *(f'{{"t":1,"x":{n}}}' for n in ("1e400", "-01", "5.", "1.e5", "0x1")),
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
    trace = tmp_path / "a.jsonl"
    text = line if isinstance(line, bytes) else line.encode()
    trace.write_bytes(b'{"t":0}\n' + text + b'\n{"t":2}\n')
    assert main(["run", str(program.spec), str(trace)]) == 2
    capsys.readouterr()
    done = program.judge(str(trace))
    assert (done.returncode, done.stdout) == (2, "")
    assert "line 2: " in done.stderr


def test_a_repeated_line_has_a_time_of_json(program):
    """The time of a line that says what the line before said is read as strictly."""
    first = '{"t":1,"parts":2}\n'
    assert program.judge("-", stdin=first + '{"t":2,"parts":2}\n').returncode in (0, 1)
    done = program.judge("-", stdin=first + '{"t":02,"parts":2}\n')
    assert (done.returncode, done.stdout) == (2, "")
    assert (
        "line 2: `t`: expected seconds such as 1.5, less than 146 years, found `02`" in done.stderr
    )


@pytest.mark.parametrize(
    "line",
    [
        '{"t":1,"arm":{"speed":1},"arm":{"other":2}}',
        '{"t":1,"arm":{"speed":1},"arm":null}',
        '{"t":1,"arm.speed":1,"arm":{"speed":2},"arm.speed":3}',
        '{"t":1,"t":2}',
        '{"t":1,"pick":[{"id":1},{"id":2}]}',
        '{"t":1,"open_door":1.0}',
        '{"t":1,"parts":2.0}',
        '{"t":1,"parts":NaN}',
        '{"t":1,"halt":1}',
        '{"t":1}\r{"t":2}',
    ],
)
def test_json_that_only_rvmon_run_reads_is_refused(program, line):
    """What the program would count otherwise it does not judge at all."""
    done = program.judge("-", stdin=line + "\n")
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
    done = program.judge(str(trace))
    assert (done.returncode, done.stdout) == (2, "")
    assert "line " in done.stderr


@pytest.mark.parametrize(
    ("packed", "message"),
    [
        (b"t,halt\n1,1\n", "for text use .csv or .jsonl"),
        (b"rvmonbin\xff\xff\xff\xff", "in this machine's byte order?"),
        (b"rvmonbin" + struct.pack("=II", 1, 40) + b"halt", "is the file whole?"),
        (HALT + struct.pack("=qdB", 0, 1.0, 4), "expected a state from 0 to 3"),
        (HALT + struct.pack("=qdB", 2**62, 1.0, 3), "the time is out of range"),
        (HALT + struct.pack("=qd", 0, 1.0), "was it cut off?"),
    ],
)
def test_wrong_layouts_are_refused(program, tmp_path, packed, message):
    """Bytes that are not the fixed layout are refused with the cause."""
    (tmp_path / "a.bin").write_bytes(packed)
    done = program.judge(str(tmp_path / "a.bin"))
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr


def test_a_fault_is_told_while_more_is_awaited(program):
    """A stream that stays open holds up no fault in what has come of it."""
    lines = '{"t":1}\n{"t":0}\n' + '{"t":2,"mode":"idle"}\n' * 60_000
    words = [program.binary, "-"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as begun:  # noqa: S603
        with suppress(BrokenPipeError):
            begun.stdin.write(lines)
            begun.stdin.flush()
        assert begun.wait(60) == 2
        assert "line 2: time goes backwards" in begun.stderr.read()
        with suppress(BrokenPipeError):
            begun.stdin.close()


def test_no_line_fills_the_memory(program, tmp_path):
    """A file without an end of a line is left at once, with the place and the reason."""
    for name in ("zero.csv", "zero.jsonl"):
        (tmp_path / name).symlink_to("/dev/zero")
        done = program.judge(str(tmp_path / name))
        assert (done.returncode, done.stdout) == (2, "")
        assert "line 1: a line of more than 67,108,864 bytes" in done.stderr


@pytest.mark.parametrize("name", ["halt", "more"])
def test_one_name_twice_among_many_columns(program, tmp_path, name):
    """A name that stands twice is refused, declared or not, wherever it stands."""
    many = ",".join(f"c{number}" for number in range(1000))
    (tmp_path / "a.csv").write_text(f"t,{name},{many},{name}\n0" + ",1" * 1002 + "\n")
    done = program.judge(str(tmp_path / "a.csv"))
    assert (done.returncode, done.stdout) == (2, "")
    assert f"a column stands twice in the header, leave one: `{name}`" in done.stderr
