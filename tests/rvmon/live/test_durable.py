"""A run that goes on where its process was killed: no verdict is lost, changed or of nobody."""

import errno
import os
import random
from threading import Thread

import pytest
from tests.rvmon.live import killed_watch
from tests.tools.each import each

import rvmon
from rvmon.cli import watch_kept
from rvmon.errors import SnapshotError, TraceError
from rvmon.execute.journal import add
from rvmon.live.durable import DurableMonitor

SPEC = rvmon.loads(killed_watch.SPEC)


def judged(path, fed, cuts, told, every=25):
    """Feed samples; at each cut the monitor is left as it is, and another takes the run up."""
    monitor = DurableMonitor(SPEC, path, told, every=every, settle="next")
    for number, (t, values) in enumerate(fed):
        if number in cuts:
            monitor = DurableMonitor(SPEC, path, told, every=every, settle="next")
            assert monitor.taken == number
        try:
            monitor.step_ns(t, values)
        except TraceError:
            continue


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_a_run_that_is_cut_tells_what_a_whole_one_does(tmp_path, seed):
    """Wherever it is cut, also behind refused samples: numbers, records, reasons are the same."""
    rng = random.Random(seed)
    fed = [*killed_watch.samples(rng, 120)]
    whole, found = {}, {}
    judged(tmp_path / "whole", fed, (), lambda n, one: whole.update({n: one}), 10_000)

    def told(number, attempt):
        assert found.setdefault(number, attempt) == attempt
        assert found[number].reason == attempt.reason

    judged(tmp_path / "cut", fed, rng.sample(range(120), 5), told)
    assert len(whole) > 20
    assert found == whole


@pytest.mark.parametrize("lost", [["p", "go"], None, []])
def test_a_sample_that_is_lost_leaves_its_names_unknown(tmp_path, lost):
    """Also to the process that goes on; with nothing lost there is a failure."""
    told = []
    monitor = DurableMonitor(SPEC, tmp_path / "run", print)
    monitor.step_ns(0, {"speed": 0.5, "p": True})
    if lost != []:
        monitor.miss(lost)
    monitor = DurableMonitor(SPEC, tmp_path / "run", lambda *one: told.append(one))
    monitor.step_ns(9, {"go": True})
    monitor.step_ns(30_000_000, {})
    assert bool(told) is (lost == [])


def test_what_was_saved_is_not_told_again(tmp_path):
    """So a watch that came to its end tells nothing when it is begun again."""
    told = []
    monitor = DurableMonitor(SPEC, tmp_path / "run", lambda *one: told.append(one))
    monitor.step_ns(0, {"speed": 2.0})
    monitor.advance_ns(5)
    monitor.save()
    DurableMonitor(SPEC, tmp_path / "run", lambda *one: told.append(one))
    assert len(told) == 1


def test_files_and_values_that_are_none_are_told(tmp_path):
    (tmp_path / "text").write_text("a run\n")
    with pytest.raises(SnapshotError, match="text: no run of a monitor"):
        DurableMonitor(SPEC, tmp_path / "text", print)
    DurableMonitor(SPEC, tmp_path / "run", print)
    other = rvmon.loads(killed_watch.SPEC.replace("25 ms", "26 ms"))
    with pytest.raises(SnapshotError, match="run: the snapshot was made with another"):
        DurableMonitor(other, tmp_path / "run", print)
    add(tmp_path / "run", b"[1, 2, 3]")
    with pytest.raises(SnapshotError, match="run: its content is not a sample"):
        DurableMonitor(SPEC, tmp_path / "run", print)
    monitor = DurableMonitor(SPEC, tmp_path / "new", print)
    with pytest.raises(TraceError, match="cannot be kept"):
        monitor.step_ns(0, {"speed": object()})
    assert monitor.taken == 0


def test_a_sample_that_is_damaged_in_the_file_is_told(tmp_path):
    """Without it those behind cannot be judged; the last may be torn, and was not taken then."""
    path, told = tmp_path / "run", []
    monitor = DurableMonitor(SPEC, path, print)
    for t in range(3):
        monitor.step_ns(t, {"speed": 0.5})
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines)[:-3])
    for taken in (2, 3):
        monitor = DurableMonitor(SPEC, path, lambda *one: told.append(one))
        assert monitor.taken == taken
        if taken == 2:
            monitor.step_ns(2, {"speed": 2.0})
    assert [(number, one.name) for number, one in told] == [(1, "R2#1")] * 2
    path.write_bytes(b"".join([*lines[:2], lines[2].replace(b"0.5", b"5.5"), *lines[3:]]))
    with pytest.raises(SnapshotError, match="run: line 3 is damaged, and not the last one"):
        DurableMonitor(SPEC, path, print)


@pytest.mark.parametrize(("room", "every"), [(0, 99), (1, 99), (20, 99), (30, 2)])
def test_a_sample_for_which_the_disk_has_no_room_changes_nothing(tmp_path, room, every):
    """Also where a part of it, or of a snapshot, could be written: the caller may try again."""
    resource = pytest.importorskip("resource", reason="limits of a process")
    path, told, before = tmp_path / "run", [], resource.getrlimit(resource.RLIMIT_FSIZE)
    monitor = DurableMonitor(SPEC, path, print, every=every)
    for t in range(2):
        monitor.step_ns(t, {"speed": 0.5})
    kept = path.read_bytes()
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(kept) + room, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            monitor.step_ns(2, {"speed": 2.0})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert (path.read_bytes(), monitor.taken) == (kept, 2)
    for t in (2, 3):
        monitor.step_ns(t, {"speed": 2.0})
    monitor = DurableMonitor(SPEC, path, lambda *one: told.append(one))
    assert (monitor.taken, [one.name for _, one in told]) == (4, ["R2#1"])


