"""`rvmon watch` as a person uses it."""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import nullcontext
from io import StringIO
from types import SimpleNamespace

import pytest
from tests.rvmon.cli.conftest import DOOR

from rvmon import loads
from rvmon.cli import main
from rvmon.cli.watch import _replace
from rvmon.cli.watch_output import print_status
from rvmon.live import Driver, SimulatedClock
from rvmon.report.printer import Printer

FAILS = '{"t": 0, "closed": true, "knock": true}\n{"t": 3, "closed": false, "noise": 1}\n'


@pytest.fixture
def door(door):
    """With a stream that fails."""
    (door / "a.jsonl").write_text(FAILS)
    return door


def test_each_verdict_is_a_line_and_the_end_a_table(door, capsys, says):
    """The exit code says whether something failed; what is ignored is said."""
    told = says(1, "watch", "door.rv", "a.jsonl")
    assert told.out.startswith("2.000000001 s  D1#1 F ✗  `closed` had to become false")
    assert "D1   F  ✗" in told.out
    assert "noise is not declared" in told.err
    assert "D1#1 F ✗" in says(1, "watch", "door.rv", "a.jsonl", "--format", "view").out
    assert main(["watch", "door.rv", "a.jsonl", "--format", "json"]) == 1
    first, last = map(json.loads, capsys.readouterr().out.splitlines())
    assert (first["attempt"], first["verdict"], first["decided"]) == ("D1#1", "F", 2_000_000_001)
    assert last == {"robot": "", "runs": 1, "verdicts": {"D1": "F"}, "samples": 2, "lost": 0}


@pytest.mark.slow
@pytest.mark.parametrize("before", ["[INFO] the robot starts", "\n", '{"level": "info"}'])
def test_what_a_program_greets_with_does_not_choose_the_clock(door, says, before):
    """Lines with stamps are judged at them, whatever stands above; each has its number."""
    (door / "a.jsonl").write_text(f"{before}\n{FAILS}nonsense\n")
    told = says(1, "watch", "door.rv", "a.jsonl")
    assert told.out.startswith("2.000000001 s  D1#1 F ✗")
    assert f"line {4 + before.count(chr(10))} is rejected" in told.err


@pytest.mark.usefixtures("door")
@pytest.mark.parametrize(
    ("words", "why", "end"),
    [
        ("--time stamp:ms", "there is no time `stamp`", "0 samples, 2 lost"),
        ("--robot id", "there is no robot name in `id`", "no input yet"),
    ],
)
def test_a_time_or_a_robot_that_is_named_is_in_each_line(says, words, why, end):
    """One without it is lost: neither stamped by the clock of the machine, nor of nobody."""
    told = says(1, "watch", "door.rv", "a.jsonl", *words.split())
    assert f"line 1 is rejected: {why}" in told.err
    assert end in told.out


@pytest.mark.parametrize(
    ("fault", "told"), [(OSError(5, "Input/output error"), "Input/output"), (MemoryError(), "Mem")]
)
def test_a_stream_that_breaks_off_passes_nothing(door, says, monkeypatch, fault, told):
    """As a serial line that is unplugged: what came behind it nobody heard."""
    pieces = [b'{"t": 0, "closed": true}\n']

    def read(*_):
        if pieces:
            return pieces.pop()
        raise fault

    monkeypatch.setattr("rvmon.adapters.json_objects.os.read", read)
    shown = says(1, "watch", "door.rv", "a.jsonl", "--format", "text")
    assert "D1   I  ?" in shown.out
    assert f"a.jsonl: {told}" in shown.err
    assert "rror: nothing more was received" in shown.err


@pytest.mark.parametrize("form", ["text", "view"])
def test_what_failed_before_a_change_of_the_specification_is_no_success(
    door, says, monkeypatch, form
):
    """Its verdicts are those of the new one from then on, whose writing may have been a touch."""
    is_taken_up = threading.Event()
    (door / "new.rv").write_text(DOOR)
    pieces = [b'{"t": 10, "closed": true}\n', FAILS.encode()]

    def read(*_):
        if len(pieces) == 1:
            os.replace("new.rv", "door.rv")
            assert is_taken_up.wait(60)
        return pieces.pop() if pieces else b""

    def replace(*arguments):
        _replace(*arguments)
        is_taken_up.set()

    monkeypatch.setattr("rvmon.adapters.json_objects.os.read", read)
    monkeypatch.setattr("rvmon.cli.watch._replace", replace)
    told = says(1, "watch", "door.rv", "a.jsonl", "--format", form)
    assert "run 2" in told.out
    assert "D1   NT" in told.out


def test_a_change_that_names_what_nobody_listens_to_is_not_taken_up(door, says, monkeypatch):
    """Topics are chosen as the watch begins: a name that is new would be taken for silent."""
    source = nullcontext(SimpleNamespace(publish=print))
    source.publish = print
    monkeypatch.setattr("rvmon.adapters.dds.DdsSource", lambda *_, **__: source)
    changes = [DOOR + "event other\n", DOOR + "\n"]

    def sleep(_):
        if not changes:
            raise KeyboardInterrupt
        (door / "new.rv").write_text(changes.pop(0))
        os.replace("new.rv", "door.rv")

    monkeypatch.setattr("rvmon.cli.watch.time.sleep", sleep)
    said = says(1, "watch", "door.rv", "dds:7", "--format", "text")
    said = " ".join((said.out + said.err).split())
    assert "`other` is new, and topics are chosen when the watch starts" in said
    assert (
        "The previous specification stays in use. door.rv has changed: the new one applies" in said
    )


