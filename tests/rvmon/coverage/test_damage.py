"""Damaged coverage databases: errors with place, cause and fix."""

import os
import random
import sqlite3

import pytest
from tests.tools.covered import fill

from rvmon.coverage import TestRecord
from rvmon.coverage.database import Database, read
from rvmon.errors import CoverageError


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "door.cov"
    with Database.open(path) as database:
        fill(database)
    return path


def refused(path):
    """The error for reading a file, which is the same for writing; the file stays as it is."""
    before = path.read_bytes()
    with pytest.raises(CoverageError) as reading:
        read([path])
    with pytest.raises(CoverageError) as writing, Database.open(path) as database:
        database.coverage()
    assert str(writing.value) == str(reading.value)
    assert str(path) in str(reading.value)
    assert path.read_bytes() == before
    return str(reading.value)


def rewritten(path, *words):
    with sqlite3.connect(path) as database:
        for one in words:
            database.execute(one)
    database.close()


def test_what_is_no_database_is_named(path):
    text = path.with_name("t.csv")
    text.write_text("t,a\n0,1\n" * 1000)
    assert "this is not a database: give one that" in refused(text)
    foreign = path.with_name("f.db")
    rewritten(foreign, "CREATE TABLE t (a)")
    assert "a database of something else" in refused(foreign)
    rewritten(path, "PRAGMA user_version = 5")
    told = refused(path)
    assert "written by a newer rvmon (version 5 of its tables, this one reads 4)" in told
    assert "install that one, or record again" in told
    rewritten(path, "PRAGMA user_version = 1")
    told = refused(path)
    assert "written by an older rvmon (version 1 of its tables, this one reads 4)" in told
    assert "record again, or install that one" in told


@pytest.mark.parametrize(
    "words",
    [
        "CREATE TRIGGER t AFTER INSERT ON tests BEGIN DELETE FROM tests; END",
        "CREATE VIEW v AS SELECT load_extension('x')",
        "CREATE INDEX i ON tests (name)",
        "DROP TABLE reasons",
        "ALTER TABLE items ADD COLUMN more",
        "UPDATE items SET kind = 'good'",
        "UPDATE items SET goal = 'many'",
        "UPDATE items SET goal = 0",
        "UPDATE groups SET weight = -1",
        "UPDATE groups SET axes = '[[1, 2]]'",
        "UPDATE groups SET subject = x'00'",
        'UPDATE tests SET verdicts = \'{"D1": "X"}\'',
        "UPDATE tests SET verdicts = x'ff'",
        "UPDATE tests SET ending = 'fine'",
        "UPDATE tests SET seed = 'one'",
        "UPDATE tests SET hits = 'text'",
        "UPDATE tests SET hits = x'00'",
        "UPDATE tests SET hits = substr(hits, 1, length(hits) - 2)",
        pytest.param("UPDATE tests SET hits = zeroblob(9000000)", marks=pytest.mark.slow),
        "DELETE FROM items WHERE name = 'yes'",
        "INSERT INTO reasons VALUES (99, 'why')",
        "INSERT INTO unreachable VALUES (99, 'why')",
    ],
)
def test_what_was_never_written_is_damage(path, words):
    rewritten(path, words)
    told = refused(path)
    assert "is damaged" in told
    assert "restore a copy of it, or delete it and record again" in told


@pytest.mark.slow
def test_a_bomb_is_not_unpacked(path):
    import zlib

    bomb = zlib.compress(b"\0" * 20_000_000)
    database = sqlite3.connect(path)
    database.execute("UPDATE tests SET hits = ?", [bomb])
    database.commit()
    database.close()
    assert "cut off, or too many" in refused(path)


@pytest.mark.slow
def test_damage_of_any_byte_is_survived(path):
    whole = path.read_bytes()
    rng = random.Random(3)
    victim = path.with_name("victim.cov")
    refusals = 0
    for _ in range(150):
        body = bytearray(whole)
        for _ in range(rng.choice([1, 3, 30])):
            body[rng.randrange(len(body))] = rng.randrange(256)
        if rng.random() < 0.2:
            del body[rng.randrange(len(body)) :]
        victim.write_bytes(body)
        try:
            read([victim])
        except CoverageError as error:
            refusals += str(victim) in str(error)
        for beside in path.parent.glob("victim.cov-*"):
            beside.unlink()
    assert refusals > 30


def test_what_is_no_file_is_said_so(tmp_path):
    with pytest.raises(CoverageError, match=r"there is no file .*makes it"):
        read([tmp_path / "none.cov"])
    with pytest.raises(CoverageError, match=r"there is no folder .*make it first"):
        Database.open(tmp_path / "none" / "a.cov")
    with pytest.raises(CoverageError, match="is a folder: name a database in it"):
        read([tmp_path])
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(CoverageError, match="is not a regular file"):
        Database.open(tmp_path / "pipe")
    with pytest.raises(CoverageError, match="name another"):
        Database.open("a\0b")
    with pytest.raises(CoverageError, match="name another"):
        Database.open(tmp_path / ("a" * 5000))


def test_an_empty_file_is_begun_and_not_read(tmp_path):
    path = tmp_path / "empty.cov"
    path.touch()
    with pytest.raises(CoverageError, match="it is empty: give one that"):
        read([path])
    with Database.open(path) as database:
        fill(database)
    assert len(read([path]).entries) == 4


def test_file_names_may_have_signs_of_addresses(tmp_path):
    """`?`, `#` and `%` have no meaning for SQLite here."""
    path = tmp_path / "a?mode=memory#b%20c ü.cov"
    with Database.open(path) as database:
        database.record(TestRecord("t"), {})
    assert path.exists()
    assert len(read([path]).entries) == 1
