"""The cache folder: whose it is, what is kept in it, and for how long."""

import errno
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import rvmon
from rvmon.files import cache_folder, keep, read_kept
from rvmon.language.syntax.grammar_cache import parser_of

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("why", ["it is switched off", "its place is a file"])
def test_without_it_all_goes_on(own_cache, monkeypatch, why):
    """Parsers, what is compiled, and plans are made anew."""
    found = rvmon.load(ROOT / "examples" / "base.rv").evaluate(ROOT / "examples" / "base.csv")
    assert {path.name[:4] for path in own_cache.iterdir()} >= {"spec", "plan"}
    shutil.rmtree(own_cache)
    if why == "its place is a file":
        own_cache.touch()
    else:
        monkeypatch.setenv("RVMON_CACHE", "off")
    assert cache_folder() is None
    again = rvmon.load(ROOT / "examples" / "base.rv").evaluate(ROOT / "examples" / "base.csv")
    assert again == found
    options = {"parser": "lalr", "propagate_positions": True}
    assert parser_of('start: "a" /[0-9]+/', options).parse("a7").children == ["7"]
    assert not own_cache.is_dir()


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs the rights of POSIX")
def test_a_folder_that_others_can_write_to_is_not_used(own_cache):
    """What is kept is data, but whose data?"""
    own_cache.mkdir(mode=0o700)
    own_cache.chmod(0o777)
    assert cache_folder() is None
    own_cache.chmod(0o700)
    assert cache_folder() == own_cache


def test_a_relative_place_is_ignored(own_cache, monkeypatch):
    """The XDG specification says so: it would be another one in each folder."""
    monkeypatch.setenv("HOME", str(own_cache.parent))
    monkeypatch.setenv("XDG_CACHE_HOME", "somewhere")
    assert cache_folder() == own_cache.parent / ".cache" / "rvmon"


@pytest.mark.parametrize("said", ["1", "none"])
def test_what_was_used_last_is_kept(own_cache, monkeypatch, said):
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


def test_what_killed_processes_left_is_deleted(own_cache):
    """Unfinished files of long ago go; younger ones, and what is not ours, stay."""
    place = cache_folder()
    assert place is not None
    keep(place / f"spec-{1:040x}.json", b"x")
    old = place / ".rvmon-01234567.part"
    old.touch()
    (place / ".rvmon-89abcdef.part").touch()
    (place / "thesis.tex").touch()
    for path in (old, place / "thesis.tex"):
        os.utime(path, (0, 0))
    os.utime(place / "tidied", (0, 0))
    keep(place / f"spec-{2:040x}.json", b"x")
    names = {path.name for path in place.iterdir()}
    assert {name for name in names if not name.startswith("spec-")} == {
        ".rvmon-89abcdef.part",
        "tidied",
        "thesis.tex",
    }


def test_files_are_private_whatever_the_umask_says(own_cache):
    known = os.umask(0)
    try:
        place = cache_folder()
        assert place is not None
        keep(place / "spec-0.json", b"x")
    finally:
        os.umask(known)
    modes = [stat.S_IMODE(path.stat().st_mode) for path in (place, place / "spec-0.json")]
    assert modes == [0o700, 0o600]


@pytest.mark.parametrize("harm", ["cut", "flip", "others", "gone", "pipe", "folder"])
def test_what_is_damaged_or_foreign_is_not_used(own_cache, harm):
    place = cache_folder()
    assert place is not None
    path = place / "spec-0.json"
    keep(path, b"a body")
    assert read_kept(path) == b"a body"
    if harm == "cut":
        os.truncate(path, 3)
    elif harm == "flip":
        path.write_bytes(path.read_bytes()[:-1] + b"Y")
    elif harm == "others":
        path.chmod(0o722)
    else:
        path.unlink()
        if harm != "gone":
            (os.mkfifo if harm == "pipe" else os.mkdir)(path)
    assert read_kept(path) is None


def test_a_link_of_someone_else_is_not_followed(own_cache, monkeypatch):
    """It is the link that someone else can change."""
    own_cache.parent.joinpath("elsewhere").mkdir(mode=0o700)
    own_cache.symlink_to("elsewhere")
    assert cache_folder() == own_cache
    foreign = own_cache.lstat().st_uid + 1
    if os.geteuid():
        monkeypatch.setattr(os, "getuid", lambda: foreign)
    else:
        os.lchown(own_cache, foreign, -1)
    assert cache_folder() is None


SPEC = "spec s\nsignal p : bool\nevent e\nrequirement R\n  upon e then within 2 s p\n"
TRACE = [(0.0, {"p": False, "e": True}), (1.0, {"p": True})]
COMPILE = """
import sys, rvmon

print("ready", flush=True)
sys.stdin.readline()
trace = [(0.0, {"p": False, "e": True}), (1.0, {"p": True})]
print(rvmon.load(sys.argv[1]).evaluate(trace).to_json())
"""


def full(*_):
    """What the system says when the disk is full."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def opened(path, flags, *more, real=os.open, **where):
    """The same for new files only."""
    return full() if flags & os.O_CREAT else real(path, flags, *more, **where)


@pytest.mark.slow
@pytest.mark.parametrize(("call", "fails"), [("open", opened), ("replace", full)])
def test_a_full_disk_costs_only_what_would_be_kept(own_cache, tmp_path, monkeypatch, call, fails):
    path = tmp_path / "a.rv"
    path.write_text(SPEC)
    with monkeypatch.context() as patch:
        patch.setattr(os, call, fails)
        spec = rvmon.load(path)
        assert spec.evaluate(TRACE).verdicts == {"R": "P"}
    assert [*own_cache.iterdir()] == []
    rvmon.load(path)
    assert any(one.name.startswith("spec-") for one in own_cache.iterdir())


@pytest.mark.process
def test_two_processes_that_compile_the_same_at_once_keep_it_whole(own_cache, tmp_path):
    path = tmp_path / "a.rv"
    path.write_text(SPEC)
    words = [sys.executable, "-c", COMPILE, str(path)]
    pipe = subprocess.PIPE
    begun = [subprocess.Popen(words, stdin=pipe, stdout=pipe, text=True) for _ in range(2)]  # noqa: S603
    for one in begun:
        assert one.stdout.readline() == "ready\n"
    for one in begun:
        one.stdin.write("go\n")
        one.stdin.flush()
    told = [one.communicate()[0] for one in begun]
    assert [one.returncode for one in begun] == [0, 0]
    assert told[0] == told[1]
    assert '"P"' in told[0]
    assert not [one for one in own_cache.iterdir() if one.name.endswith(".part")]
    [kept] = [one for one in own_cache.iterdir() if one.name.startswith("spec-")]
    assert read_kept(kept) is not None