def test_a_change_of_an_imported_file_is_taken_up(door, says, monkeypatch):
    """Also of one that another imports, and that is broken, or gone, for a while."""
    source = nullcontext(SimpleNamespace(publish=print))
    source.publish = print
    monkeypatch.setattr("rvmon.adapters.dds.DdsSource", lambda *_, **__: source)
    (door / "main.rv").write_text('import "names.rv"\n' + DOOR)
    (door / "names.rv").write_text('import "times.rv"\n')
    (door / "times.rv").write_text("const T = 1 s\n")
    changes = ["const", None, "const T = 2 s\n"]

    def sleep(_):
        if not changes:
            raise KeyboardInterrupt
        text = changes.pop(0)
        (door / "new.rv").write_text(text or "")
        os.replace("new.rv", "times.rv")
        if text is None:
            os.unlink("times.rv")

    monkeypatch.setattr("rvmon.cli.watch.time.sleep", sleep)
    said = says(1, "watch", "main.rv", "dds:7", "--format", "text")
    said = " ".join((said.out + said.err).split())
    assert said.count("The previous specification stays in use") == 2
    assert said.count("times.rv has changed: the new one applies") == 1


@pytest.mark.slow
def test_a_watch_of_too_many_robots_is_no_success(door, says):
    lines = [json.dumps({"t": 0, "robot": n, "closed": True}) for n in range(1_001)]
    (door / "a.jsonl").write_text("\n".join(lines) + "\n")
    told = says(1, "watch", "door.rv", "a.jsonl", "--robot", "robot", "--format", "json")
    assert len(told.out.splitlines()) == 1_000
    assert "robot '1000' is one too many: at most 1000" in told.err


def test_what_passes_can_be_left_out(door, capsys):
    lines = FAILS.replace('"t": 3', '"t": 1')
    (door / "a.jsonl").write_text(lines)
    assert main(["watch", "door.rv", "a.jsonl", "--failures", "--format", "text"]) == 0
    assert "D1#1" not in capsys.readouterr().out


def test_of_many_complaints_of_a_kind_few_are_told(door, capsys):
    (door / "a.jsonl").write_text(FAILS + "nonsense\n" * 123)
    assert main(["watch", "door.rv", "a.jsonl", "--format", "text"]) == 1
    told = [line for line in capsys.readouterr().err.splitlines() if "rejected" in line]
    assert [line.split()[1] for line in told] == ["3", "4", "5", "6", "7", "12", "102"]
    assert "the 100th of this kind" in told[-1]


@pytest.mark.slow
def test_a_view_of_much_fits_and_begins_with_what_failed():
    text = "spec s\nsignal x : real\nevent e\n" + "".join(
        f"requirement R{number}\n  upon e\n  then within {100 + number} s x > {number}\n"
        for number in range(100)
    )
    clock = SimulatedClock()
    driver = Driver(loads(text + "requirement LAST\n  always x < 0\n"), clock=clock)
    for robot in ("left", "right"):
        driver.offer({"x": 0.0 if robot == "right" else -1.0, "e": True}, robot=robot)
    clock.set_ns(1)
    driver.work()
    page = StringIO()
    print_status(driver, Printer(page, 80), 22)
    lines = page.getvalue().splitlines()
    assert len(lines) <= 22
    shown = [line.split()[0] for line in lines if line.split()]
    assert shown[0] == "right"  # it has failed
    assert shown.index("LAST") < shown.index("R0")
    assert "… and 96 more requirements: 96 NT" in lines


@pytest.mark.process
def test_a_change_of_the_specification_is_taken_up_and_ctrl_c_is_an_end(door):
    """While the stream is open; a change that is wrong is told and the previous one goes on."""
    command = [sys.executable, "-m", "rvmon", "watch", "door.rv", "--format", "text"]
    process = subprocess.Popen(  # noqa: S603
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    alarm = threading.Timer(60, process.kill)  # or a line that never comes is waited for
    alarm.start()
    with process:
        process.stdin.write('{"closed": true}\n{"knock": true, "closed": false}\n')
        process.stdin.flush()
        assert "UTC)  D1#1 P" in process.stdout.readline()
        for text, said in ((DOOR + "requirement", "RV001"), (DOOR + "\n", "has changed")):
            (door / "new.rv").write_text(text)
            os.replace("new.rv", "door.rv")
            assert any(said in line for line in iter(process.stdout.readline, ""))
        os.replace("door.rv", "gone.rv")
        assert any("previous" in line for line in iter(process.stdout.readline, ""))
        process.stdin.write('{"knock": true, "closed": false}\n')
        process.stdin.flush()
        assert any("D1#1" in line for line in iter(process.stdout.readline, ""))
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read()
    alarm.cancel()
    assert "run 2" in rest
    assert process.returncode == 0


@pytest.mark.process
def test_it_ends_when_nobody_reads_what_it_says(door):
    command = [sys.executable, "-m", "rvmon", "watch", "door.rv", "--format", "json"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, **pipes) as process:  # noqa: S603
        alarm = threading.Timer(60, process.kill)
        alarm.start()
        process.stdout.close()
        process.stdin.write(b'{"closed": true}\n{"knock": true, "closed": false}\n')
        process.stdin.flush()
        assert process.wait(60) == 141
        alarm.cancel()
