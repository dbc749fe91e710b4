"""`rvmon watch`: output, exit codes, broken streams and changes of the specification."""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager, nullcontext
from io import StringIO
from types import SimpleNamespace

import pytest
from tests.rvmon.cli.conftest import DOOR

from rvmon import loads
from rvmon.cli.watch import _replace
from rvmon.cli.watch_output import print_status
from rvmon.live import Driver, SimulatedClock
from rvmon.report.printer import Printer

FAILS = '{"t": 0, "closed": true, "knock": true}\n{"t": 3, "closed": false, "noise": 1}\n'


@pytest.fixture
def door(door):
    """A folder with the specification and a stream that fails."""
    (door / "a.jsonl").write_text(FAILS)
    return door


@pytest.mark.usefixtures("door")
def test_each_verdict_is_a_line_and_the_end_a_table(says):
    told = says(1, "watch", "door.rv", "a.jsonl")
    assert told.out.startswith("2.000000001 s  D1#1 F ✗  `closed` had to become false")
    assert "D1   F  ✗" in told.out
    assert "noise is not declared" in told.err
    assert "D1#1 F ✗" in says(1, "watch", "door.rv", "a.jsonl", "--format", "view").out
    told = says(1, "watch", "door.rv", "a.jsonl", "--format", "json").out
    first, last = map(json.loads, told.splitlines())
    assert (first["attempt"], first["verdict"], first["decided"]) == ("D1#1", "F", 2_000_000_001)
    assert last == {"robot": "", "runs": 1, "verdicts": {"D1": "F"}, "samples": 2, "lost": 0}


@pytest.mark.slow
@pytest.mark.parametrize("before", ["[INFO] the robot starts", "\n", '{"level": "info"}'])
def test_lines_before_the_first_sample_do_not_choose_the_clock(door, says, before):
    """Samples with stamps are judged at these."""
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
def test_a_line_without_the_requested_time_or_robot_is_lost(says, words, why, end):
    told = says(1, "watch", "door.rv", "a.jsonl", *words.split())
    assert f"line 1 is rejected: {why}" in told.err
    assert end in told.out


@pytest.mark.parametrize(
    ("fault", "told"), [(OSError(5, "Input/output error"), "Input/output"), (MemoryError(), "Mem")]
)
def test_requirements_stay_open_if_the_stream_breaks_off(door, says, monkeypatch, fault, told):
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
def test_a_failure_before_a_change_of_the_specification_fails_the_watch(
    door, says, monkeypatch, form
):
    """The table at the end has the verdicts since the change, even if no byte changed."""
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


@pytest.fixture
def changed(door, says, monkeypatch):
    """Watch a silent source, replace a file by each text (`None` deletes it), return the output."""
    source = nullcontext(SimpleNamespace(publish=print))
    source.publish = print
    monkeypatch.setattr("rvmon.adapters.dds.DdsSource", lambda *_, **__: source)

    def watched(spec, name, *texts):
        left = list(texts)

        def sleep(_):
            if not left:
                raise KeyboardInterrupt
            text = left.pop(0)
            (door / "new.rv").write_text(text or "")
            os.replace("new.rv", name)
            if text is None:
                os.unlink(name)

        monkeypatch.setattr("rvmon.cli.watch.time.sleep", sleep)
        said = says(1, "watch", spec, "dds:7", "--format", "text")
        return " ".join((said.out + said.err).split())

    return watched


KEPT = "The previous specification stays in use"


def test_a_change_with_a_new_name_is_refused(changed):
    """Topics are chosen at the start, so the new name would seem silent."""
    said = changed("door.rv", "door.rv", DOOR + "event other\n", DOOR + "\n")
    assert "`other` is new, and topics are chosen when the watch starts" in said
    assert f"{KEPT}. door.rv has changed: the new one applies" in said


def test_a_change_of_an_imported_file_applies_once_it_can_be_read(put, changed):
    put("main.rv", 'import "names.rv"\n' + DOOR)
    put("names.rv", 'import "times.rv"\n')
    put("times.rv", "const T = 1 s\n")
    said = changed("main.rv", "times.rv", "const", None, "const T = 2 s\n")
    assert said.count(KEPT) == 2
    assert said.count("times.rv has changed: the new one applies") == 1


@pytest.mark.slow
def test_too_many_robots_fail_the_watch(door, says):
    lines = [json.dumps({"t": 0, "robot": n, "closed": True}) for n in range(1_001)]
    (door / "a.jsonl").write_text("\n".join(lines) + "\n")
    told = says(1, "watch", "door.rv", "a.jsonl", "--robot", "robot", "--format", "json")
    assert len(told.out.splitlines()) == 1_000
    assert "robot '1000' is one too many: at most 1000" in told.err


def test_passing_attempts_can_be_left_out(door, says):
    (door / "a.jsonl").write_text(FAILS.replace('"t": 3', '"t": 1'))
    told = says(0, "watch", "door.rv", "a.jsonl", "--failures", "--format", "text").out
    assert "D1#1" not in told


def test_only_some_of_many_equal_warnings_are_shown(door, says):
    (door / "a.jsonl").write_text(FAILS + "nonsense\n" * 123)
    told = says(1, "watch", "door.rv", "a.jsonl", "--format", "text").err
    told = [line for line in told.splitlines() if "rejected" in line]
    assert [line.split()[1] for line in told] == ["3", "4", "5", "6", "7", "12", "102"]
    assert "the 100th of this kind" in told[-1]


@pytest.mark.slow
def test_the_view_fits_the_terminal_and_starts_with_failures():
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


@contextmanager
def watching(form, **options):
    """A process that watches its standard input, killed if it lasts for more than a minute."""
    command = [sys.executable, "-m", "rvmon", "watch", "door.rv", "--format", form]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, env=environment, **pipes, **options) as process:  # noqa: S603
        alarm = threading.Timer(60, process.kill)
        alarm.start()
        yield process
        alarm.cancel()


def write(process, lines):
    process.stdin.write(lines)
    process.stdin.flush()


OPENED = '{"closed": true}\n{"knock": true, "closed": false}\n'


@pytest.mark.process
def test_changes_of_the_specification_apply_until_ctrl_c(door):
    """A broken or missing specification is reported, and the previous one stays in use."""
    with watching("text", stderr=subprocess.STDOUT) as process:
        write(process, OPENED)
        assert "UTC)  D1#1 P" in process.stdout.readline()
        for text, said in ((DOOR + "requirement", "RV001"), (DOOR + "\n", "has changed")):
            (door / "new.rv").write_text(text)
            os.replace("new.rv", "door.rv")
            assert any(said in line for line in iter(process.stdout.readline, ""))
        os.replace("door.rv", "gone.rv")
        assert any("previous" in line for line in iter(process.stdout.readline, ""))
        write(process, '{"knock": true, "closed": false}\n')
        assert any("D1#1" in line for line in iter(process.stdout.readline, ""))
        process.send_signal(signal.SIGINT)
        assert "run 2" in process.stdout.read()
    assert process.returncode == 0


@pytest.mark.process
@pytest.mark.usefixtures("door")
def test_a_watch_ends_when_its_reader_closes_the_pipe():
    with watching("json") as process:
        process.stdout.close()
        write(process, OPENED)
        assert process.wait(60) == 141
