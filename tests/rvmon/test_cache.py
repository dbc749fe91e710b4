"""The cache folder: whose it is, what is kept in it, and for how long."""

import os

import pytest

from rvmon.cache import cache_folder, keep, read_kept


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    return tmp_path / "rvmon"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs the rights of POSIX")
def test_a_folder_that_others_can_write_to_is_not_used(folder):
    """What is kept is data, but whose data?"""
    folder.mkdir(mode=0o700)
    folder.chmod(0o777)
    assert cache_folder() is None
    folder.chmod(0o700)
    assert cache_folder() == folder


def test_a_relative_place_is_ignored(folder, monkeypatch):
    """The XDG specification says so: it would be another one in each folder."""
    monkeypatch.setenv("HOME", str(folder.parent))
    monkeypatch.setenv("XDG_CACHE_HOME", "somewhere")
    assert cache_folder() == folder.parent / ".cache" / "rvmon"


def test_what_was_used_last_is_kept(folder):
    """The folder does not grow without end."""
    place = cache_folder()
    assert place is not None
    for number in range(300):
        path = place / f"spec-{number}.json"
        keep(path, b"x")
        os.utime(path, (number, number))
        assert read_kept(place / "spec-0.json") == b"x"
    left = {path.name for path in place.iterdir()}
    assert 128 <= len(left) <= 256
    assert {"spec-0.json", "spec-299.json"} <= left
