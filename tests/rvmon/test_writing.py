"""Files are written completely or stay as they were."""

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
    assert [*tmp_path.iterdir()] == [path]
    assert path.read_text() == "before"


def test_permissions_and_links_are_kept(tmp_path):
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


def test_a_pipe_is_written_to_and_not_replaced(tmp_path):
    """As a device would be."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, "text")
    assert os.read(reader, 9) == b"text"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, "text")


def test_a_new_file_has_the_permissions_of_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "a", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640
