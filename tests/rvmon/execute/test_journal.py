"""Journals: added entries stay, and a torn entry is never read."""

import pytest

from rvmon.execute.journal import add, create, entries

ENTRIES = [b"first", b"", b'{"second": "\xc3\xa9"}', b"third"]


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.journal"
    create(path, ENTRIES[:2])
    for entry in ENTRIES[2:]:
        add(path, entry)
    return path


def test_what_was_added_is_read(path):
    assert entries(path) == ENTRIES
    assert entries(path.with_name("gone")) is None


def test_it_ends_where_it_is_torn_or_damaged(path):
    """Wherever the file is cut or a byte is changed, the lines before are read."""
    whole = path.read_bytes()
    for place in range(len(whole)):
        for body in (whole[:place], whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :]):
            path.write_bytes(body)
            assert entries(path) == ENTRIES[: whole[:place].count(b"\n")]
