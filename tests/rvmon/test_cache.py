"""The cache folder: whose it is, what is kept in it, and for how long."""

import os
import stat

import pytest

from rvmon.cache import cache_folder, is_whole, keep, keep_binary, read_kept


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


@pytest.mark.parametrize("said", ["1", "none"])
def test_what_was_used_last_is_kept(folder, monkeypatch, said):
    """The folder does not grow beyond what is said; what is no number says nothing."""
    monkeypatch.setenv("RVMON_CACHE_MB", said)
    place = cache_folder()
    assert place is not None
    paths = [place / f"spec-{number:040x}.json" for number in range(30)]
    for number, path in enumerate(paths):
        keep(path, bytes(100_000))
        os.utime(path, (number, number))
        os.utime(place / "tidied", (0, 0))  # it is done from time to time
        assert read_kept(paths[0]) == bytes(100_000)
    left = [path.exists() for path in paths]
    assert left[0]
    assert left[-1]
    assert all(left) == (said == "none")
    assert sum(left) >= 5


def test_what_killed_processes_left_is_deleted(folder):
    """Unfinished files and folders of long ago go; younger ones, and what is not ours, stay."""
    place = cache_folder()
    assert place is not None
    keep(place / f"spec-{1:040x}.json", b"x")
    old = place / ".rvmon-01234567.part"
    old.mkdir()
    (old / "made").touch()
    (place / ".rvmon-89abcdef.part").touch()
    (place / "tmp_0a1b2c3").touch()
    (place / "thesis.tex").touch()
    for path in (old, place / "tmp_0a1b2c3", place / "thesis.tex"):
        os.utime(path, (0, 0))
    os.utime(place / "tidied", (0, 0))
    keep(place / f"spec-{2:040x}.json", b"x")
    names = {path.name for path in place.iterdir()}
    assert {name for name in names if not name.startswith("spec-")} == {
        ".rvmon-89abcdef.part",
        "tidied",
        "thesis.tex",
    }


def test_files_are_private_whatever_the_umask_says(folder):
    """Nobody else reads what requirements ask."""
    known = os.umask(0)
    try:
        place = cache_folder()
        assert place is not None
        keep(place / "spec-0.json", b"x")
        binary = keep_binary(place / "0.so", b"x")
    finally:
        os.umask(known)
    modes = [stat.S_IMODE(path.stat().st_mode) for path in (place, place / "spec-0.json", binary)]
    assert modes == [0o700, 0o600, 0o700]


@pytest.mark.parametrize("harm", ["cut", "flip", "others", "gone", "pipe", "folder"])
def test_what_is_damaged_or_foreign_is_not_used(folder, harm):
    """A file is used only as it was written, and if nobody else can change it."""
    place = cache_folder()
    assert place is not None
    path = keep_binary(place / "0123.so", b"binary")
    assert is_whole(path)
    if harm == "cut":
        os.truncate(path, 3)
    elif harm == "flip":
        path.write_bytes(b"binarY")
    elif harm == "others":
        path.chmod(0o722)
    else:
        path.unlink()
        if harm != "gone":
            (os.mkfifo if harm == "pipe" else os.mkdir)(path)
    assert not is_whole(path)


def test_a_link_of_someone_else_is_not_followed(folder, monkeypatch):
    """It is the link that someone else can change."""
    folder.parent.joinpath("elsewhere").mkdir(mode=0o700)
    folder.symlink_to("elsewhere")
    assert cache_folder() == folder
    foreign = folder.lstat().st_uid + 1
    if os.geteuid():
        monkeypatch.setattr(os, "getuid", lambda: foreign)
    else:
        os.lchown(folder, foreign, -1)
    assert cache_folder() is None
