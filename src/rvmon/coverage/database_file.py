"""The file of a coverage database: its tables, how it is opened, and its errors."""

from __future__ import annotations

import os
import sqlite3
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rvmon.errors import CoverageError

APPLICATION = 0x72766376  # the `application_id` in the header of the file: "rvcv"
VERSION = 4  # the version of the tables; raised with each change of them

TABLES = (
    "CREATE TABLE groups (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, "
    "subject TEXT NOT NULL, weight INTEGER NOT NULL, axes TEXT NOT NULL, "
    "position INTEGER NOT NULL, title TEXT NOT NULL)",
    "CREATE TABLE items (id INTEGER PRIMARY KEY, owner INTEGER NOT NULL REFERENCES groups, "
    "name TEXT NOT NULL, kind TEXT NOT NULL, goal INTEGER NOT NULL, position INTEGER NOT NULL, "
    "text TEXT NOT NULL, UNIQUE (owner, name))",
    "CREATE TABLE reasons (item INTEGER NOT NULL REFERENCES items, reason TEXT NOT NULL, "
    "PRIMARY KEY (item, reason)) WITHOUT ROWID",
    "CREATE TABLE unreachable (item INTEGER NOT NULL REFERENCES items, reason TEXT NOT NULL, "
    "PRIMARY KEY (item, reason)) WITHOUT ROWID",
    "CREATE TABLE tests (id INTEGER PRIMARY KEY, digest TEXT NOT NULL UNIQUE, "
    "campaign TEXT NOT NULL, name TEXT NOT NULL, strategy TEXT NOT NULL, "
    "recording TEXT NOT NULL, seed TEXT, system TEXT NOT NULL, verdicts TEXT NOT NULL, "
    "ending TEXT NOT NULL, error TEXT NOT NULL, number INTEGER NOT NULL, seconds REAL NOT NULL, "
    "recorded INTEGER NOT NULL, expected TEXT NOT NULL, origin INTEGER NOT NULL, "
    "hits BLOB NOT NULL)",
)
"""The exact schema; a file with more is refused, as foreign views or triggers would run our SQL."""

PATIENCE_S = 60.0  # seconds that a process waits for others that write
_LONGEST = 100_000_000  # the most bytes of a text, or of the hits of one test, that are accepted


def connect(path: str | Path | None, *, create: bool) -> sqlite3.Connection:
    """Open a coverage database.

    Args:
        path: of the file; `None`: in memory.
        create: open it for writing, and create it if it does not exist; otherwise read-only.

    Raises:
        CoverageError: it does not exist, is not a coverage database, is damaged, has another
            version, or cannot be opened.
    """
    if path is not None:
        _refuse(Path(path), create=create)
    with readable_errors(path):
        database = _opened(path, create=create)
        try:
            if create and _is_new(database):
                _make(database, path)
            # Before `_prepare`, which would change the journal of a foreign database.
            _check(database, path)
            if create:
                _prepare(database)
            else:
                database.execute("PRAGMA query_only = ON")
        except BaseException:
            database.close()
            raise
    return database


@contextmanager
def readable_errors(path: str | Path | None) -> Iterator[None]:
    """Turn errors of SQLite, and of values it cannot store, into `CoverageError` with advice."""
    try:
        yield
    except sqlite3.ProgrammingError as error:
        fix = "use it in the thread that opened it, and until it is closed"
        raise CoverageError(f"error: {name_of(path)}: {error}: {fix}") from None
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF
        why = _WORDS.get(code, f"{error}: {_ANEW}")
        raise CoverageError(f"error: {name_of(path)}: {why}") from None
    except UnicodeDecodeError:
        raise damaged(path, "a text in it is not valid UTF-8") from None
    except UnicodeEncodeError as error:
        what = f"{error.object!a} has characters that are not valid Unicode: rename it"
        raise CoverageError(f"error: {name_of(path)}: {what}") from None
    except OverflowError:
        raise CoverageError(f"error: {name_of(path)}: a number is beyond 2**63") from None


@contextmanager
def transaction(
    database: sqlite3.Connection, path: str | Path | None, *, writes: bool = True
) -> Iterator[None]:
    """A transaction: it makes all its writes or none, or reads one consistent state.

    Other writers wait until a writing transaction ends.
    """
    with readable_errors(path):
        database.execute("BEGIN IMMEDIATE" if writes else "BEGIN")
        try:
            yield
            database.execute("COMMIT")
        except BaseException:
            if database.in_transaction:
                database.execute("ROLLBACK")
            raise


def name_of(path: str | Path | None) -> str:
    """The name of a database in errors."""
    return "the database in memory" if path is None else str(path)


def damaged(path: str | Path | None, what: str) -> CoverageError:
    """The error for a file with contents that rvmon cannot have written."""
    return CoverageError(f"error: {name_of(path)} is damaged: {what}: {_ANEW}")


_ANEW = "restore a copy of it, or delete it and record again"  # the advice for a damaged file

