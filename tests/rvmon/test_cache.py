"""The cache folder: its owner, its content, and when entries are deleted."""

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
def test_everything_works_without_a_cache(own_cache, monkeypatch, why):
    """Parsers, compiled specifications and plans are made anew."""
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
    """Someone else might have replaced the entries."""
    own_cache.mkdir(mode=0o700)
    own_cache.chmod(0o777)
    assert cache_folder() is None
    own_cache.chmod(0o700)
    assert cache_folder() == own_cache


def test_a_relative_path_in_the_environment_is_ignored(own_cache, monkeypatch):
    """The XDG specification says so."""
    monkeypatch.setenv("HOME", str(own_cache.parent))
    monkeypatch.setenv("XDG_CACHE_HOME", "somewhere")
    assert cache_folder() == own_cache.parent / ".cache" / "rvmon"


@pytest.fixture
def place(own_cache):
    """The cache folder, created."""
    found = cache_folder()
    assert found == own_cache
    return found


@pytest.mark.parametrize("limit", ["1", "none"])
def test_recently_used_entries_stay_within_the_limit(place, monkeypatch, limit):
    monkeypatch.setenv("RVMON_CACHE_MB", limit)
    paths = [place / f"spec-{number:040x}.json" for number in range(30)]
    for number, path in enumerate(paths):
        keep(path, bytes(100_000))
        os.utime(path, (number, number))
        os.utime(place / "tidied", (0, 0))  # otherwise it would not be tidied again so soon
        assert read_kept(paths[0]) == bytes(100_000)
    left = [path.exists() for path in paths]
    assert left[0]
    assert left[-1]
    assert all(left) == (limit == "none")
    assert sum(left) >= 5


def test_old_unfinished_files_are_deleted_and_foreign_ones_kept(place):
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
    others = {name for name in names if not name.startswith("spec-")}
    assert others == {".rvmon-89abcdef.part", "tidied", "thesis.tex"}


def test_files_are_private_whatever_the_umask(own_cache):
    before = os.umask(0)
    try:
        place = cache_folder()
        assert place == own_cache
        keep(place / "spec-0.json", b"x")
    finally:
        os.umask(before)
    modes = [stat.S_IMODE(path.stat().st_mode) for path in (place, place / "spec-0.json")]
    assert modes == [0o700, 0o600]


@pytest.mark.parametrize("harm", ["cut", "flip", "others", "gone", "pipe", "folder"])
def test_damaged_or_foreign_entries_are_not_used(place, harm):
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


def test_a_symbolic_link_of_another_user_is_not_followed(own_cache, monkeypatch):
    """Its owner can change where it leads."""
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
    """Fail as on a full disk."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def opened(path, flags, *more, real=os.open, **where):
    """Fail as on a full disk, but only for new files."""
    return full() if flags & os.O_CREAT else real(path, flags, *more, **where)


@pytest.mark.slow
@pytest.mark.parametrize(("call", "fails"), [("open", opened), ("replace", full)])
def test_a_full_disk_only_prevents_caching(own_cache, tmp_path, monkeypatch, call, fails):
    path = tmp_path / "a.rv"
    path.write_text(SPEC)
    with monkeypatch.context() as patch:
        patch.setattr(os, call, fails)
        spec = rvmon.load(path)
        assert spec.evaluate(TRACE).verdicts == {"R": "P"}
    assert [*own_cache.iterdir()] == []
    rvmon.load(path)
    assert [*own_cache.glob("spec-*")]


@pytest.mark.process
def test_two_processes_can_cache_the_same_specification_at_once(own_cache, tmp_path):
    path = tmp_path / "a.rv"
    path.write_text(SPEC)
    words = [sys.executable, "-c", COMPILE, str(path)]
    pipe = subprocess.PIPE
    processes = [subprocess.Popen(words, stdin=pipe, stdout=pipe, text=True) for _ in range(2)]  # noqa: S603
    for process in processes:
        assert process.stdout.readline() == "ready\n"
    for process in processes:
        process.stdin.write("go\n")
        process.stdin.flush()
    told = [process.communicate()[0] for process in processes]
    assert [process.returncode for process in processes] == [0, 0]
    assert told[0] == told[1]
    assert '"P"' in told[0]
    assert not [path for path in own_cache.iterdir() if path.name.endswith(".part")]
    [kept] = own_cache.glob("spec-*")
    assert read_kept(kept) is not None
