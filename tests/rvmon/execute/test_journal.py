"""Journals: what was added stays, and what is torn is never taken for an entry."""

import pytest

from rvmon.execute.journal import add, begin, entries

ENTRIES = [b"first", b"", b'{"second": "\xc3\xa9"}', b"third"]


@pytest.fixture
def path(tmp_path):
    """A journal of all entries."""
    path = tmp_path / "a.journal"
    begin(path, ENTRIES[:2])
    for entry in ENTRIES[2:]:
        add(path, entry)
    return path


def test_what_was_added_is_read(path):
    """In order; where there is no file, there is no journal either."""
    assert entries(path) == ENTRIES
    assert entries(path.with_name("gone")) is None


def test_it_ends_where_it_is_torn(path):
    """Wherever the file is cut, the lines before are read."""
    whole = path.read_bytes()
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        assert entries(path) == ENTRIES[: whole[:size].count(b"\n")]


def test_it_ends_where_it_is_damaged(path):
    """Whichever byte is another, no entry is."""
    whole = path.read_bytes()
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert entries(path) == ENTRIES[: whole[:place].count(b"\n")]