_WORDS = {
    sqlite3.SQLITE_NOTADB: "this is not a database: give one that `rvmon run --coverage` wrote",
    sqlite3.SQLITE_CORRUPT: f"the file is damaged: {_ANEW}",
    sqlite3.SQLITE_TOOBIG: f"a text in it is longer than {_LONGEST:,} bytes: {_ANEW}",
    sqlite3.SQLITE_BUSY: f"another process has been writing to it for {PATIENCE_S:g} s: try again "
    "when that one is done",
    sqlite3.SQLITE_LOCKED: "it is in use within this process: close it there first",
    sqlite3.SQLITE_FULL: "the disk is full: make room and record again; earlier recordings are "
    "kept",
    sqlite3.SQLITE_READONLY: "it cannot be written: give yourself the right to, or name another",
    sqlite3.SQLITE_PERM: "it cannot be opened: give yourself the right to, or name another",
    sqlite3.SQLITE_CANTOPEN: "it cannot be opened: give yourself the right to read and write it "
    "and its folder, or copy it elsewhere",
    sqlite3.SQLITE_IOERR: "the disk reports an error: copy the file elsewhere, and look at the "
    "disk",
    sqlite3.SQLITE_NOMEM: "there is not enough memory for it",
}
"""Explanation and advice by SQLite's error codes."""


def _refuse(path: Path, *, create: bool) -> None:
    """Refuse paths for which SQLite's own error would be poor, or opening would block."""
    try:
        status = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        if not create:
            fix = f"`rvmon run --coverage {path}` makes it"
            raise CoverageError(f"error: there is no file {path}: {fix}") from None
        if not path.parent.is_dir():
            fix = f"there is no folder {path.parent}: make it first"
            raise CoverageError(f"error: cannot write {path}: {fix}") from None
        return
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise CoverageError(f"error: cannot open {path}: {why}: name another") from None
    if stat.S_ISDIR(status.st_mode):
        raise CoverageError(f"error: {path} is a folder: name a database in it")
    if not stat.S_ISREG(status.st_mode):
        raise CoverageError(f"error: {path} is not a regular file: name one")


def _opened(path: str | Path | None, *, create: bool) -> sqlite3.Connection:
    address = "file::memory:"
    if path is not None:
        whole = Path(path).absolute()
        # In a read-only folder SQLite cannot create its auxiliary files; without a writer (no WAL
        # file) it does not need them.
        alone = not os.access(whole.parent, os.W_OK) and not Path(f"{whole}-wal").exists()
        mode = "rwc" if create else "ro&immutable=1" if alone else "rw"
        address = f"{whole.as_uri()}?mode={mode}"
    # Without an isolation level, Python starts no transactions of its own: see `transaction`.
    database = sqlite3.connect(address, uri=True, timeout=PATIENCE_S, isolation_level=None)
    try:
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LONGEST)
        # SQLite's advice for untrusted files: https://sqlite.org/security.html
        for words in ("trusted_schema = OFF", "cell_size_check = ON", "mmap_size = 0"):
            database.execute(f"PRAGMA {words}")
    except BaseException:
        database.close()
        raise
    return database


def _check(database: sqlite3.Connection, path: str | Path | None) -> None:
    """Check that the file is a coverage database of this version.

    Raises:
        CoverageError: it is not.
    """
    if _pragma(database, "application_id") != APPLICATION:
        empty = "it is empty" if _is_new(database) else "this is a database of something else"
        fix = "give one that `rvmon run --coverage` wrote"
        raise CoverageError(f"error: {name_of(path)}: {empty}: {fix}")
    version = _pragma(database, "user_version")
    if version != VERSION:
        by, fix = "an older", "record again, or install that one"
        if version > VERSION:
            by, fix = "a newer", "install that one, or record again with this one"
        raise CoverageError(
            f"error: {name_of(path)} was written by {by} rvmon (version {version} of its "
            f"tables, this one reads {VERSION}): {fix}"
        )
    statements = {
        sql
        for name, sql in database.execute("SELECT name, sql FROM sqlite_schema")
        if sql is not None or not str(name).startswith("sqlite_autoindex_")
    }
    if statements != set(TABLES):
        raise damaged(path, "its tables are not those of a coverage database")


def _is_new(database: sqlite3.Connection) -> bool:
    """Whether nothing has been written yet."""
    return (
        _pragma(database, "application_id") == 0
        and _pragma(database, "user_version") == 0
        and database.execute("SELECT count(*) FROM sqlite_schema").fetchone() == (0,)
    )


def _make(database: sqlite3.Connection, path: str | Path | None) -> None:
    with transaction(database, path):
        if _is_new(database):  # checked again: another process may have been faster
            for table in TABLES:
                database.execute(table)
            database.execute(f"PRAGMA application_id = {APPLICATION}")
            database.execute(f"PRAGMA user_version = {VERSION}")


def _prepare(database: sqlite3.Connection) -> None:
    """Configure for many small writes: WAL without waiting for the disk.

    Writes survive a killed process. A power failure may lose the last tests, but not damage the
    file.
    """
    database.execute("PRAGMA synchronous = NORMAL")
    with suppress(sqlite3.OperationalError):  # another process uses it: the old mode is safe, too
        database.execute("PRAGMA journal_mode = WAL")


def _pragma(database: sqlite3.Connection, name: str) -> int:
    return int(database.execute(f"PRAGMA {name}").fetchone()[0])
