"""Processes that write to one database at once, or are killed while writing."""

import signal
import sqlite3
import subprocess
import sys

import pytest
from tests.tools.covered import door_model, hits_of

from rvmon.coverage import TestRecord, database_file
from rvmon.coverage.database import Database, read
from rvmon.errors import CoverageError

WRITER = """
import itertools, sys
from rvmon.coverage.database import Database
from rvmon.coverage import TestRecord
from tests.tools.covered import door_model, hits_of

path, name, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
with Database.open(path) as database:
    database.declare(door_model())
    for number in range(count) if count else itertools.count():
        database.record(TestRecord(f"{name}-{number}", name), hits_of(("gaze", "yes")))
        print(number, flush=True)
"""


def writer(path, name, count=0):
    return subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", WRITER, str(path), name, str(count)],
        stdout=subprocess.PIPE,
        text=True,
    )


@pytest.mark.process
def test_processes_write_at_once(tmp_path):
    path = tmp_path / "a.cov"
    writers = [writer(path, name, 50) for name in "abc"]
    for one in writers:
        one.communicate(timeout=60)
        assert one.returncode == 0
    coverage = read([path])
    assert coverage.model == door_model()
    names = {entry.record.name for entry in coverage.entries}
    assert names == {f"{name}-{number}" for name in "abc" for number in range(50)}
    assert [one.name for one in tmp_path.iterdir()] == ["a.cov"]


@pytest.mark.process
@pytest.mark.parametrize("seen", [0, 1, 20, 100])
def test_a_killed_process_leaves_a_whole_database(tmp_path, seen):
    path = tmp_path / "a.cov"
    victim = writer(path, "victim")
    last = -1
    for _ in range(seen):
        last = int(victim.stdout.readline())
    victim.send_signal(signal.SIGKILL)
    last = max([last, *map(int, victim.stdout.read().split())])
    victim.communicate(timeout=60)
    with Database.open(path) as database:
        names = [entry.record.name for entry in database.coverage().entries]
        assert names[: last + 1] == [f"victim-{number}" for number in range(last + 1)]
        assert len(names) <= last + 2
        database.declare(door_model())
        database.record(TestRecord("after"), hits_of(("gaze", "no")))
    assert len(read([path]).entries) == len(names) + 1


def test_who_waits_too_long_is_told(tmp_path, monkeypatch):
    path = tmp_path / "a.cov"
    monkeypatch.setattr(database_file, "PATIENCE_S", 0.01)
    with Database.open(path) as database:
        holder = sqlite3.connect(path, isolation_level=None)
        holder.execute("BEGIN IMMEDIATE")
        with pytest.raises(CoverageError, match=r"a.cov: another process .*try again when"):
            database.record(TestRecord("t"), {})
        holder.execute("ROLLBACK")
        holder.close()
        database.record(TestRecord("t"), {})
    assert len(read([path]).entries) == 1
