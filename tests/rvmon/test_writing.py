"""Files are written whole, and nothing is lost where they cannot be."""

import errno
import os
import stat

import pytest

from rvmon.files import write_whole


def test_a_file_that_cannot_be_finished_stays_as_it_was(tmp_path, monkeypatch):
    def full(_from: object, _to: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "a.rv"
    path.write_text("before")
    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        write_whole(path, "after")
    assert [one.name for one in tmp_path.iterdir()] == ["a.rv"]
    assert path.read_text() == "before"


def test_rights_and_links_stay(tmp_path):
    path, link, twin = tmp_path / "a", tmp_path / "link", tmp_path / "twin"
    path.write_text("before")
    path.chmod(0o751)
    link.symlink_to("a")
    write_whole(link, "after")
    assert link.is_symlink()
    assert (path.read_text(), stat.S_IMODE(path.stat().st_mode)) == ("after", 0o751)
    twin.hardlink_to(path)
    write_whole(path, "last")
    assert twin.read_text() == "last"


def test_what_is_no_file_is_written_to(tmp_path):
    """A pipe stays one; it is our own, as a device would be lost if this were wrong."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, "text")
    assert os.read(reader, 9) == b"text"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, "text")


def test_a_new_file_has_the_rights_of_new_files(tmp_path):
    known = os.umask(0o027)
    try:
        write_whole(tmp_path / "a", "text")
    finally:
        os.umask(known)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640
