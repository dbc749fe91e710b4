"""A run resumed after its process was killed: no verdict is lost, changed or invented."""

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
    """Feed samples; at each cut the monitor is abandoned, and a new one resumes the run."""
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
def test_an_interrupted_run_reports_the_same_as_a_whole_one(tmp_path, seed):
    """Numbers, records and reasons are the same wherever it is cut, even after a refused sample."""
    rng = random.Random(seed)
    fed = [*killed_watch.samples(rng, 120)]
    whole, found = {}, {}
    judged(tmp_path / "whole", fed, (), whole.__setitem__, 10_000)

    def told(number, attempt):
        assert found.setdefault(number, attempt) == attempt
        assert found[number].reason == attempt.reason

    judged(tmp_path / "cut", fed, rng.sample(range(120), 5), told)
    assert len(whole) > 20
    assert found == whole


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run"


def remembering(path):
    """A monitor that resumes a run, and the attempts that it reports."""
    told = []
    return DurableMonitor(SPEC, path, lambda *attempt: told.append(attempt)), told


@pytest.mark.parametrize("lost", [["p", "go"], None, []])
def test_missed_names_are_unknown_after_a_restart_too(path, lost):
    monitor = DurableMonitor(SPEC, path, print)
    monitor.step_ns(0, {"speed": 0.5, "p": True})
    if lost != []:
        monitor.miss(lost)
    monitor, told = remembering(path)
    monitor.step_ns(9, {"go": True})
    monitor.step_ns(30_000_000, {})
    assert bool(told) is (lost == [])


def test_saved_attempts_are_not_reported_again(path):
    monitor, told = remembering(path)
    monitor.step_ns(0, {"speed": 2.0})
    monitor.advance_ns(5)
    monitor.save()
    _, again = remembering(path)
    assert (len(told), again) == (1, [])


def test_foreign_files_and_unusable_values_are_refused(tmp_path):
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


def test_a_damaged_line_is_an_error_unless_it_is_the_last(path):
    """A torn last line is a sample that was never accepted."""
    monitor = DurableMonitor(SPEC, path, print)
    for t in range(3):
        monitor.step_ns(t, {"speed": 0.5})
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines)[:-3])
    monitor, first = remembering(path)
    assert monitor.taken == 2
    monitor.step_ns(2, {"speed": 2.0})
    monitor, second = remembering(path)
    assert monitor.taken == 3
    for told in (first, second):
        assert [(number, attempt.name) for number, attempt in told] == [(1, "R2#1")]
    path.write_bytes(b"".join([*lines[:2], lines[2].replace(b"0.5", b"5.5"), *lines[3:]]))
    with pytest.raises(SnapshotError, match="run: line 3 is damaged, and not the last one"):
        DurableMonitor(SPEC, path, print)


@pytest.mark.parametrize(("room", "every"), [(0, 99), (1, 99), (20, 99), (30, 2)])
def test_a_sample_that_the_full_disk_refuses_changes_nothing(path, room, every):
    """Even if a part of it, or of a snapshot, was written. The caller may try again."""
    resource = pytest.importorskip("resource", reason="limits of a process")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
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
    monitor, told = remembering(path)
    assert (monitor.taken, [attempt.name for _, attempt in told]) == (4, ["R2#1"])


@pytest.fixture
def watched(tmp_path, says):
    """Write lines and watch them with `--state`; takes the expected exit code."""
    (tmp_path / "s.rv").write_text("signal x : real\nrequirement R\n  always x < 5\n")

    def watch(code, lines, *words):
        (tmp_path / "a.jsonl").write_text(lines)
        words = words or [str(tmp_path / "a.jsonl")]
        return says(code, "watch", tmp_path / "s.rv", *words, "--state", tmp_path / "run")

    return watch


@pytest.mark.parametrize(
    ("line", "told"), [('{"t": 9, "x": ', "dropped once"), ('{"t": 1, "x": 9}', "late once")]
)
def test_a_lost_line_fails_this_watch_and_all_resumed_ones(watched, line, told):
    text = '{"t": 0, "x": 1}\n{"t": 8, "x": 1}\n'
    for more, code in (("", 0), (line + "\n", 1), ('{"t": 12, "x": 1}\n', 1)):
        text += more
        assert (told in watched(code, text).err) is (code == 1)


@pytest.mark.parametrize(("rows", "is_same"), [(7, False), (20, False), (0, True)])
def test_a_watch_is_not_resumed_with_another_file(watched, rows, is_same):
    """After a rotation, lines of the new log would be skipped as already evaluated."""
    text = "".join(f'{{"t": {t}, "x": 1}}\n' for t in range(10))
    watched(1, f'{text}{{"t": 10, "x"')  # the last line is still being written
    other = "".join(f'{{"t": {t}, "x": 9}}\n' for t in range(20, 20 + rows))
    other = other or f'{text}{{"t": 10, "x": 1}}\n{{"t": 11, "x": 1}}\n'
    told = watched(1 if is_same else 2, other).err
    assert ("is not the file whose first 11 lines were evaluated" in told) is not is_same


def test_a_verdict_that_could_not_be_written_is_reported_by_the_next_watch(watched, monkeypatch):

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    text = '{"t": 0, "x": 9}\n{"t": 1, "x": 9}\n'
    with monkeypatch.context() as patch:
        patch.setattr(watch_kept, "say", full)
        assert "the output cannot be written: No space left" in watched(2, text).err
    assert "R#1 F" in watched(1, text).out


def test_a_watch_resumed_with_a_pipe_reports_a_loss(watched, tmp_path):
    """The previous process may have read lines that it did not evaluate."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for t, code, is_lost in ((0, 0, False), (9, 1, True)):
        text = f'{{"t": {t}, "x": 1}}\n{{"t": {t + 1}, "x": 1}}\n'
        writing = Thread(target=pipe.write_text, args=(text,))
        writing.start()
        told = watched(code, "", str(pipe)).err
        writing.join()
        assert ("lines that arrived after its last one are lost" in told) is is_lost
        assert ("dropped once, first at 1 s" in told) is is_lost


@pytest.mark.process
def test_a_killed_and_resumed_watch_reports_the_same_as_a_whole_one(tmp_path):
    killed_watch.written(tmp_path, seed=1, count=150)
    expected, found, kills = killed_watch.killed(tmp_path, kills=3, seed=1)
    assert kills > 0
    assert len(expected) > 50
    assert found == expected


def test_a_run_is_resumed_with_the_same_requirements_only(tmp_path, says):
    """Requirements that have not seen the earlier samples might pass wrongly."""
    (tmp_path / "s.rv").write_text(killed_watch.SPEC)
    (tmp_path / "a.jsonl").write_text('{"t": 0, "speed": 0.5}\n{"t": 1, "speed": 0.5}\n')
    words = "watch", tmp_path / "s.rv", tmp_path / "a.jsonl", "--state", tmp_path / "run"
    says(0, *words, "--only", "R1,R3")
    for only in ([], ["--only", "R1"], ["--only", "R2"]):
        assert "its run evaluates only R1, R3: give the same --only" in says(2, *words, *only).err
    says(0, *words, "--only", "R3,R1")


def test_a_failure_at_the_last_line_fails_the_watch(watched):
    """Its verdict waits for a later stamp, as another line may have the same one."""
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
def test_options_that_state_excludes_are_refused(watched, tmp_path, words, message):
    assert message in watched(2, "", *words).err
    assert not (tmp_path / "run").exists()