@pytest.fixture
def watched(tmp_path, says):
    """Write lines, and watch them with a state by a command that is to end with a code."""
    (tmp_path / "s.rv").write_text("signal x : real\nrequirement R\n  always x < 5\n")

    def watch(code, lines, *words):
        (tmp_path / "a.jsonl").write_text(lines)
        words = words or [str(tmp_path / "a.jsonl")]
        return says(code, "watch", tmp_path / "s.rv", *words, "--state", tmp_path / "run")

    return watch


@pytest.mark.parametrize(
    ("line", "told"), [('{"t": 9, "x": ', "dropped once"), ('{"t": 1, "x": 9}', "late once")]
)
def test_a_watch_that_lost_a_line_is_no_success(watched, line, told):
    text = '{"t": 0, "x": 1}\n{"t": 8, "x": 1}\n'
    for more, code in (("", 0), (line + "\n", 1), ('{"t": 12, "x": 1}\n', 1)):
        text += more
        assert (told in watched(code, text).err) is (code == 1)


@pytest.mark.parametrize(("rows", "is_same"), [(7, False), (20, False), (0, True)])
def test_a_watch_goes_on_in_no_other_file(watched, rows, is_same):
    """As of a log that was put away: lines of the new one would pass for those that were taken."""
    text = "".join(f'{{"t": {t}, "x": 1}}\n' for t in range(10))
    watched(1, f'{text}{{"t": 10, "x"')  # is being written
    other = "".join(f'{{"t": {t}, "x": 9}}\n' for t in range(20, 20 + rows))
    other = other or f'{text}{{"t": 10, "x": 1}}\n{{"t": 11, "x": 1}}\n'
    told = watched(1 if is_same else 2, other).err
    assert ("is not the file whose first 11 lines were evaluated" in told) is not is_same


def test_a_verdict_that_cannot_be_written_is_told_by_the_next_process(watched, monkeypatch):
    """Its disk is full, or its reader has left: the state does not count it as told."""

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    text = '{"t": 0, "x": 9}\n{"t": 1, "x": 9}\n'
    with monkeypatch.context() as patch:
        patch.setattr(watch_kept, "say", full)
        assert "the output cannot be written: No space left" in watched(2, text).err
    assert "R#1 F" in watched(1, text).out


def test_a_watch_that_goes_on_with_a_pipe_has_lost_what_came_meanwhile(watched, tmp_path):
    """The process before may have taken lines that it did not judge; to a file it is told."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for t, code, is_told in ((0, 0, False), (9, 1, True)):
        text = f'{{"t": {t}, "x": 1}}\n{{"t": {t + 1}, "x": 1}}\n'
        writing = Thread(target=pipe.write_text, args=(text,))
        writing.start()
        told = watched(code, "", str(pipe)).err
        writing.join()
        assert ("lines that arrived after its last one are lost" in told) is is_told
        assert ("dropped once, first at 1 s" in told) is is_told


@pytest.mark.process
def test_a_watch_that_is_killed_goes_on(tmp_path):
    killed_watch.written(tmp_path, seed=1, count=150)
    expected, found, kills = killed_watch.killed(tmp_path, kills=3, seed=1)
    assert kills > 0
    assert len(expected) > 50
    assert found == expected


def test_a_kept_run_goes_on_with_the_same_requirements(tmp_path, says):
    """Others have heard nothing of what came before: they would pass, or be left out unsaid."""
    (tmp_path / "s.rv").write_text(killed_watch.SPEC)
    (tmp_path / "a.jsonl").write_text('{"t": 0, "speed": 0.5}\n{"t": 1, "speed": 0.5}\n')
    words = "watch", tmp_path / "s.rv", tmp_path / "a.jsonl", "--state", tmp_path / "run"
    says(0, *words, "--only", "R1,R3")
    for only in ([], ["--only", "R1"], ["--only", "R2"]):
        assert "its run evaluates only R1, R3: give the same --only" in says(2, *words, *only).err
    says(0, *words, "--only", "R3,R1")


def test_what_fails_by_the_last_line_is_no_success(watched):
    """Its verdict waits for a line with a later stamp, as another may have the same."""
    assert "it has no lines" in watched(2, "\n").err
    text = '{"t": 0, "x": 1}\n{"t": 1, "x": 9}\n'
    told = watched(1, text)
    assert (told.out, "R: fails at the last line" in told.err) == ("", True)
    assert "R#1 F" in watched(1, text + '{"t": 2, "x": 1}\n').out


@each(
    ("words", "message"),
    [
        (["--robot", "name"], "leave --robot out"),
        (["--realtime"], "leave --realtime out"),
        (["--sim-time"], "leave --sim-time out"),
        (["--format", "view"], "text or json"),
        (["mqtt://localhost/#"], "a pipe or a file"),
    ],
)
def test_what_does_not_go_with_a_state_is_refused(watched, tmp_path, words, message):
    """Instead of being judged otherwise than it was asked."""
    assert message in watched(2, "", *words).err
    assert not (tmp_path / "run").exists()
